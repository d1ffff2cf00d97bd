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

/// Returns what spectral_radius(matrix) does, but ends once further steps would change it by less
/// than `tolerance`, relative.
///
/// Cost:    some 10 bounces for 1e-4.
[[nodiscard]] float spectral_radius(const BounceMatrix& matrix, double tolerance);

} // namespace relumine::prt
