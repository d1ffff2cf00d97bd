// Diffuse light from surface to surface: the matrix that a bounce multiplies with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relumine::prt {

/// Row x holds sampled form factors: the radiance that a receiver of albedo 1 gets from other
/// receivers, its emitters, is the row's weight times the sum of X over the row's columns. An
/// emitter that was hit twice stands twice. Colour is no part of it, so albedo stays editable
/// [direct-to-indirect transfer: Hasan, Pellacini and Bala 2006].
struct BounceMatrix {
    /// [num_rows] by place: weight of each of the row's columns.
    std::vector<float> weights;
    /// [num_rows + 1] the row's first column in `columns`.
    std::vector<std::uint64_t> row_begin = {0};
    /// Places of emitters, ascending within a row.
    std::vector<std::uint32_t> columns = {};
    /// The largest eigenvalue: how much of the light a further bounce keeps at albedo 1. Light
    /// grows for ever at albedos of 1/spectral_radius and more.
    float spectral_radius = 0.0f;

    [[nodiscard]] std::size_t num_rows() const { return weights.size(); }
    [[nodiscard]] std::span<const std::uint32_t> row(std::size_t place) const {
        return {columns.data() + row_begin[place],
                static_cast<std::size_t>(row_begin[place + 1] - row_begin[place])};
    }
    bool operator==(const BounceMatrix&) const = default;
};

/// Throws:  std::invalid_argument where the arrays contradict each other, a column is no emitter, a
///          weight is negative or not finite, or a row's sum is above 1.
void require_bounces(const BounceMatrix& matrix, std::size_t num_rows, std::size_t num_emitters);

/// Returns the largest eigenvalue of a square matrix of bounces, from below, by power iteration.
///
/// Cost:    some 30 bounces.
[[nodiscard]] float spectral_radius(const BounceMatrix& matrix);

} // namespace relumine::prt
