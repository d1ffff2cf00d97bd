// The operator as a sparse matrix, for scenes that are small enough to write it down.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/relighter.h"

namespace relumine::relight {

/// A relight as a product: radiance[r] of a channel is the sum of data[channel] * light of that
/// channel over the entries of row r. Rows are receivers in their own order. Columns are clusters,
/// and behind them the sharp lights. Compressed rows: those of scipy.sparse.csr_array.
///
/// Light is a vector in its cluster, so that the cosine, and with it the entry, may differ from
/// channel to channel.
struct Transport {
    /// [num_receivers + 1] where rows begin
    std::vector<std::uint32_t> row_begins;
    /// [num_entries] ascending in each row
    std::vector<std::uint32_t> columns;
    /// [channel][num_entries] colours of surfaces included; 1/sr
    std::array<std::vector<float>, 3> data;
    /// [num_columns] the length of each light's vector irradiance; for points, its flux. Radiance
    /// times sr.
    std::vector<glm::dvec3> light;
};

struct TransportOptions {
    /// More entries are refused before they take memory, 16 bytes each.
    std::size_t max_entries = 100'000'000;
};

/// Returns the operator of the present light. Its product with `light` is radiance() without what
/// bounces. docs/operator.md says how the operator depends on the light.
///
/// Cost:    two walks through all pairs of receivers and clusters that see each other.
/// Threads: parallel; the same bits for any number of threads.
/// Throws:  std::invalid_argument for receivers with highlights, and for too many entries.
[[nodiscard]] Transport transport(const Relighter& relighter, const TransportOptions& options = {});

} // namespace relumine::relight
