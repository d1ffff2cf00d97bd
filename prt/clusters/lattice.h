// The points at which the clustering samples visibility.
#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "prt/transfer/quadtree.h"

namespace relumine::prt {

/// Samples of a cell: corners, edge midpoints and centre, row by row [JN, Section 4.1]. They are
/// points of the continuous face. Cells that touch share them, across face edges too, so a split
/// needs 16 new ones.
inline constexpr std::size_t SamplesPerCell = 9;
inline constexpr std::size_t CentreSample = 4;

/// Weight of each sample in the mean, over 16: the tensor product of the trapezoid rule's 1-2-1.
/// Differs from [JN, Eq. 10], where all nine weigh the same: a sample on a corner stands for a
/// quarter of the centre's area, and the cells that meet there share it consistently.
inline constexpr std::array<std::uint8_t, SamplesPerCell> SampleWeights = {1, 2, 1, 2, 4,
                                                                           2, 1, 2, 1};
/// Weights where a cell is one texel: its centre stands for all of it.
inline constexpr std::array<std::uint8_t, SamplesPerCell> CentreWeights = {0, 0, 0, 0, 16,
                                                                           0, 0, 0, 0};
/// Sum of the weights: every sample sees the light.
inline constexpr int FullCount = 16;

/// Name of a sample point: equal for equal directions, whichever cell or face asks.
using LatticePoint = std::uint64_t;

/// Returns the nine samples of a cell.
[[nodiscard]] std::array<LatticePoint, SamplesPerCell> lattice_points(const Cell& cell);

/// Returns the place of a point on the surface of the cube [-1, 1]^3.
[[nodiscard]] glm::dvec3 place_on_cube(LatticePoint point);

/// Returns the unit direction of a sample point.
[[nodiscard]] glm::vec3 direction(LatticePoint point);

} // namespace relumine::prt
