// Bounces with fewer samples: for scenes that must be small.
#pragma once

#include <cstddef>

#include "prt/bounces/bounce_matrix.h"

namespace relumine::prt {

/// Returns a matrix whose rows have about `samples_per_row` samples in the mean; the same where
/// they have no more already. Each list keeps every so-many-th of its places, so samples stay
/// spread over what a receiver sees. A row's sum, the part of the sky that surfaces hide, stays.
///
/// Cost:    O(samples), and the spectral radius.
/// Throws:  std::invalid_argument for 0 samples.
[[nodiscard]] BounceMatrix thinned(const BounceMatrix& matrix, std::size_t samples_per_row);

} // namespace relumine::prt
