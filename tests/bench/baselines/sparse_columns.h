// A sparse matrix of bytes by columns: wavelets with what is small left out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "tests/bench/baselines/packed_matrix.h"

namespace relumine::bench {

/// Entries of three bytes: a receiver within its chunk, and a value in units of its column's scale
/// [Ng et al., SIGGRAPH 2003, Section 5: what quantises to zero is dropped].
class SparseColumns {
public:
    /// Keeps the `num_entries` largest entries of all rows, so the squared error is the least for
    /// so many. Parallel; reads the rows three times.
    SparseColumns(const BlockedRows& rows, std::size_t num_entries);

    [[nodiscard]] std::size_t bytes() const;
    /// What a file would hold: the entries, chunk by chunk.
    [[nodiscard]] std::vector<std::byte> content() const;

    /// Radiance = matrix times light over the `num_columns` columns that light the most: light's
    /// magnitude times the column's, Ng's "area-weighted" choice with the transport's own weight.
    /// 0 takes all columns. Parallel over chunks of receivers.
    void multiply(std::span<const glm::vec3> light, std::size_t num_columns,
                  std::vector<glm::vec3>& radiance) const;

private:
    /// Receivers that one thread sums.
    struct Chunk {
        /// [num_columns + 1] where each column's entries begin
        std::vector<std::uint32_t> begin;
        std::vector<std::uint16_t> receivers;
        std::vector<std::int8_t> values;
    };
    [[nodiscard]] std::vector<std::uint32_t> chosen(std::span<const glm::vec3> light,
                                                    std::size_t num_columns) const;

    std::size_t num_receivers_;
    std::vector<Chunk> chunks_;
    /// [num_columns]
    std::vector<float> scales_, norms_;
};

} // namespace relumine::bench
