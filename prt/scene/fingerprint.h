// The inputs that the result of a precompute depends on. A checkpoint is taken up only where they
// match.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/precompute.h"

namespace relumine::prt {

/// Names and values in a fixed order; equal for equal results. The ray engine, the threads and the
/// memory limits are left out.
using Fingerprint = std::vector<std::pair<std::string, std::string>>;

/// Returns the fingerprint of a run. Give `glossy_tolerance` only where highlights follow.
[[nodiscard]] Fingerprint fingerprint(const mesh::TriangleMesh& blockers,
                                      const Receivers& receivers, const PrecomputeOptions& options,
                                      std::optional<float> glossy_tolerance);

} // namespace relumine::prt
