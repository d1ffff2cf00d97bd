#include "cubemap/doctor/sun.h"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <span>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "cubemap/doctor/sky_angles.h"
#include "cubemap/image/image_layout.h"
#include "cubemap/resample/resample.h"

namespace relumine::cubemap {

namespace {

// Conditions for a sun. The figures come from measured environments. Suns there, with their bloom,
// are 0.6 to 4 degrees wide, at least 100 times as bright as their surroundings, and 1 % to 50 % of
// the light. Lamps and windows of interiors have rivals of half their strength.
constexpr double MaxDiameterDegrees = 5.0;
constexpr double MaxDiameterPixels = 3.0;
constexpr double MinContrast = 8.0;
constexpr double MinShare = 0.005;
/// A rival has this part of the strongest spot's irradiance ...
constexpr double RivalIrradiance = 0.5;
/// ... and this part of its peak luminance. A wide glow is no rival.
constexpr double RivalPeak = 0.1;
/// Spots are searched at this resolution at most (a texel of 0.18 degrees). The sun is then
/// measured in the image's own pixels.
constexpr std::uint32_t SearchResolution = 512;
constexpr std::uint32_t CoarsestResolution = 8;

// The sun's pixels lie in the spot and up to two texels around it. The sun hardly covers the pixels
// at its rim.
constexpr int RegionRings = 2;
/// The next texels outwards show the sky.
constexpr int SkyRings = 2;
constexpr double SunPeakPart = 2e-4;
constexpr double SkyPart = 0.25;
/// Texels of the ring above this multiple of its upper quartile are another light, not sky.
constexpr double BrightestSky = 3.0;

struct Pixels {
    ImageShape shape;
    std::span<const glm::vec3> radiance;
};

/// Carries the sky over a hole: the mean of the texels around the hole, weighted with inverse
/// squared distances.
class SkyOverHole {
public:
    SkyOverHole(const CubeMap& map, const std::vector<std::uint32_t>& hole) {
        std::vector<std::uint32_t> outer = hole;
        for (int i = 0; i < SkyRings; ++i)
            outer = grown(outer, map.resolution);
        std::vector<std::uint32_t> ring;
        std::set_difference(outer.begin(), outer.end(), hole.begin(), hole.end(),
                            std::back_inserter(ring));
        if (ring.empty())
            return;
        std::vector<double> luminances;
        luminances.reserve(ring.size());
        for (const std::uint32_t texel : ring)
            luminances.push_back(luminance(glm::dvec3(map.texels[texel])));
        std::vector<double> sorted = luminances;
        const auto quartile = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 3 / 4);
        std::nth_element(sorted.begin(), quartile, sorted.end());
        for (std::size_t i = 0; i < ring.size(); ++i) {
            if (luminances[i] > BrightestSky * *quartile)
                continue;
            const std::uint32_t per_face = map.resolution * map.resolution;
            samples_.push_back(
                {texel_direction(AllFaces[ring[i] / per_face], ring[i] % map.resolution,
                                 ring[i] % per_face / map.resolution, map.resolution),
                 glm::dvec3(map.texels[ring[i]])});
        }
    }

