// Bright spots of a cube map: connected texels that stand out of their surroundings.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/luminance.h"

namespace relumine::cubemap {

/// One bright spot. Luminance has Rec. 709 weights.
struct BrightSpot {
    /// Indices into CubeMap::texels, ascending. The texels are connected, also over edges and
    /// corners of faces.
    std::vector<std::uint32_t> texels;
    /// Unit direction of the brightest texel.
    glm::dvec3 peak_direction{0.0};
    double peak_luminance = 0.0;
    /// Median luminance around the spot.
    double surrounding_luminance = 0.0;
    /// Sum over the texels of luminance above the surroundings times solid angle.
    double irradiance = 0.0;
    /// Sum of the texels' solid angles, in steradians.
    double solid_angle = 0.0;
    /// True if the spot goes beyond SpotOptions::max_radius_degrees. Its texels are then the ones
    /// within this radius.
    bool is_cut = false;
};

/// Limits of bright_spots().
struct SpotOptions {
    std::size_t max_spots = 8;
    /// How far from its peak a spot is followed.
    double max_radius_degrees = 12.0;
};

/// Returns the spots around the brightest texels, in the order of their peaks. A map without light
/// has none.
///
/// A texel belongs to a spot if its luminance is above twice the surroundings' and above the
/// surroundings by a hundredth of the peak's contrast, and if such texels connect it to the peak.
/// Bloom and aureole close around a spot are no spots of their own.
[[nodiscard]] std::vector<BrightSpot> bright_spots(const CubeMap& map,
                                                   const SpotOptions& options = {});

/// Returns the given texels and all texels next to them, also over edges and corners of faces,
/// ascending.
[[nodiscard]] std::vector<std::uint32_t> grown(const std::vector<std::uint32_t>& texels,
                                               std::uint32_t resolution);

/// Returns the index of the texel that a direction goes through. The direction may have any length
/// but zero.
[[nodiscard]] std::uint32_t texel_index(const glm::dvec3& direction, std::uint32_t resolution);

} // namespace relumine::cubemap
