// The methods that place a few distant lights for an environment, by name.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"
#include "lights/light_list.h"
#include "lights/pixel_rectangle.h"

namespace relumine::lights {

/// How lights are chosen.
enum class Method {
    /// Regions of equal energy [D05], see lights/median_cut.h.
    MedianCut,
    /// Regions whose energy lies close together [VD09], see lights/variance_cut.h.
    VarianceCut,
    /// Stratified random directions, more likely in bright places, see
    /// lights/importance_sampling.h.
    Importance,
};
inline constexpr std::array AllMethods = {Method::MedianCut, Method::VarianceCut,
                                          Method::Importance};

/// Returns "median-cut", "variance" or "importance".
[[nodiscard]] std::string_view name(Method method);
/// Returns the method of a name. Nothing for an unknown name.
[[nodiscard]] std::optional<Method> method_named(std::string_view name);

/// The lights, and the rectangle of each light for methods that cut the image into rectangles.
struct Placement {
    std::vector<DistantLight> lights;
    /// [lights], or empty for other methods.
    std::vector<PixelRectangle> regions;
};

/// Places exactly `num_lights` lights for a lat-long image. For every method the total irradiance
/// is the map's power per channel (to rounding), and a light's solid angle is the solid angle of
/// its pixels. A map without light gets lights of irradiance 0.
///
/// Result:  bitwise the same for the same seed and any number of threads. Only Importance draws
///          random numbers.
/// Throws:  std::invalid_argument unless 1 <= num_lights <= pixels, and for images that LatLongGrid
///          refuses.
[[nodiscard]] Placement place(Method method, const cubemap::EnvironmentImage& lat_long,
                              std::size_t num_lights, std::uint64_t seed = 1);

/// Returns a cube map as the lat-long on which lights are placed: 4R x 2R, energy kept.
[[nodiscard]] cubemap::EnvironmentImage lat_long_of(const cubemap::CubeMap& map);

/// Returns the lights of place() for a cube map.
[[nodiscard]] std::vector<DistantLight> place_lights(Method method, const cubemap::CubeMap& map,
                                                     std::size_t num_lights,
                                                     std::uint64_t seed = 1);

} // namespace relumine::lights
