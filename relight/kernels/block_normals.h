// Normals as the kernels read them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "files/large_vector.h"
#include "prt/transfer/visible_counts.h"

namespace relumine::relight {

/// Normals of a block, coordinates apart: x[16], y[16], z[16], padded with zeros.
struct alignas(64) BlockNormals {
    std::array<std::array<float, prt::BlockSize>, 3> axes{};
};

/// Returns the normals in blocks.
///
/// Shape:   [ceil(normals.size() / 16)].
[[nodiscard]] inline std::vector<BlockNormals> block_normals(std::span<const glm::vec3> normals) {
    auto blocks =
        files::large_vector<BlockNormals>((normals.size() + prt::BlockSize - 1) / prt::BlockSize);
    for (std::size_t i = 0; i < normals.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            blocks[i / prt::BlockSize].axes[static_cast<std::size_t>(axis)][i % prt::BlockSize] =
                normals[i][axis];
    return blocks;
}

} // namespace relumine::relight