    [[nodiscard]] glm::dvec3 radiance(const glm::dvec3& w) const {
        glm::dvec3 sum(0.0);
        double weights = 0.0;
        for (const Sample& sample : samples_) {
            const glm::dvec3 apart = sample.direction - w;
            const double weight = 1.0 / (glm::dot(apart, apart) + 1e-12);
            sum += weight * sample.radiance;
            weights += weight;
        }
        return weights > 0.0 ? sum / weights : sum;
    }

private:
    struct Sample {
        glm::dvec3 direction, radiance;
    };
    std::vector<Sample> samples_;
};

/// The part of the sun's light in one pixel.
struct Part {
    glm::dvec3 direction;
    /// Power above the sky.
    glm::dvec3 power;
    double solid_angle;
};

/// Measures the spot's light in the image's own pixels.
Sun measure(const Pixels& image, const CubeMap& map, const BrightSpot& spot, double total_power) {
    std::vector<std::uint32_t> region = spot.texels;
    for (int i = 0; i < RegionRings; ++i)
        region = grown(region, map.resolution);
    const SkyOverHole sky(map, region);
    std::vector<bool> in_region(map.texels.size(), false);
    for (const std::uint32_t texel : region)
        in_region[texel] = true;

    Sun sun;
    glm::dvec3 middle(0.0);
    std::vector<Part> parts;
    double sky_sum = 0.0, solid_angles = 0.0;
    for_each_pixel(image.shape, [&](std::size_t index, const PixelPlace& place) {
        if (!in_region[texel_index(place.direction, map.resolution)])
            return;
        const glm::vec3& radiance = image.radiance[index];
        const glm::dvec3 around = sky.radiance(place.direction);
        const double value = luminance(glm::dvec3(radiance)), sky_value = luminance(around);
        if (value <= sky_value + std::max(SkyPart * sky_value,
                                          SunPeakPart * (spot.peak_luminance - sky_value)))
            return;
        // In a channel where the sky is brighter, the pixel stays as it is. So the sun has no
        // negative light.
        const glm::vec3 without = glm::min(radiance, glm::vec3(around));
        sun.pixels.push_back({index, without});
        parts.push_back({place.direction, glm::dvec3(radiance - without) * place.solid_angle,
                         place.solid_angle});
        sun.peak_luminance = std::max(sun.peak_luminance, value);
        sky_sum += sky_value * place.solid_angle;
        solid_angles += place.solid_angle;
        middle += luminance(parts.back().power) * place.direction;
    });
    if (parts.empty())
        return sun;
    sun.direction = glm::normalize(middle);
    sun.sky_luminance = sky_sum / solid_angles;
    double variance = 0.0;
    for (const Part& part : parts) {
        sun.irradiance += part.power * glm::dot(part.direction, sun.direction);
        const double power = luminance(part.power);
        const glm::dvec3 apart = part.direction - sun.direction;
        // A disc of solid angle W has the variance W / (2 pi), both axes together.
        variance += power * (glm::dot(apart, apart) + part.solid_angle / (2.0 * std::numbers::pi));
    }
    const double power = glm::length(middle);
    sun.solid_angle = 2.0 * std::numbers::pi * variance / power;
    sun.share_of_power = power / total_power;
    return sun;
}

SunSearch search(const Pixels& image, const CubeMap& map) {
    SunSearch result;
    double solid_angles = 0.0;
    std::size_t num_pixels = 0;
    for_each_pixel(image.shape, [&](std::size_t index, const PixelPlace& place) {
        result.power += luminance(glm::dvec3(image.radiance[index])) * place.solid_angle;
        solid_angles += place.solid_angle;
        ++num_pixels;
    });
    result.spot_resolution = map.resolution;
    result.pixel_diameter_degrees = disc_diameter_degrees(
        solid_angles / static_cast<double>(std::max<std::size_t>(num_pixels, 1)));
    if (map.resolution < CoarsestResolution) {
        result.why_none = "the map is too coarse to show one";
        return result;
    }
    result.spots = bright_spots(map);
    const double max_diameter =
        std::max(MaxDiameterDegrees, MaxDiameterPixels * result.pixel_diameter_degrees);
    const BrightSpot* best = nullptr;
    for (const BrightSpot& spot : result.spots) {
        const bool is_distinct =
            !spot.is_cut && spot.peak_luminance >= MinContrast * spot.surrounding_luminance;
        if (is_distinct && (best == nullptr || spot.irradiance > best->irradiance))
            best = &spot;
    }
    if (best == nullptr) {
        result.why_none = "no small light stands out of what surrounds it";
        return result;
    }
    for (const BrightSpot& spot : result.spots) {
        if (&spot != best && spot.irradiance >= RivalIrradiance * best->irradiance &&
            spot.peak_luminance >= RivalPeak * best->peak_luminance) {
            result.why_none = "several lights are about as strong";
            return result;
        }
    }
    Sun sun = measure(image, map, *best, result.power);
    const double diameter = disc_diameter_degrees(sun.solid_angle);
    if (diameter > max_diameter)
        result.why_none = fmt::format("the brightest light is {:.2g} degrees wide", diameter);
    else if (sun.share_of_power < MinShare)
        result.why_none = fmt::format("the brightest small light is {:.2g} % of the power",
                                      100.0 * sun.share_of_power);
    else
        result.sun = std::move(sun);
    return result;
}

} // namespace

SunSearch find_sun(const EnvironmentImage& image) {
    return search({shape_of(image), image.pixels},
                  resample(image, std::min(SearchResolution, natural_resolution(image))));
}

SunSearch find_sun(const CubeMap& map) {
    const Pixels pixels{{Layout::Cube, Sampling::TexelCentres, map.resolution, 6 * map.resolution},
                        map.texels};
    return map.resolution <= SearchResolution ? search(pixels, map)
                                              : search(pixels, resample(map, SearchResolution));
}

} // namespace relumine::cubemap
