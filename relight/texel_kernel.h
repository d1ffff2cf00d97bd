// The inner loop of binning: sums over a rectangle of texels. Vectorised with run-time dispatch.
#pragma once

#include <cstddef>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// Sums over a rectangle's texels of L q, L q x and L q y; x and y count texels from its first.
struct TexelSums {
    glm::dvec3 one{0.0};
    glm::dvec3 x{0.0};
    glm::dvec3 y{0.0};
};

/// radiance: L, weights: q, both of the rectangle's first texel; rows are `stride` texels apart.
/// Products and the sums down 64 texels of a column are in float (their error, about 1e-6, is a
/// tenth of what the tests allow a map's power), all other sums in double. NaN gives NaN.
[[nodiscard]] TexelSums texel_sums(const glm::vec3* radiance, const float* weights,
                                   std::size_t stride, std::size_t width, std::size_t height);

} // namespace relumine::relight
