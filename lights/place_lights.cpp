#include "lights/place_lights.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "cubemap/resample/resample.h"
#include "lights/importance_sampling.h"
#include "lights/median_cut.h"
#include "lights/region_cuts.h"
#include "lights/variance_cut.h"

namespace relumine::lights {

std::string_view name(Method method) {
    switch (method) {
    case Method::MedianCut:
        return "median-cut";
    case Method::VarianceCut:
        return "variance";
    case Method::Importance:
        return "importance";
    }
    throw std::invalid_argument("expected a method");
}

std::optional<Method> method_named(std::string_view wanted) {
    const auto found = std::find_if(AllMethods.begin(), AllMethods.end(),
                                    [&](Method method) { return name(method) == wanted; });
    return found != AllMethods.end() ? std::optional(*found) : std::nullopt;
}

Placement place(Method method, const cubemap::EnvironmentImage& lat_long, std::size_t num_lights,
                std::uint64_t seed) {
    const LatLongGrid grid(lat_long);
    if (num_lights < 1 || num_lights > grid.num_pixels())
        throw std::invalid_argument(
            fmt::format("expected 1 to {} lights for {} x {} pixels, got {}", grid.num_pixels(),
                        grid.width(), grid.height(), num_lights));
    Placement result;
    if (method == Method::Importance) {
        result.lights = importance_sample(grid, num_lights, seed);
        return result;
    }
    result.regions =
        method == Method::MedianCut ? median_cut(grid, num_lights) : variance_cut(grid, num_lights);
    result.lights = lights_of(grid, result.regions);
    return result;
}

namespace {

glm::dvec3 power(const LatLongGrid& grid) {
    glm::dvec3 sum(0.0);
    for (std::uint32_t y = 0; y < grid.height(); ++y) {
        glm::dvec3 row(0.0);
        for (std::uint32_t x = 0; x < grid.width(); ++x)
            row += grid.radiance(x, y) * grid.solid_angle(x, y);
        sum += row;
    }
    return sum;
}

} // namespace

cubemap::EnvironmentImage lat_long_of(const cubemap::CubeMap& map) {
    cubemap::EnvironmentImage image =
        cubemap::to_image(map, cubemap::Layout::LatLong, 4 * map.resolution, 2 * map.resolution);
    // Values that are negative in the map itself stay, so they are refused later.
    const auto is_positive = [](const glm::vec3& texel) {
        return texel.r >= 0.0f && texel.g >= 0.0f && texel.b >= 0.0f;
    };
    if (image.pixels.empty() || !std::all_of(map.texels.begin(), map.texels.end(), is_positive))
        return image;
    // The mean over overlaps of footprints may leave -1e-28 beside a bright texel, and may lose up
    // to 1e-6 of a single bright texel. Lights have to keep the power better than this.
    for (glm::vec3& pixel : image.pixels)
        pixel = glm::max(pixel, glm::vec3(0.0f));
    const glm::dvec3 wanted = cubemap::total_power(map);
    const glm::dvec3 got = power(LatLongGrid(image));
    glm::dvec3 factor(1.0);
    for (int channel = 0; channel < 3; ++channel)
        if (got[channel] > 0.0)
            factor[channel] = wanted[channel] / got[channel];
    for (glm::vec3& pixel : image.pixels)
        pixel = glm::vec3(glm::dvec3(pixel) * factor);
    return image;
}

std::vector<DistantLight> place_lights(Method method, const cubemap::CubeMap& map,
                                       std::size_t num_lights, std::uint64_t seed) {
    return place(method, lat_long_of(map), num_lights, seed).lights;
}

} // namespace relumine::lights
