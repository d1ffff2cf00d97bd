// A few distant lights that stand for an environment: the methods by name.
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
    /// Regions of equal energy [D05]: lights/median_cut.h
    MedianCut,
    /// Regions whose energy lies close together [VD09]: lights/variance_cut.h
    VarianceCut,
    /// Stratified random directions, likely where it is bright: lights/importance_sampling.h
    Importance,
};
inline constexpr std::array AllMethods = {Method::MedianCut, Method::VarianceCut,
                                          Method::Importance};

/// "median-cut", "variance", "importance".
[[nodiscard]] std::string_view name(Method method);
/// The method of a name, or nothing.
[[nodiscard]] std::optional<Method> method_named(std::string_view name);

/// The lights and, for the methods that cut the image into rectangles, the rectangle of each light.
struct Placement {
    std::vector<DistantLight> lights;
    /// [lights], or none
    std::vector<PixelRectangle> regions;
};

/// Exactly `num_lights` lights for a lat-long image. Whatever the method, their total irradiance is
/// the map's power per channel (to rounding) and their solid angles are those of the pixels they
/// stand for; a map without light gets lights of irradiance 0. Bitwise the same for the same seed
/// (only Importance draws numbers) and for any number of threads. Throws std::invalid_argument
/// unless 1 <= num_lights <= pixels, and for images that LatLongGrid refuses.
[[nodiscard]] Placement place(Method method, const cubemap::EnvironmentImage& lat_long,
                              std::size_t num_lights, std::uint64_t seed = 1);

/// A cube map as the lat-long that lights are placed on: 4R x 2R, energy kept.
[[nodiscard]] cubemap::EnvironmentImage lat_long_of(const cubemap::CubeMap& map);

/// The lights of place() for a cube map.
[[nodiscard]] std::vector<DistantLight> place_lights(Method method, const cubemap::CubeMap& map,
                                                     std::size_t num_lights,
                                                     std::uint64_t seed = 1);

} // namespace relumine::lights
