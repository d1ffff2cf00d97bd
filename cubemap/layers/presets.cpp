#include "cubemap/layers/presets.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "cubemap/layers/shapes/sphere_lines.h"

namespace relumine::cubemap {

namespace {

/// Points at an angle around +Z; the first one again at the end, for `is_closed`.
std::vector<glm::dvec3> circle(double angle_degrees, int count, bool is_closed) {
    const double angle = angle_degrees * RadiansPerDegree;
    std::vector<glm::dvec3> points;
    for (int i = 0; i < count + (is_closed ? 1 : 0); ++i) {
        const double around = 2.0 * std::numbers::pi * (i % count + 0.5) / count;
        points.emplace_back(std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around),
                            std::cos(angle));
    }
    return points;
}

LayerPreset preset(std::string_view name, std::string_view hint, Region region, Effect effect) {
    return {name,
            hint,
            {.name = std::string(name), .region = std::move(region), .effect = std::move(effect)}};
}

Emit light(float radiance) {
    return {.radiance = glm::vec3(radiance)};
}

} // namespace

std::span<const LayerPreset> layer_presets() {
    static const std::vector<LayerPreset> all = {
        preset("softbox", "a soft box with even light", Rectangle::as_added(), light(1.0f)),
        preset("gradient", "a soft box that is brightest in its middle and falls to its sides",
               Rectangle{.width_degrees = 50.0, .height_degrees = 35.0, .softness = 1.0},
               light(1.5f)),
        preset("strip", "a tall, narrow soft box for rims and long highlights",
               Rectangle{.width_degrees = 8.0, .height_degrees = 60.0, .softness = 0.3},
               light(2.0f)),
        preset("scrim", "a large diffuser: faint light without visible edges",
               Rectangle{.width_degrees = 100.0, .height_degrees = 70.0, .softness = 0.7},
               light(0.3f)),
        preset("octabox", "a soft box of eight corners",
               Lasso{.points = circle(18.0, 8, false), .softness_degrees = 3.0}, light(1.0f)),
        preset("ring", "a ring, as around a lens",
               Stroke{.points = circle(12.0, 48, true), .radius_degrees = 2.5, .softness = 0.4},
               light(2.0f)),
        preset("bulb", "a small, bright light with crisp shadows",
               Disc{.radius_degrees = 1.5, .softness = 0.3}, light(100.0f)),
        preset("dome", "half of the sphere: fill light",
               Disc{.radius_degrees = 90.0, .softness = 0.6}, light(0.15f)),
        preset("flag", "black cloth: takes the light away behind it",
               Rectangle{.width_degrees = 40.0, .height_degrees = 30.0, .softness = 0.15},
               Gain{.factor = 0.03f})};
    return all;
}

const LayerPreset* find_preset(std::string_view name) {
    const std::span<const LayerPreset> all = layer_presets();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const LayerPreset& each) { return each.name == name; });
    return found == all.end() ? nullptr : &*found;
}

LightLayer placed(const LayerPreset& preset, const glm::dvec3& direction) {
    LightLayer layer = preset.layer;
    layer.region = centred(std::move(layer.region), direction);
    return layer;
}

} // namespace relumine::cubemap
