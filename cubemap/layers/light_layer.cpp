#include "cubemap/layers/light_layer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "cubemap/kelvin.h"

namespace relumine::cubemap {

namespace {

void check_colour(std::string_view what, const glm::vec3& colour, double scale) {
    for (const float value : {colour.x, colour.y, colour.z}) {
        if (!(value >= 0.0f) || !std::isfinite(static_cast<float>(value * scale)))
            refuse(what, "to be finite and at least 0 (gain_ev and kelvin included)",
                   fmt::format("({}, {}, {})", colour.x, colour.y, colour.z));
    }
}

struct CheckEffect {
    /// The largest of strength().
    double scale;
    const Region& region;
    void operator()(const Emit& emit) const { check_colour("radiance", emit.radiance, scale); }
    void operator()(const Gain& gain) const {
        if (!(gain.factor >= 0.0f) || !std::isfinite(gain.factor))
            refuse("factor", "to be finite and at least 0", fmt::format("{}", gain.factor));
        check_colour("tint", gain.tint, scale * gain.factor);
    }
    void operator()(const ImagePatch& patch) const {
        if (!std::holds_alternative<Rectangle>(region))
            refuse("an image", "on a rectangle", "another region");
        if (!patch.picture)
            refuse("an image", "with its picture loaded", "none");
        // The last level is the mean, so edits need not visit all pixels.
        check_colour("the picture's mean radiance", patch.picture->levels().back().pixels.front(),
                     scale);
    }
};

struct EffectFields {
    std::vector<LayerField> operator()(Emit& emit) const {
        return {{.name = "radiance", .required = true, .colour = &emit.radiance}};
    }
    std::vector<LayerField> operator()(Gain& gain) const {
        return {{.name = "factor",
                 .slider = FieldRange{0.0, 16.0},
                 .logarithmic_slider = true,
                 .single = &gain.factor},
                {.name = "tint", .colour = &gain.tint}};
    }
    std::vector<LayerField> operator()(ImagePatch&) const { return {}; }
};

} // namespace

bool ImagePatch::operator==(const ImagePatch& other) const {
    const bool same_picture =
        picture == other.picture || (picture && other.picture && *picture == *other.picture);
    return same_picture && path == other.path && blend == other.blend;
}

void validate(const LightLayer& layer) {
    try {
        for (const LayerField& field : own_fields(const_cast<LightLayer&>(layer))) // only read
            check(field);
        validate(layer.region);
        const glm::vec3 factors = strength(layer);
        std::visit(CheckEffect{std::max({factors.r, factors.g, factors.b}), layer.region},
                   layer.effect);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(
            fmt::format("light layer \"{}\": {}", layer.name, error.what()));
    }
}

std::vector<LayerField> own_fields(LightLayer& layer) {
    return {{.name = "on", .flag = &layer.on},
            {.name = "solo", .flag = &layer.solo},
            {.name = "camera", .flag = &layer.camera},
            {.name = "gain_ev",
             .other_name = "exposure",
             .range = {-100.0, 100.0},
             .slider = FieldRange{-12.0, 12.0},
             .number = &layer.gain_ev},
            {.name = "kelvin",
             .range = {0.0, HighestKelvin},
             .least_but_zero = LowestKelvin,
             .number = &layer.kelvin}};
}

std::vector<LayerField> fields(LightLayer& layer) {
    std::vector<LayerField> result = own_fields(layer);
    for (const std::vector<LayerField>& part : {fields(layer.region), fields(layer.effect)})
        result.insert(result.end(), part.begin(), part.end());
    return result;
}

std::vector<LayerField> fields(Effect& effect) {
    return std::visit(EffectFields{}, effect);
}

glm::vec3 strength(const LightLayer& layer) {
    const auto gain = static_cast<float>(std::exp2(layer.gain_ev));
    return layer.kelvin > 0.0 ? gain * kelvin_color(layer.kelvin) : glm::vec3(gain);
}

bool has_solo(std::span<const LightLayer> layers) {
    return std::any_of(layers.begin(), layers.end(),
                       [](const LightLayer& layer) { return layer.on && layer.solo; });
}

bool shines(const LightLayer& layer, bool is_solo) {
    return layer.on && (layer.solo || !is_solo);
}

bool hides_from_camera(std::span<const LightLayer> layers) {
    const bool is_solo = has_solo(layers);
    return std::any_of(layers.begin(), layers.end(), [&](const LightLayer& layer) {
        return !layer.camera && shines(layer, is_solo);
    });
}

std::vector<LightLayer> seen_layers(std::span<const LightLayer> layers) {
    std::vector<LightLayer> result = without_solo(layers);
    for (LightLayer& layer : result)
        layer.on = layer.on && layer.camera;
    return result;
}

std::vector<LightLayer> without_solo(std::span<const LightLayer> layers) {
    std::vector<LightLayer> result;
    const bool is_solo = has_solo(layers);
    // Two discs that overlap: the rim of each lies well inside of the other.
    for (const double z : {1.0, -1.0})
        if (is_solo)
            result.push_back({.name = "black",
                              .region = Disc{.direction = {0.0, 0.0, z}, .radius_degrees = 120.0},
                              .effect = Gain{0.0f}});
    for (const LightLayer& layer : layers) {
        result.push_back(layer);
        result.back().on = shines(layer, is_solo);
        result.back().solo = false;
    }
    return result;
}

std::string_view effect_name(const Effect& effect) {
    return std::visit([]<typename Kind>(const Kind&) { return Kind::Name; }, effect);
}

} // namespace relumine::cubemap
