// The plain way to relight: a dense table of transfer in bytes, as [JN] stores it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/transfer/transfer.h"

namespace relumine::bench {

/// T_C(x) of every receiver and cluster in one byte of one scale, [num_blocks][num_clusters][16]:
/// what is read streams, and the same vector instructions do the sums. Nothing is left out, nothing
/// is shared.
struct DenseTable {
    std::size_t num_clusters = 0;
    std::size_t num_blocks = 0;
    std::vector<std::uint8_t> values = {};
    /// Transfer of byte 1, 1/sr
    float scale = 0.0f;
};

[[nodiscard]] DenseTable dense_table(const prt::Transfer& transfer);

/// B = sum over C of L_C T_C [JN, Eq. 8]. light: L_C dw_C [num_clusters]; radiance: [num_blocks *
/// 16] by place. Parallel.
void relight(const DenseTable& table, std::span<const glm::vec3> light,
             std::vector<glm::vec3>& radiance);

} // namespace relumine::bench
