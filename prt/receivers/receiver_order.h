// The order of receivers in memory: receivers with similar visibility stand next to each other.
#pragma once

#include <cstdint>
#include <vector>

#include "prt/receivers/receivers.h"

namespace relumine::prt {

/// Returns an order in which neighbours are near in space and face alike.
///
/// Shape:   [num_receivers] receiver index by place.
/// Order:   blocks are the runs of 16 from place 0 on, whose counts are kept together; groups are
///          the runs of 128, which are traced together. Within a block, by index. Added vertices
///          come after the others, and receivers with a zero normal last.
/// Cost:    O(n log n): 0.1 s for 100,000 receivers. Parallel (TBB), deterministic.
///
/// The receivers are halved again and again. There are six axes: position, and normal times 1/32 of
/// the scene's extent. Each cut is across the axis that leaves the two most compact halves. On the
/// bunny a third fewer blocks have receivers that see different parts of a cluster than with Morton
/// order of positions: most such receivers differ by their horizons, which the normals tell apart.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(const Receivers& receivers);

} // namespace relumine::prt
