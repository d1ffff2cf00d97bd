#include "cubemap/layers/layer_file.h"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "cubemap/layers/layer_list.h"
#include "files/joined.h"
#include "files/json_value.h"
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
        const files::JsonValue root = json_.parse(files::read(path));
        const auto& members = json_.object(root, "a layer file");
        json_.known(members,
                    std::array<std::string_view, 5>{"version", "base", "rotate_degrees", "layers",
                                                    "frames"},
                    "a layer file");
        const files::JsonValue& version = json_.required(root, members, "version");
        if (const double got = json_.number(version, "\"version\""); got != Version)
            json_.refuse(version.line, fmt::format("version {}", Version), fmt::format("{}", got));
        LightLayers result;
        if (const files::JsonValue* base = files::JsonReader::find(members, "base"))
            result.base = json_.string(*base, "\"base\"");
        if (const files::JsonValue* turn = files::JsonReader::find(members, "rotate_degrees"))
            result.rotate_degrees = json_.number(*turn, "\"rotate_degrees\"");
        result.layers = layers(json_.required(root, members, "layers"));
        if (const files::JsonValue* frames = files::JsonReader::find(members, "frames")) {
            for (const files::JsonValue& value : json_.array(*frames, "\"frames\""))
                result.frames.push_back(frame(value, result));
        }
        return result;
    }

    std::vector<LightLayer> layers(const files::JsonValue& list) const {
        std::vector<LightLayer> result;
        for (const files::JsonValue& value : json_.array(list, "\"layers\""))
            result.push_back(layer(value, result));
        return result;
    }

