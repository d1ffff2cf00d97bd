#include "relight/pictures/region_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "cubemap/luminance.h"
#include "files/parallel.h"
#include "lights/lat_long_grid.h"
#include "relight/pictures/tone_map.h"

namespace relumine::relight {

namespace {

const glm::vec3 LineColour(0.05f, 0.75f, 0.2f);

/// The picture has `grow` pixels for each `shrink` pixels of the map; one of the two is 1.
struct MapScale {
    std::uint32_t grow = 1, shrink = 1;
    explicit MapScale(std::uint32_t width) {
        constexpr std::uint32_t Narrowest = 1024;
        constexpr std::uint32_t Widest = 2048;
        if (width < Narrowest)
            grow = (Narrowest + width - 1) / width;
        else
            shrink = (width + Widest - 1) / Widest;
    }
    /// Scales a border between the map's pixels, or any position among them.
    template<typename T>
    [[nodiscard]] T of(T position) const {
        return position * static_cast<T>(grow) / static_cast<T>(shrink);
    }
    [[nodiscard]] std::uint32_t size(std::uint32_t pixels) const {
        return (pixels * grow + shrink - 1) / shrink;
    }
};

/// Returns a tone map in which the brightest hundredth of the sphere is white. A few ten thousand
/// pixels of a large map are enough.
ToneMap tone_map_of(const lights::LatLongGrid& grid) {
    std::vector<LuminanceSample> samples;
    const auto step = std::max<std::uint32_t>(1, grid.width() / 512);
    for (std::uint32_t y = step / 2; y < grid.height(); y += step)
        for (std::uint32_t x = step / 2; x < grid.width(); x += step)
            samples.push_back({.luminance = lights::luminance(grid.radiance(x, y)),
                               .weight = grid.solid_angle(x, y)});
    return ToneMap(std::move(samples), {.weights = cubemap::MedianCutWeights, .white_share = 0.01});
}

Picture environment_picture(const lights::LatLongGrid& grid, const MapScale& scale) {
    const ToneMap tone_map = tone_map_of(grid);
    Picture picture{scale.size(grid.width()), scale.size(grid.height()), {}};
    picture.pixels.resize(std::size_t{picture.width} * picture.height);
    files::parallel_for(std::uint32_t{0}, picture.height, [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < picture.width; ++x) {
            const std::uint32_t first_x = x * scale.shrink / scale.grow;
            const std::uint32_t first_y = y * scale.shrink / scale.grow;
            glm::dvec3 sum(0.0);
            double num = 0.0;
            for (std::uint32_t j = first_y; j < std::min(first_y + scale.shrink, grid.height());
                 ++j)
                for (std::uint32_t i = first_x; i < std::min(first_x + scale.shrink, grid.width());
                     ++i) {
                    sum += grid.radiance(i, j);
                    num += 1.0;
                }
            picture.pixels[std::size_t{y} * picture.width + x] = tone_map(sum / num);
        }
    });
    return picture;
}

void blend(Picture& picture, std::int64_t x, std::int64_t y, const glm::vec3& colour,
           double coverage) {
    if (y < 0 || y >= picture.height || coverage <= 0.0)
        return;
    const std::int64_t width = picture.width;
    const auto column =
        static_cast<std::size_t>(((x % width) + width) % width); // longitude goes round
    glm::vec3& pixel = picture.pixels[static_cast<std::size_t>(y) * picture.width + column];
    pixel = glm::mix(pixel, colour, static_cast<float>(std::min(coverage, 1.0)));
}

void draw_borders(Picture& picture, const lights::PixelRectangle& region, const MapScale& scale) {
    const auto left = scale.of(region.x0), right = std::min(scale.of(region.x1), picture.width - 1);
    const auto top = scale.of(region.y0),
               bottom = std::min(scale.of(region.y1), picture.height - 1);
    for (auto x = left; x <= right; ++x) {
        blend(picture, x, top, LineColour, 1.0);
        blend(picture, x, bottom, LineColour, 1.0);
    }
    for (auto y = top; y <= bottom; ++y) {
        blend(picture, left, y, LineColour, 1.0);
        blend(picture, right, y, LineColour, 1.0);
    }
}

/// Returns the coverage of a pixel at a distance from the centre of a disc with an edge one pixel
/// wide.
double disc(double distance, double radius) {
    return std::clamp(radius + 0.5 - distance, 0.0, 1.0);
}

void draw_light(Picture& picture, const lights::DistantLight& light) {
    const glm::dvec3& d = light.direction;
    const double u = 0.5 - std::atan2(d.x, d.z) / (2.0 * std::numbers::pi);
    const double v = std::acos(std::clamp(d.y, -1.0, 1.0)) / std::numbers::pi;
    const double x = u * picture.width - 0.5; // in pixel centres
    const double y = v * picture.height - 0.5;
    const double radius = std::clamp(picture.width / 380.0, 2.0, 6.0);
    const double largest = std::max({light.irradiance.r, light.irradiance.g, light.irradiance.b});
    // Partly white, so that a light shows on its own colour.
    const glm::vec3 colour =
        largest > 0.0 ? glm::vec3(0.35 + 0.65 * light.irradiance / largest) : glm::vec3(0.4f);
    const auto reach = static_cast<std::int64_t>(std::ceil(radius + 3.0));
    const auto column = std::llround(x);
    const auto row = std::llround(y);
    for (std::int64_t j = row - reach; j <= row + reach; ++j)
        for (std::int64_t i = column - reach; i <= column + reach; ++i) {
            const double distance =
                std::hypot(static_cast<double>(i) - x, static_cast<double>(j) - y);
            blend(picture, i, j, glm::vec3(0.0f), disc(distance, radius + 1.5));
            blend(picture, i, j, colour, disc(distance, radius));
        }
}

} // namespace

Picture region_picture(const cubemap::EnvironmentImage& lat_long,
                       const lights::Placement& placement) {
    const lights::LatLongGrid grid(lat_long);
    const MapScale scale(grid.width());
    Picture picture = environment_picture(grid, scale);
    for (const lights::PixelRectangle& region : placement.regions)
        draw_borders(picture, region, scale);
    for (const lights::DistantLight& light : placement.lights)
        draw_light(picture, light);
    return picture;
}

} // namespace relumine::relight
