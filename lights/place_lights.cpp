#include "lights/place_lights.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "cubemap/resample.h"
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
        throw std::invalid_argument(fmt::format("expected 1 to {} lights for {} x {} pixels, got {}",
                                                grid.num_pixels(), grid.width(), grid.height(), num_lights));
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

cubemap::EnvironmentImage lat_long_of(const cubemap::CubeMap& map) {
    return cubemap::to_image(map, cubemap::Layout::LatLong, 4 * map.resolution, 2 * map.resolution);
}

std::vector<DistantLight> place_lights(Method method, const cubemap::CubeMap& map, std::size_t num_lights,
                                       std::uint64_t seed) {
    return place(method, lat_long_of(map), num_lights, seed).lights;
}

} // namespace relumine::lights
