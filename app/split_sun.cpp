#include "app/split_sun.h"

#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "cubemap/sky_angles.h"
#include "lights/sun_split.h"

namespace relumine::app {

namespace {

std::filesystem::path sun_path(std::filesystem::path map_path) {
    return map_path.replace_extension(".sun.json");
}

nlohmann::ordered_json array(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

} // namespace

SunFile::SunFile(const std::filesystem::path& map_path) : file_(sun_path(map_path)) {}

nlohmann::json SunFile::split(cubemap::EnvironmentImage& image, const std::string& source) {
    const cubemap::SunSearch found = cubemap::find_sun(image);
    nlohmann::json figures = write(found, source);
    lights::remove_sun(image, *found.sun);
    return figures;
}

nlohmann::json SunFile::split(cubemap::CubeMap& map, const std::string& source) {
    const cubemap::SunSearch found = cubemap::find_sun(map);
    nlohmann::json figures = write(found, source);
    lights::remove_sun(map, *found.sun);
    return figures;
}

nlohmann::json SunFile::write(const cubemap::SunSearch& found, const std::string& source) {
    if (!found.sun)
        throw std::runtime_error(
            fmt::format("{}: expected a sun to split off, got none: {}", source, found.why_none));
    const lights::DistantLight light = lights::sun_light(*found.sun);
    const nlohmann::ordered_json list = {
        {"version", 1},
        {"environment", std::filesystem::path(source).filename().string()},
        {"method", "sun"},
        {"lights", nlohmann::ordered_json::array({{{"direction", array(light.direction)},
                                                   {"irradiance", array(light.irradiance)},
                                                   {"solid_angle", light.solid_angle}}})}};
    const std::string text = list.dump(2) + "\n";
    file_.write(std::as_bytes(std::span(text)));
    const cubemap::SkyAngles angles = cubemap::sky_angles(light.direction);
    return {{"file", path()},
            {"direction", {light.direction.x, light.direction.y, light.direction.z}},
            {"azimuth_degrees", angles.azimuth_degrees},
            {"elevation_degrees", angles.elevation_degrees},
            {"irradiance", {light.irradiance.x, light.irradiance.y, light.irradiance.z}},
            {"solid_angle", light.solid_angle},
            {"diameter_degrees", cubemap::disc_diameter_degrees(light.solid_angle)},
            {"share_of_power", found.sun->share_of_power}};
}

} // namespace relumine::app
