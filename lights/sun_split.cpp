#include "lights/sun_split.h"

#include <cassert>
#include <vector>

namespace relumine::lights {

namespace {

void fill(std::vector<glm::vec3>& pixels, const cubemap::Sun& sun) {
    for (const cubemap::SunPixel& pixel : sun.pixels) {
        assert(pixel.index < pixels.size() && "the sun belongs to another map");
        pixels[pixel.index] = pixel.sky;
    }
}

template<typename Map>
std::optional<SunSplit<Map>> split(const Map& map) {
    const cubemap::SunSearch found = cubemap::find_sun(map);
    if (!found.sun)
        return std::nullopt;
    SunSplit<Map> result{.sun = sun_light(*found.sun), .rest = map};
    remove_sun(result.rest, *found.sun);
    return result;
}

} // namespace

std::filesystem::path sun_file_of(std::filesystem::path map) {
    return map.replace_extension(".sun.json");
}

bool has_sun_file(const std::filesystem::path& map) {
    std::error_code error;
    return std::filesystem::is_regular_file(sun_file_of(map), error);
}

DistantLight sun_light(const cubemap::Sun& sun) {
    return {
        .direction = sun.direction, .irradiance = sun.irradiance, .solid_angle = sun.solid_angle};
}

void remove_sun(cubemap::EnvironmentImage& image, const cubemap::Sun& sun) {
    fill(image.pixels, sun);
}

void remove_sun(cubemap::CubeMap& map, const cubemap::Sun& sun) {
    fill(map.texels, sun);
}

std::optional<SunSplit<cubemap::EnvironmentImage>>
split_sun(const cubemap::EnvironmentImage& image) {
    return split(image);
}

std::optional<SunSplit<cubemap::CubeMap>> split_sun(const cubemap::CubeMap& map) {
    return split(map);
}

} // namespace relumine::lights
