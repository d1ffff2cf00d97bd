// Which receivers each part of a precompute has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prt/reduction.h"

namespace relumine::prt {

/// Returns the places in spatial order of a part's receivers, ascending: every count-th tile of
/// VisibleCounts. So groups of receivers that are traced together, and runs of the sums, are the
/// same in any number of parts.
[[nodiscard]] std::vector<std::uint32_t> places_of(const Part& part, std::size_t num_receivers);

} // namespace relumine::prt
