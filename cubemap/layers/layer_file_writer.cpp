// Writes light layers as JSON.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "cubemap/layers/layer_file.h"
#include "files/json.h"
#include "files/output_file.h"

namespace relumine::cubemap {

namespace {

using files::Json;

/// Returns the shortest decimal that reads back as the same float. As a double, the float would
/// have many digits.
double shortest(float value) {
    std::array<char, 32> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    double result = 0.0;
    std::from_chars(text.data(), end, result);
    return result;
}

Json json(const LayerField& field, std::span<const double> numbers) {
    if (field.flag != nullptr)
        return numbers[0] != 0.0;
    if (field.number != nullptr || field.single != nullptr)
        return numbers[0];
    if (field.points == nullptr)
        return Json::Array{numbers[0], numbers[1], numbers[2]};
    Json points = Json::Array{};
    for (std::size_t i = 0; i < numbers.size(); i += 3)
        points.push_back(Json::Array{numbers[i], numbers[i + 1], numbers[i + 2]});
    return points;
}

Json json(LightLayer layer) {
    Json result = {{"name", layer.name}, {"type", type_name(layer.region)}};
    for (const LayerField& field : fields(layer)) {
        std::vector<double> numbers = values(field);
        if (field.single != nullptr || field.colour != nullptr) {
            for (double& number : numbers)
                number = shortest(static_cast<float>(number));
        }
        result.set(field.name, json(field, numbers));
    }
    result.set("effect", effect_name(layer.effect));
    if (const auto* patch = std::get_if<ImagePatch>(&layer.effect)) {
        result.set("path", patch->path.string());
        result.set("blend", patch->blend == ImagePatch::Blend::Add ? "add" : "replace");
    }
    return result;
}

Json json(const KeyFrame& key, std::vector<LightLayer> layers) {
    Json changes = Json::Object{};
    for (const KeyedValue& change : key.changes) {
        const auto layer = std::find_if(layers.begin(), layers.end(), [&](const LightLayer& l) {
            return l.name == change.layer;
        });
        if (layer == layers.end())
            throw std::invalid_argument(fmt::format(
                "key frame {}: expected the name of a layer, got \"{}\"", key.frame, change.layer));
        const std::vector<LayerField> all = fields(*layer);
        const auto field = std::find_if(
            all.begin(), all.end(), [&](const LayerField& f) { return f.name == change.field; });
        const bool fits =
            field != all.end() &&
            (field->points != nullptr ? change.values.size() % 3 == 0
                                      : change.values.size() == values(*field).size());
        if (!fits || !std::all_of(change.values.begin(), change.values.end(),
                                  [](double value) { return std::isfinite(value); }))
            throw std::invalid_argument(
                fmt::format("key frame {}: expected finite values of a field of \"{}\", got \"{}\"",
                            key.frame, change.layer, change.field));
        const Json* before = changes.find(change.layer);
        Json of_layer = before != nullptr ? *before : Json::Object{};
        of_layer.set(change.field, json(*field, change.values));
        changes.set(change.layer, std::move(of_layer));
    }
    return {{"frame", key.frame}, {"layers", std::move(changes)}};
}

void check_for_save(const LightLayers& layers) {
    for (std::size_t i = 0; i < layers.layers.size(); ++i) {
        validate(layers.layers[i]);
        for (std::size_t j = 0; j < i; ++j) {
            if (layers.layers[i].name == layers.layers[j].name)
                throw std::invalid_argument(
                    fmt::format("light layers: expected different names, got \"{}\" twice",
                                layers.layers[i].name));
        }
    }
    for (std::size_t i = 1; i < layers.frames.size(); ++i) {
        if (!(layers.frames[i - 1].frame < layers.frames[i].frame))
            throw std::invalid_argument(
                fmt::format("key frames: expected ascending frames, got {} after {}",
                            layers.frames[i].frame, layers.frames[i - 1].frame));
    }
    if (!std::isfinite(layers.rotate_degrees.value_or(0.0)))
        throw std::invalid_argument("light layers: expected a finite rotation");
    for (const KeyFrame& key : layers.frames)
        (void)layers_at(layers, key.frame);
}

} // namespace

std::string json_text(const LightLayers& layers) {
    check_for_save(layers);
    Json root = {{"version", 1}};
    if (layers.base)
        root.set("base", layers.base->string());
    if (layers.rotate_degrees)
        root.set("rotate_degrees", *layers.rotate_degrees);
    Json all = Json::Array{};
    for (const LightLayer& layer : layers.layers)
        all.push_back(json(layer));
    root.set("layers", std::move(all));
    if (!layers.frames.empty()) {
        Json frames = Json::Array{};
        for (const KeyFrame& key : layers.frames)
            frames.push_back(json(key, layers.layers));
        root.set("frames", std::move(frames));
    }
    try {
        return root.text(2, Json::Order::Set, Json::Utf8::Require) + '\n';
    } catch (const files::JsonError&) {
        throw std::invalid_argument(
            "light layers: expected names and paths in UTF-8, got other bytes");
    }
}

void save_layers(const std::filesystem::path& path, const LightLayers& layers) {
    files::save_text(path, json_text(layers));
}

} // namespace relumine::cubemap
