// Light that surfaces pass on from behind them.
#pragma once

#include <vector>

#include "relight/bounces/bounce_light.h"
#include "relumine/in/scene.h"

namespace relumine {

/// Returns what surfaces pass on to their other side (KHR_materials_diffuse_transmission), of
/// scenes of vertices without stored highlights; none elsewhere.
///
/// Cost:    O(n log n) where any material passes light on.
[[nodiscard]] std::vector<relight::PassedOn> passed_on(const Scene& scene);

} // namespace relumine
