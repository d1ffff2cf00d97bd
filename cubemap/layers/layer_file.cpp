#include "cubemap/layers/layer_file.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "cubemap/layers/layer_list.h"
#include "cubemap/layers/presets.h"
#include "files/joined.h"
#include "files/json_reader.h"
#include "files/nearest_name.h"
#include "files/one_of_each.h"
#include "files/output_file.h"

namespace relumine::cubemap {

namespace {

constexpr double Version = 1.0;

class LayerFileReader {
public:
    /// Pictures are looked for in the folder.
    LayerFileReader(const files::JsonReader& json, std::filesystem::path folder)
        : folder_(std::move(folder)), json_(json) {}

    LightLayers read(const std::filesystem::path& path) const {
        const files::Json root = json_.parse(files::read(path));
        json_.known(root,
                    std::array<std::string_view, 5>{"version", "base", "rotate_degrees", "layers",
                                                    "frames"},
                    "a layer file");
        json_.require_version(root, Version);
        LightLayers result;
        if (const files::Json* base = root.find("base"))
            result.base = json_.string(*base, "\"base\"");
        if (const files::Json* turn = root.find("rotate_degrees"))
            result.rotate_degrees = json_.number(*turn, "\"rotate_degrees\"");
        result.layers = layers(json_.required(root, "layers"));
        if (const files::Json* frames = root.find("frames")) {
            for (const files::Json& value : json_.array(*frames, "\"frames\""))
                result.frames.push_back(frame(value, result));
        }
        return result;
    }

    std::vector<LightLayer> layers(const files::Json& list) const {
        std::vector<LightLayer> result;
        for (const files::Json& value : json_.array(list, "\"layers\""))
            result.push_back(layer(value, result));
        return result;
    }

private:
    std::vector<double> numbers(const LayerField& field, const files::Json& value) const {
        const std::string what = fmt::format("\"{}\"", field.name);
        if (field.flag != nullptr)
            return {json_.boolean(value, what) ? 1.0 : 0.0};
        if (field.number != nullptr || field.single != nullptr)
            return {json_.number(value, what)};
        std::vector<double> result;
        const auto append = [&](const files::Json& point, std::string_view name) {
            const glm::dvec3 three = json_.vector(point, name);
            result.insert(result.end(), {three.x, three.y, three.z});
        };
        if (field.points == nullptr)
            append(value, what);
        else
            for (const files::Json& point : json_.array(value, what))
                append(point, "a point");
        return result;
    }

    /// Returns the kind with a name.
    template<typename Variant>
    Variant kind(const files::Json& value, std::string_view what,
                 std::string_view (*name)(const Variant&)) const {
        const std::string& text = json_.string(value, what);
        std::vector<std::string_view> names;
        for (const Variant& candidate : files::one_of_each<Variant>()) {
            if (name(candidate) == text)
                return candidate;
            names.push_back(name(candidate));
        }
        json_.refuse(value, fmt::format("{} to be one of {}", what, files::joined(names, ", ")),
                     fmt::format("\"{}\"{}", text, files::did_you_mean(text, names)));
    }

    ImagePatch image_patch(const files::Json& owner) const {
        ImagePatch patch;
        const files::Json& path = json_.required(owner, "path");
        patch.path = json_.string(path, "\"path\"");
        if (const files::Json* blend = owner.find("blend")) {
            const std::string& text = json_.string(*blend, "\"blend\"");
            if (text != "replace" && text != "add")
                json_.refuse(*blend, "\"blend\" to be replace or add", fmt::format("\"{}\"", text));
            patch.blend = text == "add" ? ImagePatch::Blend::Add : ImagePatch::Blend::Replace;
        }
        try {
            patch.picture = load_image_pyramid(folder_ / patch.path);
        } catch (const std::runtime_error& error) {
            json_.refuse(path, "a picture", error.what());
        }
        return patch;
    }

    LightLayer from_preset(const files::Json& preset, const files::Json& direction) const {
        const std::string& name = json_.string(preset, "\"preset\"");
        glm::dvec3 towards = json_.vector(direction, "\"direction\"");
        const LayerPreset* found = find_preset(name);
        if (found == nullptr) {
            std::vector<std::string_view> names;
            for (const LayerPreset& each : layer_presets())
                names.push_back(each.name);
            json_.refuse(preset,
                         fmt::format("\"preset\" to be one of {}", files::joined(names, ", ")),
                         fmt::format("\"{}\"{}", name, files::did_you_mean(name, names)));
        }
        try {
            check(direction_field(towards));
        } catch (const std::invalid_argument& error) {
            json_.refuse(direction, error.what());
        }
        return placed(*found, towards);
    }

