// Lights in random directions, more likely where the environment is bright. The cutting methods are
// compared with this baseline.
// Based on: M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering": sampling of
// piecewise-constant 2D distributions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/lat_long_grid.h"
#include "lights/light_list.h"

namespace relumine::lights {

/// Returns lights in random directions, one in each of `num_lights` strata that hold equal
/// luminance.
///
/// The strata divide the unit square into equal areas, in rows of about as many strata as there are
/// rows. The inverse of the marginal distribution of luminance over the image's rows (down) and of
/// the conditional one within each row (across) maps the square to the sphere.
///
/// Differs from plain importance sampling, whose sum is right on average only: a light gets the
/// irradiance of its stratum. A pixel's power goes to the strata it lies in, by their shares of its
/// luminance. So all lights together have the power of the map in every channel, and each light has
/// the same luminance.
///
/// Pixels without luminance belong to no stratum. A map without luminance is sampled evenly over
/// the sphere.
///
/// Cost:    O(pixels + num_lights * width).
/// Result:  bitwise the same for a seed.
[[nodiscard]] std::vector<DistantLight>
importance_sample(const LatLongGrid& grid, std::size_t num_lights, std::uint64_t seed);

/// A light, and the luminance of the map's radiance in its direction.
struct ImportanceSample {
    DistantLight light;
    double luminance = 0.0;
};

/// Returns the same lights with this luminance.
[[nodiscard]] std::vector<ImportanceSample>
importance_samples(const LatLongGrid& grid, std::size_t num_lights, std::uint64_t seed);

/// Returns lights of plain importance sampling: independent random directions with a probability p
/// proportional to luminance, and the irradiance L / (p num_lights). Their sum has the map's
/// luminance; its colour is right on average only. A black map gets lights of irradiance 0.
[[nodiscard]] std::vector<ImportanceSample>
independent_samples(const LatLongGrid& grid, std::size_t num_lights, std::uint64_t seed);

} // namespace relumine::lights
