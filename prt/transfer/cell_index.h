// One numbering for the cells of all levels, so that arrays can hold a value for each cell.
#pragma once

#include <cstdint>

#include "prt/transfer/quadtree.h"

namespace relumine::prt {

/// Returns the number of cells on all levels above `level`: 6 (1 + 4 + 16 + ...).
[[nodiscard]] constexpr std::uint32_t num_cells_above(std::uint32_t level) {
    return 2u * ((1u << 2u * level) - 1u);
}

/// Returns the place of a cell on the Z curve of its level, all faces one after another. Child i of
/// place p has place 4 p + i on the next level.
[[nodiscard]] constexpr std::uint32_t place_in_level(const Cell& cell) {
    std::uint32_t place = static_cast<std::uint32_t>(cell.face);
    for (std::uint32_t bit = cell.level; bit-- > 0;)
        place = place << 2u | (cell.y >> bit & 1u) << 1u | (cell.x >> bit & 1u);
    return place;
}

/// Returns the number of a cell: coarse levels first, the cells of a level by place_in_level(). It
/// is below 2^32 for all levels up to MaxLevel.
[[nodiscard]] constexpr std::uint32_t cell_index(const Cell& cell) {
    return num_cells_above(cell.level) + place_in_level(cell);
}

/// Returns where a cell begins on the Z curve of the deepest level: cells of any level in
/// depth-first order.
[[nodiscard]] constexpr std::uint64_t z_curve_key(const Cell& cell) {
    return std::uint64_t{place_in_level(cell)} << 2u * (MaxLevel - cell.level);
}

/// Returns the level of the cell with this number.
[[nodiscard]] constexpr std::uint32_t level_of_index(std::uint32_t index) {
    std::uint32_t level = 0;
    while (level < MaxLevel && index >= num_cells_above(level + 1))
        ++level;
    return level;
}

/// Returns the cell with a number below num_cells_above(MaxLevel + 1).
[[nodiscard]] constexpr Cell cell_of_index(std::uint32_t index) {
    const std::uint32_t level = level_of_index(index);
    const std::uint32_t place = index - num_cells_above(level);
    Cell cell{.face = static_cast<cubemap::Face>(place >> 2u * level),
              .level = static_cast<std::uint8_t>(level)};
    for (std::uint32_t bit = 0; bit < level; ++bit) {
        cell.x |= (place >> 2u * bit & 1u) << bit;
        cell.y |= (place >> (2u * bit + 1u) & 1u) << bit;
    }
    return cell;
}

} // namespace relumine::prt
