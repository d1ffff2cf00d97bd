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

/// Sets the normal of a place.
inline void set_normal(std::span<BlockNormals> blocks, std::size_t place, const glm::vec3& normal) {
    for (int axis = 0; axis < 3; ++axis)
        blocks[place / prt::BlockSize]
            .axes[static_cast<std::size_t>(axis)][place % prt::BlockSize] = normal[axis];
}

/// Returns the normals in blocks.
///
/// Shape:   [ceil(normals.size() / 16)].
[[nodiscard]] inline std::vector<BlockNormals> block_normals(std::span<const glm::vec3> normals) {
    auto blocks =
        files::large_vector<BlockNormals>((normals.size() + prt::BlockSize - 1) / prt::BlockSize);
    for (std::size_t i = 0; i < normals.size(); ++i)
        set_normal(blocks, i, normals[i]);
    return blocks;
}

} // namespace relumine::relight
