#include "cubemap/doctor/clipped_sun.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/doctor/sky_angles.h"
#include "cubemap/image/image_layout.h"
#include "files/pixel_values.h"

namespace relumine::cubemap {

namespace {

/// Clipped pixels are equal. Compression may change them a little.
constexpr float AtMaximum = 0.998f;
constexpr std::size_t LeastPlateau = 4;
constexpr double WidestPlateauDegrees = 10.0;
/// The sun through clear air has ten times this contrast.
constexpr double SunContrast = 5000.0;
constexpr double GlowContrast = 2.5, MaxGlowContrast = 100.0;
/// Least luminance of a glow's surroundings, relative to the mean.
constexpr double BrightSky = 1.2;
constexpr double LowestGlowDegrees = -5.0;
constexpr double LeastSunOverSky = 0.25, HighSunDegrees = 10.0;

/// Adjacent pixels at the maximum.
struct Plateau {
    std::size_t num_pixels = 0;
    double solid_angle = 0.0;
    glm::dvec3 direction{0.0};
};

struct BrightPixel {
    std::uint32_t texel;
    PixelPlace place;
};

/// Returns the largest group of adjacent pixels at the maximum. Neighbours may have a texel between
/// them: texels at a cube's corners are half as wide as a lat-long's pixels.
Plateau largest_plateau(const EnvironmentImage& image, float maximum, std::uint32_t resolution) {
    std::vector<BrightPixel> pixels;
    for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
        const glm::vec3& value = image.pixels[index];
        if (std::max(std::max(value.x, value.y), value.z) >= AtMaximum * maximum)
            pixels.push_back({texel_index(place.direction, resolution), place});
    });
    std::stable_sort(pixels.begin(), pixels.end(),
                     [](const BrightPixel& a, const BrightPixel& b) { return a.texel < b.texel; });
    Plateau largest;
    // If more than a hundredth of the image is at its maximum, the maximum is no sun.
    if (pixels.size() > image.pixels.size() / 100)
        return largest;
    std::vector<bool> seen(pixels.size(), false);
    for (std::size_t start = 0; start < pixels.size(); ++start) {
        if (seen[start])
            continue;
        Plateau plateau;
        std::vector<std::uint32_t> front = {pixels[start].texel};
        while (!front.empty()) {
            std::vector<std::uint32_t> next;
            for (const std::uint32_t texel : grown(grown(front, resolution), resolution)) {
                auto pixel = std::lower_bound(
                    pixels.begin(), pixels.end(), texel,
                    [](const BrightPixel& a, std::uint32_t value) { return a.texel < value; });
                for (; pixel != pixels.end() && pixel->texel == texel; ++pixel) {
                    const auto index = static_cast<std::size_t>(pixel - pixels.begin());
                    if (seen[index])
                        continue;
                    seen[index] = true;
                    ++plateau.num_pixels;
                    plateau.solid_angle += pixel->place.solid_angle;
                    plateau.direction += pixel->place.solid_angle * pixel->place.direction;
                    next.push_back(texel);
                }
            }
            next.erase(std::unique(next.begin(), next.end()), next.end());
            front = std::move(next);
        }
        if (plateau.num_pixels > largest.num_pixels)
            largest = plateau;
    }
    return largest;
}

float largest_value(const EnvironmentImage& image) {
    float maximum = 0.0f;
    for (const glm::vec3& pixel : image.pixels)
        maximum = std::max({maximum, pixel.x, pixel.y, pixel.z});
    return maximum;
}

std::optional<ClippedSun> clipped_plateau(const EnvironmentImage& image, const SunSearch& search,
                                          float maximum) {
    const Plateau plateau = largest_plateau(image, maximum, search.spot_resolution);
    if (plateau.num_pixels < LeastPlateau ||
        disc_diameter_degrees(plateau.solid_angle) > WidestPlateauDegrees)
        return std::nullopt;
    const glm::dvec3 direction = glm::normalize(plateau.direction);
    for (const BrightSpot& spot : search.spots) {
        const double contrast = spot.peak_luminance / spot.surrounding_luminance; // may be infinite
        constexpr double Near = 0.1;                                              // 6 degrees
        if (glm::distance(spot.peak_direction, direction) < Near && contrast >= GlowContrast &&
            contrast < SunContrast &&
            disc_diameter_degrees(spot.solid_angle) < WidestPlateauDegrees)
            return ClippedSun{direction,
                              fmt::format("{} adjacent pixels at the map's maximum of {:.4g}",
                                          plateau.num_pixels, maximum)};
    }
    return std::nullopt;
}

} // namespace

std::optional<ClippedSun> clipped_sun(const EnvironmentImage& image, const SunSearch& search,
                                      const EnvironmentStatistics& statistics) {
    if (search.spots.empty())
        return std::nullopt;
    const BrightSpot& brightest = search.spots.front();
    if (image.bad_pixels.num_infinite > 0)
        return ClippedSun{brightest.peak_direction,
                          fmt::format("{} pixels are infinite", image.bad_pixels.num_infinite)};
    const float maximum = largest_value(image);
    if (maximum == files::LargestHalf)
        return ClippedSun{brightest.peak_direction, "its pixels are at the largest half, 65504"};
    if (auto plateau = clipped_plateau(image, search, maximum))
        return plateau;
    if (!search.sun) {
        const double contrast = brightest.peak_luminance / brightest.surrounding_luminance;
        const double mean = search.power / (4.0 * std::numbers::pi);
        if (contrast >= GlowContrast && contrast < MaxGlowContrast &&
            brightest.surrounding_luminance >= BrightSky * mean &&
            sky_angles(brightest.peak_direction).elevation_degrees > LowestGlowDegrees)
            return ClippedSun{
                brightest.peak_direction,
                fmt::format("a glow in the sky, but at its peak only {:.2g} times as bright "
                            "as what is around it",
                            contrast)};
        return std::nullopt;
    }
    const Sun& sun = *search.sun;
    const double from_sun = luminance(sun.irradiance);
    const double from_sky =
        luminance(statistics.axis_irradiance[static_cast<std::size_t>(Face::PositiveY)]) -
        from_sun * std::max(sun.direction.y, 0.0);
    if (sky_angles(sun.direction).elevation_degrees > HighSunDegrees &&
        from_sun < LeastSunOverSky * from_sky)
        return ClippedSun{
            sun.direction,
            fmt::format("the sun gives only {:.2g} of what the sky gives", from_sun / from_sky)};
    return std::nullopt;
}

} // namespace relumine::cubemap
