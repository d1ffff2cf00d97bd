// A dense matrix of receivers and columns in small integers: what all baselines multiply with.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::bench {

/// Rows of sixteen receivers at a time, as floats.
struct BlockedRows {
    std::size_t num_receivers = 0;
    std::size_t num_columns = 0;
    /// Writes the rows of a block, [num_columns][16]; receivers beyond the last are zero. Called
    /// from several threads.
    std::function<void(std::size_t block, std::span<float> rows)> read = {};

    [[nodiscard]] std::size_t num_blocks() const { return (num_receivers + 15) / 16; }
};

/// [num_blocks][num_columns][16] integers, with a scale for each column.
template<typename Integer>
struct PackedMatrix {
    std::size_t num_receivers = 0;
    std::size_t num_columns = 0;
    std::vector<Integer> values = {};
    /// [num_columns] what the integer 1 stands for
    std::vector<float> scales = {};

    [[nodiscard]] std::size_t bytes() const {
        return values.size() * sizeof(Integer) + scales.size() * sizeof(float);
    }
};

/// Rounds rows to integers; the largest of a column gets the largest integer. Integer is int8_t,
/// int16_t, or uint8_t for rows that are not negative.
template<typename Integer>
[[nodiscard]] PackedMatrix<Integer> packed(const BlockedRows& rows);

/// Radiance = matrix times light, all receivers in their order of rows. Parallel, with the best
/// vector instructions there are.
///
/// Shape:   light is [num_columns], radiance becomes [num_receivers].
template<typename Integer>
void multiply(const PackedMatrix<Integer>& matrix, std::span<const glm::vec3> light,
              std::vector<glm::vec3>& radiance);

} // namespace relumine::bench
