#include "cubemap/layers/light_layer.h"

#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

namespace relumine::cubemap {

namespace {

void check_colour(std::string_view what, const glm::vec3& colour, double scale) {
    for (const float value : {colour.x, colour.y, colour.z}) {
        if (!(value >= 0.0f) || !std::isfinite(static_cast<float>(value * scale)))
            refuse(what, "to be finite and at least 0 (gain_ev included)",
                   fmt::format("({}, {}, {})", colour.x, colour.y, colour.z));
    }
}

struct CheckEffect {
    /// 2^gain_ev
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
        std::visit(CheckEffect{std::exp2(layer.gain_ev), layer.region}, layer.effect);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(
            fmt::format("light layer \"{}\": {}", layer.name, error.what()));
    }
}

std::vector<LayerField> own_fields(LightLayer& layer) {
    return {{.name = "on", .flag = &layer.on},
            {.name = "gain_ev",
             .range = {-100.0, 100.0},
             .slider = FieldRange{-12.0, 12.0},
             .number = &layer.gain_ev}};
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

std::string_view effect_name(const Effect& effect) {
    return std::visit([]<typename Kind>(const Kind&) { return Kind::Name; }, effect);
}

} // namespace relumine::cubemap
