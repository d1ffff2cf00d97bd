// The inner loop of binning: sums over texels. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

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

/// Sums down 8 texels side by side, from the first of at most 64 rows on. A rectangle of such
/// columns has the TexelSums that texel_sums() finds, bit by bit, if its columns are added from
/// left to right, and columns of the first 64 rows before columns of the next.
struct TexelColumn {
    static constexpr std::size_t Width = 8;
    static constexpr std::size_t MaxHeight = 64;

    /// [texel][channel] L q
    std::array<float, 3 * Width> one{};
    /// [texel][channel] L q y, where y counts rows from the column's first one
    std::array<float, 3 * Width> y{};
    /// Rows so far
    std::size_t height = 0;

    /// Adds the column to a rectangle's sums. `first_x` and `first_y` is the column's first texel.
    void add_to(TexelSums& sums, std::size_t first_x, std::size_t first_y) const;
};

/// Adds rows to columns side by side. No column may become higher than its MaxHeight. Returns the
/// largest of all values' bits, as whole numbers: floats from 0 up keep their order so, and
/// negative ones and NaN are larger.
std::uint32_t add_rows(const glm::vec3* radiance, const float* weights, std::size_t stride,
                       std::size_t num_rows, std::span<TexelColumn> columns);

} // namespace relumine::relight
