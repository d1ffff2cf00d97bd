// Exact integration: every light of the environment, every shadow ray. Slow and right; the
// reference for the fast path.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment_file.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/blockers.h"
#include "prt/work.h"

namespace relumine::relight {

struct ExactOptions {
    /// Lift of the rays' origins, as in prt::PrecomputeOptions.
    float bias = 0.0f;
};

/// Returns the outgoing radiance of the chosen receivers: B = 1/pi sum over all 6 R^2 texels of L_j
/// dw_j V(w_j) max(n.w_j, 0), lights at texel centres, sums in double [JN, Eq. 1]. Albedo is 1
/// where receivers have no surfaces; otherwise the lobes and colours of their surfaces count.
/// Points in space get their mean radiance over the sphere: B = 1/(4 pi) sum of L_j dw_j V(w_j).
///
/// Shape:   [receiver_indices.size()].
/// Cost:    a ray per receiver and texel that is not black and above the horizon.
/// Threads: parallel over receivers; the order of each sum is fixed.
/// Throws:  std::invalid_argument for an index or a size that does not fit the receivers, and for
///          an environment without texels; prt::Cancelled when stopped.
[[nodiscard]] std::vector<glm::dvec3>
exact_radiance(const prt::Receivers& receivers, std::span<const std::uint32_t> receiver_indices,
               const prt::Blockers& blockers, const cubemap::CubeMap& environment,
               const ExactOptions& options = {}, const prt::Work& work = {});

/// Integrates the pixels of an environment's file, without a cube map between: each pixel is a
/// small area of even radiance. Pixels that hold much of the light are cut into parts, so that no
/// ray stands for much of it. Dim neighbours of large images share a ray.
///
/// Cost:    about 130,000 rays for each receiver at most, and some thousand for bright pixels; half
///          a million under a mirror ball.
/// Throws:  as above.
[[nodiscard]] std::vector<glm::dvec3>
exact_radiance(const prt::Receivers& receivers, std::span<const std::uint32_t> receiver_indices,
               const prt::Blockers& blockers, const cubemap::EnvironmentFile& environment,
               const ExactOptions& options = {}, const prt::Work& work = {});

/// Returns `count` receivers chosen at random without repetition; all of them for 0, or for more
/// than there are. Only receivers below `end` are taken. The same seed gives the same receivers.
/// Neighbours in space stand together, so that their rays are traced together.
[[nodiscard]] std::vector<std::uint32_t>
random_receivers(const prt::Transfer& transfer, std::size_t count, std::uint64_t seed,
                 std::size_t end = static_cast<std::size_t>(-1));

/// The difference between relit and exact radiance.
struct ErrorReport {
    /// ||B - B_exact|| / ||B_exact|| over receivers and RGB; 0 where both are black.
    double relative_l2 = 0.0;
    /// Mean |B - B_exact| over receivers and RGB, over mean_radiance.
    double mean_abs = 0.0;
    /// Largest |B - B_exact|, over mean_radiance.
    double max_abs = 0.0;
    /// Mean of B - B_exact over receivers and RGB, over mean_radiance.
    double bias = 0.0;
    /// Mean of B_exact over receivers and RGB.
    double mean_radiance = 0.0;
    /// The receiver with max_abs.
    std::uint32_t worst_receiver = 0;
};

/// Compares relit with exact radiance.
///
/// Shape:   exact is [receiver_indices.size()] from exact_radiance(); relit is [num_receivers].
/// Throws:  std::invalid_argument for sizes or indices that do not fit.
[[nodiscard]] ErrorReport compare(std::span<const std::uint32_t> receiver_indices,
                                  std::span<const glm::dvec3> exact,
                                  std::span<const glm::vec3> relit);

} // namespace relumine::relight
