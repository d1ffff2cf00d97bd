// The inputs that the result of a precompute depends on. A checkpoint is taken up only where they
// match.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// Names and values in a fixed order; equal for equal results. The ray engine, the threads and the
/// memory limits are left out.
using Fingerprint = std::vector<std::pair<std::string, std::string>>;

/// Returns the fingerprint of the work on a scene that has no light yet. Light bounces where a
/// tolerance is given.
[[nodiscard]] Fingerprint fingerprint(const Scene& scene, std::optional<float> bounce_tolerance);

} // namespace relumine::prt
