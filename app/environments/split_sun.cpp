#include "app/environments/split_sun.h"

#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "relumine/ask/environment_doctor.h"
#include "relumine/light/light_lists.h"

namespace relumine::app {

SunFile::SunFile(const std::filesystem::path& map_path) : file_(lights::sun_file_of(map_path)) {}

SunFile::Split SunFile::split(cubemap::EnvironmentImage& image, const glm::dmat3& world_from_image,
                              const std::string& source) {
    const cubemap::SunSearch found = cubemap::find_sun(image);
    if (!found.sun)
        throw std::runtime_error(
            fmt::format("{}: expected a sun to split off, got none: {}", source, found.why_none));
    lights::remove_sun(image, *found.sun);

    lights::DistantLight light = lights::sun_light(*found.sun);
    light.direction = world_from_image * light.direction;
    const std::string text =
        lights::json_text({.lights = {light},
                           .environment = std::filesystem::path(source).filename().string(),
                           .method = "sun"});
    file_.write(std::as_bytes(std::span(text)));
    const cubemap::SkyAngles angles = cubemap::sky_angles(light.direction);
    Report report = {{"file", path()},
                     {"direction", light.direction},
                     {"azimuth_degrees", angles.azimuth_degrees},
                     {"elevation_degrees", angles.elevation_degrees},
                     {"irradiance", light.irradiance},
                     {"solid_angle", light.solid_angle},
                     {"diameter_degrees", cubemap::disc_diameter_degrees(light.solid_angle)},
                     {"share_of_power", found.sun->share_of_power}};
    return {.report = std::move(report), .share_of_power = found.sun->share_of_power};
}

} // namespace relumine::app