private:
    std::vector<double> vector3(const files::JsonValue& value, std::string_view what) const {
        const auto& array = json_.array(value, what);
        if (array.size() != 3)
            json_.refuse(value.line, fmt::format("{} of 3 numbers", what),
                         fmt::format("{}", array.size()));
        return {json_.number(array[0], what), json_.number(array[1], what),
                json_.number(array[2], what)};
    }

    std::vector<double> numbers(const LayerField& field, const files::JsonValue& value) const {
        const std::string what = fmt::format("\"{}\"", field.name);
        if (field.flag != nullptr)
            return {json_.boolean(value, what) ? 1.0 : 0.0};
        if (field.number != nullptr || field.single != nullptr)
            return {json_.number(value, what)};
        if (field.points == nullptr)
            return vector3(value, what);
        std::vector<double> result;
        for (const files::JsonValue& point : json_.array(value, what)) {
            const std::vector<double> three = vector3(point, "a point");
            result.insert(result.end(), three.begin(), three.end());
        }
        return result;
    }

    /// Returns the kind with a name.
    template<typename Variant>
    Variant kind(const files::JsonValue& value, std::string_view what,
                 std::string_view (*name)(const Variant&)) const {
        const std::string& text = json_.string(value, what);
        std::vector<std::string_view> names;
        for (const Variant& candidate : files::one_of_each<Variant>()) {
            if (name(candidate) == text)
                return candidate;
            names.push_back(name(candidate));
        }
        json_.refuse(value.line,
                     fmt::format("{} to be one of {}", what, files::joined(names, ", ")),
                     fmt::format("\"{}\"{}", text, files::did_you_mean(text, names)));
    }

    ImagePatch image_patch(const files::JsonValue& owner,
                           const files::JsonValue::Object& members) const {
        ImagePatch patch;
        const files::JsonValue& path = json_.required(owner, members, "path");
        patch.path = json_.string(path, "\"path\"");
        if (const files::JsonValue* blend = files::JsonReader::find(members, "blend")) {
            const std::string& text = json_.string(*blend, "\"blend\"");
            if (text != "replace" && text != "add")
                json_.refuse(blend->line, "\"blend\" to be replace or add",
                             fmt::format("\"{}\"", text));
            patch.blend = text == "add" ? ImagePatch::Blend::Add : ImagePatch::Blend::Replace;
        }
        try {
            patch.picture = load_image_pyramid(folder_ / patch.path);
        } catch (const std::runtime_error& error) {
            json_.refuse(path.line, "a picture", error.what());
        }
        return patch;
    }

    LightLayer layer(const files::JsonValue& value, const std::vector<LightLayer>& others) const {
        const auto& members = json_.object(value, "a layer");
        LightLayer result;
        const files::JsonValue& name = json_.required(value, members, "name");
        result.name = json_.string(name, "\"name\"");
        if (std::any_of(others.begin(), others.end(),
                        [&](const LightLayer& other) { return other.name == result.name; }))
            json_.refuse(name.line, "layers of different names",
                         fmt::format("a second \"{}\"", result.name));
        result.region = kind<Region>(json_.required(value, members, "type"), "\"type\"", type_name);
        result.effect =
            kind<Effect>(json_.required(value, members, "effect"), "\"effect\"", effect_name);
        std::vector<std::string_view> names = {"name", "type", "effect"};
        for (const LayerField& field : fields(result)) {
            names.push_back(field.name);
            const files::JsonValue* given = files::JsonReader::find(members, field.name);
            if (given != nullptr)
                set_values(field, numbers(field, *given));
            else if (field.required)
                (void)json_.required(value, members, field.name);
        }
        if (auto* patch = std::get_if<ImagePatch>(&result.effect)) {
            names.insert(names.end(), {"path", "blend"});
            *patch = image_patch(value, members);
        }
        json_.known(members, names,
                    fmt::format("a {} with the effect {}", type_name(result.region),
                                effect_name(result.effect)));
        try {
            validate(result);
        } catch (const std::invalid_argument& error) {
            throw std::runtime_error(
                fmt::format("{}:{}: {}", json_.name(), value.line, error.what()));
        }
        return result;
    }

    KeyFrame frame(const files::JsonValue& value, const LightLayers& before) const {
        const auto& members = json_.object(value, "a key frame");
        json_.known(members, std::array<std::string_view, 2>{"frame", "layers"}, "a key frame");
        KeyFrame result;
        const files::JsonValue& number = json_.required(value, members, "frame");
        result.frame = json_.number(number, "\"frame\"");
        if (!before.frames.empty() && !(result.frame > before.frames.back().frame))
            json_.refuse(number.line, fmt::format("a frame after {}", before.frames.back().frame),
                         fmt::format("{}", result.frame));
        for (const auto& [name, changes] :
             json_.object(json_.required(value, members, "layers"), "\"layers\" of a key frame")) {
            const auto found = std::find_if(
                before.layers.begin(), before.layers.end(),
                [&, &layer_name = name](const LightLayer& l) { return l.name == layer_name; });
            if (found == before.layers.end()) {
                std::vector<std::string> names;
                for (const LightLayer& each : before.layers)
                    names.push_back(each.name);
                json_.refuse(changes.line, "the name of a layer",
                             fmt::format("\"{}\"{}", name, files::did_you_mean(name, names)));
            }
            keyed_layer(*found, changes, before, result);
        }
        return result;
    }

    /// Adds one layer's values at a key frame. Refuses values that no layer may have.
    void keyed_layer(LightLayer layer, const files::JsonValue& changes, const LightLayers& before,
                     KeyFrame& result) const {
        std::vector<std::string_view> names;
        const auto& members =
            json_.object(changes, fmt::format("the change of layer \"{}\"", layer.name));
        const std::vector<LayerField> all = fields(layer);
        names.reserve(all.size());
        for (const LayerField& field : all)
            names.push_back(field.name);
        json_.known(members, names,
                    fmt::format("a key frame of a {} with the effect {}", type_name(layer.region),
                                effect_name(layer.effect)));
        for (const auto& [name, value] : members) {
            const auto field =
                std::find_if(all.begin(), all.end(),
                             [&, &member = name](const LayerField& f) { return f.name == member; });
            KeyedValue change{.layer = layer.name, .field = name, .values = numbers(*field, value)};
            for (const KeyFrame& earlier : before.frames) {
                for (const KeyedValue& other : earlier.changes) {
                    if (other.layer == change.layer && other.field == name &&
                        other.values.size() != change.values.size())
                        json_.refuse(value.line,
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
            throw std::runtime_error(
                fmt::format("{}:{}: {}", json_.name(), changes.line, error.what()));
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

std::vector<LightLayer> read_layers(const files::JsonReader& json, const files::JsonValue& list,
                                    const std::filesystem::path& folder) {
    return LayerFileReader(json, folder).layers(list);
}

} // namespace relumine::cubemap
