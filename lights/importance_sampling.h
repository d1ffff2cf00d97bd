// Lights in random directions, likely where the environment is bright: the baseline that cutting
// methods are held against. Based on: M. Pharr, W. Jakob, G. Humphreys, "Physically Based
// Rendering": sampling of piecewise-constant 2D distributions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/lat_long_grid.h"
#include "lights/light_list.h"

namespace relumine::lights {

/// The unit square is cut into `num_lights` strata of equal area, in rows of about as many as there
/// are rows, and mapped to the sphere by inverting the marginal distribution of luminance over the
/// image's rows (down) and the conditional one within each row (across). So each stratum holds 1 /
/// num_lights of the luminance. Its light stands in a random direction of the stratum.
///
/// Differs from plain importance sampling, whose sum is only right on average: a light's irradiance
/// is that of its stratum, each pixel's power going to the strata that it lies in by the share of
/// its luminance. So the sum of all lights is the power of the map in every channel, and each light
/// still has the same luminance. Pixels without luminance belong to no stratum; a map without any
/// is sampled evenly over the sphere. O(pixels + num_lights * width); bitwise the same for a seed.
[[nodiscard]] std::vector<DistantLight>
importance_sample(const LatLongGrid& grid, std::size_t num_lights, std::uint64_t seed);

/// A light with the luminance of the map's radiance where it stands.
struct ImportanceSample {
    DistantLight light;
    double luminance = 0.0;
};

/// The same lights, with that luminance.
[[nodiscard]] std::vector<ImportanceSample>
importance_samples(const LatLongGrid& grid, std::size_t num_lights, std::uint64_t seed);

/// Plain importance sampling: independent random directions, each likely as its luminance, with the
/// irradiance L / (p num_lights). Their sum has the map's luminance, its colour is right on average
/// only. A black map has lights of irradiance 0.
[[nodiscard]] std::vector<ImportanceSample>
independent_samples(const LatLongGrid& grid, std::size_t num_lights, std::uint64_t seed);

} // namespace relumine::lights
