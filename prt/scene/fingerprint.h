// What the result of a precompute depends on, so that work is only gone on with where it belongs.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/precompute.h"

namespace relumine::prt {

/// Names and values in a fixed order; equal for equal results. Neither the engine nor the threads
/// nor the memory are in it.
using Fingerprint = std::vector<std::pair<std::string, std::string>>;

/// `glossy_tolerance` only where highlights follow.
[[nodiscard]] Fingerprint fingerprint(const mesh::TriangleMesh& blockers,
                                      const Receivers& receivers, const PrecomputeOptions& options,
                                      std::optional<float> glossy_tolerance);

} // namespace relumine::prt
