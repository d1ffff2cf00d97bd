// Which directions lie above a receiver's horizon. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "prt/clusters/cluster_kernels.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// Sets bit j of rays[i] where the cosine of NormalArrays is above 0 for receiver first + i and the
/// patch's direction j.
///
/// The cosine is ((nx wx + ny wy) + nz wz) + nw in float, each operation rounded, on every
/// processor. So a cluster's bits never depend on the machine.
void directions_above_horizon(const NormalArrays& normals, std::size_t first,
                              const DirectionPatch& patch, std::span<std::uint64_t> rays);

/// Returns the same answers for the nine samples of a cell and 16 receivers: bit i of entry l is
/// set where n.w > 0 for receiver first + i and direction l.
[[nodiscard]] std::array<std::uint16_t, SamplesPerCell>
samples_above_horizon(const NormalArrays& normals, std::size_t first,
                      std::span<const glm::vec3, SamplesPerCell> directions);

} // namespace relumine::prt
