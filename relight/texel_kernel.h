// The inner loop of binning: sums over a rectangle of texels. Vectorised with run-time dispatch.
#pragma once

#include <cstddef>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// Sums over a rectangle's texels of L q, L q x and L q y. x and y count texels from the
/// rectangle's first one.
struct TexelSums {
    glm::dvec3 one{0.0};
    glm::dvec3 x{0.0};
    glm::dvec3 y{0.0};
};

/// Computes the sums. `radiance` (L) and `weights` (q) point to the rectangle's first texel; rows
/// are `stride` texels apart. NaN gives NaN.
///
/// Accuracy: products and the sums down 64 texels of a column are in float, all other sums in
///           double. The error of about 1e-6 is a tenth of the error that the tests allow for a
///           map's power.
[[nodiscard]] TexelSums texel_sums(const glm::vec3* radiance, const float* weights,
                                   std::size_t stride, std::size_t width, std::size_t height);

} // namespace relumine::relight