    LightLayer layer(const files::Json& value, const std::vector<LightLayer>& others) const {
        (void)json_.object(value, "a layer");
        LightLayer result;
        const files::Json& name = json_.required(value, "name");
        result.name = json_.string(name, "\"name\"");
        if (std::any_of(others.begin(), others.end(),
                        [&](const LightLayer& other) { return other.name == result.name; }))
            json_.refuse(name, "layers of different names",
                         fmt::format("a second \"{}\"", result.name));
        std::vector<std::string_view> names = {"name"};
        const files::Json* preset = value.find("preset");
        if (preset != nullptr) {
            const std::string layer_name = std::move(result.name);
            result = from_preset(*preset, json_.required(value, "direction"));
            result.name = layer_name;
            names.insert(names.end(), {"preset", "direction"});
        } else {
            result.region = kind<Region>(json_.required(value, "type"), "\"type\"", type_name);
            result.effect =
                kind<Effect>(json_.required(value, "effect"), "\"effect\"", effect_name);
            names.insert(names.end(), {"type", "effect"});
        }
        for (const LayerField& field : fields(result)) {
            names.push_back(field.name);
            const files::Json* given = value.find(field.name);
            if (!field.other_name.empty()) {
                names.push_back(field.other_name);
                const files::Json* other = value.find(field.other_name);
                if (given != nullptr && other != nullptr)
                    json_.refuse(
                        *other,
                        fmt::format("either \"{}\" or \"{}\"", field.name, field.other_name),
                        "both");
                given = given != nullptr ? given : other;
            }
            // A temperature is a colour, too.
            const bool is_colored = field.colour != nullptr && result.kelvin > 0.0;
            if (given != nullptr)
                set_values(field, numbers(field, *given));
            else if (field.required && preset == nullptr && !is_colored)
                (void)json_.required(value, field.name);
        }
        if (auto* patch = std::get_if<ImagePatch>(&result.effect)) {
            names.insert(names.end(), {"path", "blend"});
            *patch = image_patch(value);
        }
        json_.known(value, names,
                    fmt::format("a {} with the effect {}", type_name(result.region),
                                effect_name(result.effect)));
        try {
            validate(result);
        } catch (const std::invalid_argument& error) {
            json_.refuse(value, error.what());
        }
        return result;
    }

    KeyFrame frame(const files::Json& value, const LightLayers& before) const {
        json_.known(value, std::array<std::string_view, 2>{"frame", "layers"}, "a key frame");
        KeyFrame result;
        const files::Json& number = json_.required(value, "frame");
        result.frame = json_.number(number, "\"frame\"");
        if (!before.frames.empty() && !(result.frame > before.frames.back().frame))
            json_.refuse(number, fmt::format("a frame after {}", before.frames.back().frame),
                         fmt::format("{}", result.frame));
        for (const auto& [name, changes] :
             json_.object(json_.required(value, "layers"), "\"layers\" of a key frame")) {
            const auto found = std::find_if(
                before.layers.begin(), before.layers.end(),
                [&, &layer_name = name](const LightLayer& l) { return l.name == layer_name; });
            if (found == before.layers.end()) {
                std::vector<std::string> names;
                for (const LightLayer& each : before.layers)
                    names.push_back(each.name);
                json_.refuse(changes, "the name of a layer",
                             fmt::format("\"{}\"{}", name, files::did_you_mean(name, names)));
            }
            keyed_layer(*found, changes, before, result);
        }
        return result;
    }

    /// Adds one layer's values at a key frame. Refuses values that no layer may have.
    void keyed_layer(LightLayer layer, const files::Json& changes, const LightLayers& before,
                     KeyFrame& result) const {
        std::vector<std::string_view> names;
        const auto& members =
            json_.object(changes, fmt::format("the change of layer \"{}\"", layer.name));
        const std::vector<LayerField> all = fields(layer);
        for (const LayerField& field : all) {
            names.push_back(field.name);
            if (!field.other_name.empty())
                names.push_back(field.other_name);
        }
        json_.known(changes, names,
                    fmt::format("a key frame of a {} with the effect {}", type_name(layer.region),
                                effect_name(layer.effect)));
        for (const auto& [name, value] : members) {
            const auto field =
                std::find_if(all.begin(), all.end(), [&, &member = name](const LayerField& f) {
                    return f.name == member || f.other_name == member;
                });
            KeyedValue change{.layer = layer.name,
                              .field = std::string(field->name),
                              .values = numbers(*field, value)};
            for (const KeyFrame& earlier : before.frames) {
                for (const KeyedValue& other : earlier.changes) {
                    if (other.layer == change.layer && other.field == change.field &&
                        other.values.size() != change.values.size())
                        json_.refuse(value,
                                     fmt::format("as many points as at frame {}, {}", earlier.frame,
                                                 other.values.size() / 3),
                                     fmt::format("{}", change.values.size() / 3));
                }
            }
            set_values(*field, change.values);
            result.changes.push_back(std::move(change));
        }
        try {
            validate(layer);
        } catch (const std::invalid_argument& error) {
            json_.refuse(changes, error.what());
        }
    }

    std::filesystem::path folder_;
    const files::JsonReader& json_;
};

} // namespace

LightLayers load_layers(const std::filesystem::path& path) {
    const files::JsonReader json(path.string());
    return LayerFileReader(json, path.parent_path()).read(path);
}

std::vector<LightLayer> read_layers(const files::JsonReader& json, const files::Json& list,
                                    const std::filesystem::path& folder) {
    return LayerFileReader(json, folder).layers(list);
}

} // namespace relumine::cubemap
