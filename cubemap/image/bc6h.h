// BC6H: 4 x 4 pixels of half floats in 16 bytes, as graphics processors read them.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Returns the pixels of a block, row by row. Those of a reserved mode are black, as Direct3D has
/// it.
[[nodiscard]] std::array<glm::vec3, 16> decode_bc6h(std::span<const std::byte, 16> block,
                                                    bool is_signed);

} // namespace relumine::cubemap
