// What else a matrix of bounces has once its lists are there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "prt/bounces/bounce_matrix.h"

namespace relumine::prt {

/// Returns a row's weight, given its closed part of the hemisphere and how many rays of each
/// receiver met a surface.
[[nodiscard]] float row_weight(const BounceMatrix& matrix, std::size_t place, double closure,
                               std::span<const std::uint32_t> num_hits);

/// Returns what spectral_radius(matrix) has found after so many bounces. It grows slowly then.
[[nodiscard]] float spectral_radius(const BounceMatrix& matrix, int num_bounces);

} // namespace relumine::prt
