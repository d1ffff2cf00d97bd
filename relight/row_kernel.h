// The inner loop of binning: sums along a row of texels. Vectorised with run-time dispatch.
#pragma once

#include <cstddef>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// Sums over `count` texels of L q and L q u, with u = first_u + i step.
struct RowSums {
    glm::dvec3 one{0.0};
    glm::dvec3 u{0.0};
};

/// radiance: L [count]; weights: q [count]. Products and the sums over a run of 256 texels are in float (their error, about 1e-6, is a tenth of what
/// the tests allow a map's power), runs are added in double. NaN gives NaN.
[[nodiscard]] RowSums row_sums(const glm::vec3* radiance, const float* weights, std::size_t count,
                               double first_u, double step);

} // namespace relumine::relight
