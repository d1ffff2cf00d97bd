// Small lat-long maps, made in code.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <ostream>
#include <random>

#include "cubemap/image/environment.h"
#include "cubemap/image/image_layout.h"
#include "lights/lat_long_grid.h"

namespace relumine::lights {

using Painter = std::function<glm::vec3(std::uint32_t x, std::uint32_t y)>;

inline cubemap::EnvironmentImage lat_long(std::uint32_t width, std::uint32_t height,
                                          const Painter& painter) {
    cubemap::EnvironmentImage image;
    image.width = width;
    image.height = height;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            image.pixels.push_back(painter(x, y));
    return image;
}

inline cubemap::EnvironmentImage constant(std::uint32_t width, std::uint32_t height,
                                          const glm::vec3& radiance) {
    return lat_long(width, height, [&](std::uint32_t, std::uint32_t) { return radiance; });
}

/// Values over five decades, each channel its own; a tenth of the pixels black.
inline cubemap::EnvironmentImage wild(std::uint32_t width, std::uint32_t height,
                                      unsigned seed = 1) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<float> decade(-2.0f, 3.0f);
    std::uniform_real_distribution<float> chance(0.0f, 1.0f);
    return lat_long(width, height, [&](std::uint32_t, std::uint32_t) {
        const glm::vec3 value(std::pow(10.0f, decade(engine)), std::pow(10.0f, decade(engine)),
                              std::pow(10.0f, decade(engine)));
        return chance(engine) < 0.1f ? glm::vec3(0.0f) : value;
    });
}

/// The power of a map, added without any help of the library under test.
inline glm::dvec3 power(const cubemap::EnvironmentImage& image) {
    glm::dvec3 sum(0.0);
    cubemap::for_each_pixel(cubemap::shape_of(image),
                            [&](std::size_t pixel, const cubemap::PixelPlace& place) {
                                sum += glm::dvec3(image.pixels[pixel]) * place.solid_angle;
                            });
    return sum;
}

/// For messages of failed tests.
inline void PrintTo(const PixelRectangle& region, std::ostream* out) {
    *out << "[" << region.x0 << ", " << region.x1 << ") x [" << region.y0 << ", " << region.y1
         << ")";
}

} // namespace relumine::lights
