// Mean radiance under quadrilaterals of one face of a cube map, several at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Quadrilaterals on a face, about as large as a texel.
struct TurnedSpan {
    static constexpr std::size_t MaxSize = 16;

    /// [corner][quadrilateral] in texels from the upper left corner of texel (column, row), not
    /// negative. Clockwise in the face's image.
    std::array<std::array<float, MaxSize>, 4> x = {}, y = {};
    /// The texel under the upper left corner of the quadrilateral's bounds.
    std::array<std::int32_t, MaxSize> column = {}, row = {};
    /// How many there are.
    std::size_t size = 0;

    /// Adds one, corners in texels of the face.
    void add(const std::array<glm::dvec2, 4>& corners);
};

/// Writes the mean radiance over the solid angle of each quadrilateral, [span.size]. `face`: R x R
/// texels. The density of solid angle is taken to second order about each texel's middle, as
/// solid_angle_about() does.
///
/// Error:   beside that of the expansion, 2e-7 of the largest radiance that the quadrilateral
///          meets.
/// Cost:    30 to 60 ns each with AVX2.
void mean_under(const TurnedSpan& span, const glm::vec3* face, std::uint32_t resolution,
                glm::vec3* means);

} // namespace relumine::cubemap
