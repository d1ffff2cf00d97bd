#include "cubemap/layers/layer_fields.h"

#include <array>
#include <cassert>

namespace relumine::cubemap {

namespace {

struct RegionFields {
    std::vector<LayerField>& out;
    void operator()(Disc& disc) const {
        out.push_back({.name = "direction", .required = true, .direction = &disc.direction});
        out.push_back({.name = "radius_degrees", .required = true, .number = &disc.radius_degrees});
        out.push_back({.name = "softness", .number = &disc.softness});
    }
    void operator()(Rectangle& rectangle) const {
        out.push_back({.name = "direction", .required = true, .direction = &rectangle.direction});
        out.push_back(
            {.name = "width_degrees", .required = true, .number = &rectangle.width_degrees});
        out.push_back(
            {.name = "height_degrees", .required = true, .number = &rectangle.height_degrees});
        out.push_back({.name = "roll_degrees", .number = &rectangle.roll_degrees});
        out.push_back({.name = "softness", .number = &rectangle.softness});
    }
    void operator()(Lasso& lasso) const {
        out.push_back({.name = "points", .required = true, .points = &lasso.points});
        out.push_back({.name = "softness_degrees", .number = &lasso.softness_degrees});
    }
    void operator()(Stroke& stroke) const {
        out.push_back({.name = "points", .required = true, .points = &stroke.points});
        out.push_back(
            {.name = "radius_degrees", .required = true, .number = &stroke.radius_degrees});
        out.push_back({.name = "softness", .number = &stroke.softness});
    }
};

struct EffectFields {
    std::vector<LayerField>& out;
    void operator()(Emit& emit) const {
        out.push_back({.name = "radiance", .required = true, .colour = &emit.radiance});
    }
    void operator()(Gain& gain) const {
        out.push_back({.name = "factor", .single = &gain.factor});
        out.push_back({.name = "tint", .colour = &gain.tint});
    }
    void operator()(ImagePatch&) const {}
};

} // namespace

std::vector<LayerField> fields(LightLayer& layer) {
    std::vector<LayerField> result;
    result.push_back({.name = "on", .flag = &layer.on});
    result.push_back({.name = "gain_ev", .number = &layer.gain_ev});
    std::visit(RegionFields{result}, layer.region);
    std::visit(EffectFields{result}, layer.effect);
    return result;
}

std::vector<double> values(const LayerField& field) {
    if (field.flag != nullptr)
        return {*field.flag ? 1.0 : 0.0};
    if (field.number != nullptr)
        return {*field.number};
    if (field.single != nullptr)
        return {static_cast<double>(*field.single)};
    if (field.colour != nullptr)
        return {static_cast<double>(field.colour->x), static_cast<double>(field.colour->y),
                static_cast<double>(field.colour->z)};
    if (field.direction != nullptr)
        return {field.direction->x, field.direction->y, field.direction->z};
    std::vector<double> result;
    for (const glm::dvec3& point : *field.points)
        result.insert(result.end(), {point.x, point.y, point.z});
    return result;
}

void set_values(const LayerField& field, std::span<const double> numbers) {
    assert((field.points != nullptr
                ? numbers.size() % 3 == 0
                : numbers.size() == (field.colour || field.direction ? 3u : 1u)) &&
           "a field takes as many numbers as it has");
    if (field.flag != nullptr) {
        *field.flag = numbers[0] != 0.0;
    } else if (field.number != nullptr) {
        *field.number = numbers[0];
    } else if (field.single != nullptr) {
        *field.single = static_cast<float>(numbers[0]);
    } else if (field.colour != nullptr) {
        *field.colour = glm::vec3(glm::dvec3(numbers[0], numbers[1], numbers[2]));
    } else if (field.direction != nullptr) {
        *field.direction = {numbers[0], numbers[1], numbers[2]};
    } else {
        field.points->clear();
        for (std::size_t i = 0; i < numbers.size(); i += 3)
            field.points->emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    }
}

std::string_view type_name(const Region& region) {
    constexpr std::array<std::string_view, 4> Names = {"disc", "rectangle", "lasso", "stroke"};
    return Names[region.index()];
}

std::string_view effect_name(const Effect& effect) {
    constexpr std::array<std::string_view, 3> Names = {"emit", "gain", "image"};
    return Names[effect.index()];
}

} // namespace relumine::cubemap
