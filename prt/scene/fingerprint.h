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

/// What follows the clusters.
struct LaterWork {
    /// Given only where highlights follow.
    std::optional<float> glossy_tolerance = {};
    /// Given only where bounces follow.
    std::optional<float> bounce_tolerance = {};
    bool two_sided_bounces = false;
};

/// Returns the fingerprint of a run.
[[nodiscard]] Fingerprint fingerprint(const mesh::TriangleMesh& blockers,
                                      const Receivers& receivers, const PrecomputeOptions& options,
                                      const LaterWork& later = {});

} // namespace relumine::prt
