// Cells of all levels in one numbering, so that arrays can hold something for each.
#pragma once

#include <cstdint>

#include "prt/clusters/quadtree.h"

namespace relumine::prt {

/// Cells of all levels above `level`: 6 (1 + 4 + 16 + ...).
[[nodiscard]] constexpr std::uint32_t num_cells_above(std::uint32_t level) {
    return 2u * ((1u << 2u * level) - 1u);
}

/// Place of a cell on the Z curve of its level, all faces one after another; child i of place p is
/// place 4 p + i of the next level.
[[nodiscard]] constexpr std::uint32_t place_in_level(const Cell& cell) {
    std::uint32_t place = static_cast<std::uint32_t>(cell.face);
    for (std::uint32_t bit = cell.level; bit-- > 0;)
        place = place << 2u | (cell.y >> bit & 1u) << 1u | (cell.x >> bit & 1u);
    return place;
}

/// Number of a cell: coarse levels first, a level's cells by place_in_level(). Below 2^32 for all
/// levels up to MaxLevel.
[[nodiscard]] constexpr std::uint32_t cell_index(const Cell& cell) {
    return num_cells_above(cell.level) + place_in_level(cell);
}

/// Level of the cell of this number.
[[nodiscard]] constexpr std::uint32_t level_of_index(std::uint32_t index) {
    std::uint32_t level = 0;
    while (level < MaxLevel && index >= num_cells_above(level + 1))
        ++level;
    return level;
}

} // namespace relumine::prt
