// Environments that may stand on their heads.
#pragma once

#include <optional>
#include <string>

#include "cubemap/cube_map.h"

namespace relumine::cubemap {

/// Returns the share of the light (luminance over the sphere) that comes from below the horizon, 0
/// to 1. 0 for a black map.
///
/// Cost:    reads every texel once, in parallel; 2 ms at R = 512.
[[nodiscard]] double light_from_below(const CubeMap& map);

/// Returns a doubt in one clause, with the option that mends the map, where clearly more light
/// comes from below than from above.
[[nodiscard]] std::optional<std::string> upside_down(double light_from_below);

} // namespace relumine::cubemap
