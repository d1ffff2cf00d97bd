// Bright spots of a cube map: connected texels that stand out of what surrounds them.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/luminance.h"

namespace relumine::cubemap {

/// One spot. Luminance has Rec. 709 weights.
struct BrightSpot {
    /// Indices into CubeMap::texels, connected (also over face edges and corners), ascending
    std::vector<std::uint32_t> texels;
    /// Unit; the brightest texel
    glm::dvec3 peak_direction{0.0};
    double peak_luminance = 0.0;
    /// Median around the spot
    double surrounding_luminance = 0.0;
    /// Luminance above the surroundings, summed over the texels' solid angles
    double irradiance = 0.0;
    /// Of all texels
    double solid_angle = 0.0;
    /// Wider than SpotOptions::max_radius_degrees: the texels are those within it
    bool is_cut = false;
};

struct SpotOptions {
    std::size_t max_spots = 8;
    /// How far from its peak a spot is followed
    double max_radius_degrees = 12.0;
};

/// The spots around the brightest texels, in the order of their peaks; none in a map without light.
/// A texel belongs to a spot when its luminance is above twice the surroundings' and above a
/// hundredth of the peak's, and when such texels join it with the peak. What lies close around a
/// spot (bloom, aureole) is no spot of its own.
[[nodiscard]] std::vector<BrightSpot> bright_spots(const CubeMap& map,
                                                   const SpotOptions& options = {});

/// The texels given and those next to them, also over edges and corners of faces; ascending.
[[nodiscard]] std::vector<std::uint32_t> grown(const std::vector<std::uint32_t>& texels,
                                               std::uint32_t resolution);

/// Index of the texel that a direction (any length but zero) goes through.
[[nodiscard]] std::uint32_t texel_index(const glm::dvec3& direction, std::uint32_t resolution);

} // namespace relumine::cubemap
