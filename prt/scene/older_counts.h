// Visible counts as versions 1 and 2 of the .prt file have them.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "prt/transfer/quadtree.h"
#include "prt/transfer/visible_counts.h"

namespace relumine::prt {

/// Moves counts into tiles. In version 1, the words of a block lie together, block by block, and
/// the counts are in the order of these words. Everything but `mixed_before` is given.
///
/// Throws:  as VisibleCounts::index().
void move_into_tiles(VisibleCounts& counts);

/// Turns a count of all nine samples, as up to version 2, into a count of the samples above the
/// receiver's horizon. The result is what a precompute finds now, bit by bit. `counts` are indexed.
///
/// Shape:   normals are [num_receivers] by place. Clusters of `texel_level` have one sample.
/// Cost:    O(mixed pairs); parallel (TBB).
void count_above_horizon(VisibleCounts& counts, const Quadtree& quadtree,
                         std::span<const glm::vec3> normals, std::uint32_t texel_level);

} // namespace relumine::prt
