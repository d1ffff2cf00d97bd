// Splits the sun off an environment: one light, and the map without the sun.
#pragma once

#include <filesystem>
#include <optional>

#include "cubemap/cube_map.h"
#include "cubemap/doctor/sun.h"
#include "cubemap/image/environment.h"
#include "lights/light_list.h"

namespace relumine::lights {

/// Returns the name of the sun's light list beside a map that it was split off: "sky.sun.json" for
/// "sky.exr".
[[nodiscard]] std::filesystem::path sun_file_of(std::filesystem::path map);

/// Returns true if the sun was split off the map: its light list lies beside it.
[[nodiscard]] bool has_sun_file(const std::filesystem::path& map);

/// Returns the sun as a light: a disc of its solid angle and of uniform radiance. Light and map
/// together light a surface like the original.
[[nodiscard]] DistantLight sun_light(const cubemap::Sun& sun);

/// Replaces the sun by the sky around it. `sun` must have been found in this image or map.
void remove_sun(cubemap::EnvironmentImage& image, const cubemap::Sun& sun);
void remove_sun(cubemap::CubeMap& map, const cubemap::Sun& sun);

template<typename Map>
struct SunSplit {
    DistantLight sun;
    Map rest;
};

/// Finds the sun and splits it off. Returns nothing if cubemap::find_sun() finds no sun.
[[nodiscard]] std::optional<SunSplit<cubemap::EnvironmentImage>>
split_sun(const cubemap::EnvironmentImage& image);
[[nodiscard]] std::optional<SunSplit<cubemap::CubeMap>> split_sun(const cubemap::CubeMap& map);

} // namespace relumine::lights
