// The clusters' borders as lines of the lat-long picture.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "relumine/light/light_parts.h"

namespace relumine::viewer {

/// Returns the ends of line segments, two by two, in lat-long coordinates (see lat_long()). u may
/// reach beyond 0 and 1 where a line crosses the seam. A border that two cells share appears once,
/// or in the pieces of the smaller cells.
[[nodiscard]] std::vector<glm::vec2> quadtree_lines(const prt::Quadtree& quadtree);

} // namespace relumine::viewer
