// What the sums of TurnedTile are made of and keep.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Where the corners of a tile's texels lie to a face: corner (x, y) is in the direction origin +
/// x across + y down, whose parts are to the right, down and out of the face.
struct TilePlace {
    glm::dvec3 origin, across, down;

    [[nodiscard]] glm::dvec3 corner(double x, double y) const {
        return origin + x * across + y * down;
    }
};

/// Rows of texels in memory: the first texel, and how far it is to the next column and row.
template<class Texel>
struct TexelRows {
    Texel* first = nullptr;
    std::ptrdiff_t next_column = 1, next_row = 0;

    [[nodiscard]] Texel* at(std::ptrdiff_t x, std::ptrdiff_t y) const {
        return first + x * next_column + y * next_row;
    }
};

/// The texels of a tile, and the texels on the opposite side of the cube.
template<class Texel>
using TexelPair = std::array<TexelRows<Texel>, 2>;

/// What a tile keeps. Corners, and the texels whose upper left they are, lie row by row, `Stride`
/// apart, which vectors divide.
struct TileWork {
    static constexpr std::size_t NumSides = std::tuple_size_v<TexelPair<glm::vec3>>;
    static constexpr std::uint32_t MaxWidth = 31, MaxHeight = 16;
    static constexpr std::size_t Stride = MaxWidth + 1;
    static constexpr std::size_t NumCorners = (MaxHeight + 1) * Stride;
    /// How far rounding may put corners outside of what the outermost corners bound, in cells.
    static constexpr double Margin = 1e-6;

    /// Points on the face, in cells; and for each the cell, and the place in it, in [0, 1].
    struct Points {
        alignas(64) std::array<double, NumCorners> position_x, position_y;
        alignas(64) std::array<float, NumCorners> column, row, x, y;

        [[nodiscard]] glm::dvec2 position(std::size_t at) const {
            return {position_x[at], position_y[at]};
        }
        void set(std::size_t at, const glm::dvec2& position) {
            position_x[at] = position.x;
            position_y[at] = position.y;
        }
    };
    /// Three colours and solid angle, of both sides.
    static constexpr std::size_t NumValues = 4, NumSums = NumSides * NumValues;
    using Sum = std::array<double, NumSums>;
    using Sums = std::array<Sum, NumCorners>;
    /// Edges cut where they go from cell to cell. As many edges as a vector has lanes are a group:
    /// its first line has the first piece of each, and it has as many lines as its longest edge has
    /// pieces. Of a piece the cell, and the factors of what the cell holds.
    struct Pieces {
        std::vector<std::int32_t> cells;
        std::vector<double> of_left, of_change;
        std::vector<float> of_density;
        std::size_t size = 0;
        /// Lines of each group.
        std::vector<std::size_t> num_lines;
    };
    struct alignas(64) Cell {
        /// What lies to the left of the cell in its row; and how that changes over the row's height
        /// where it does not as at the middle of the part.
        Sum left;
        std::array<float, NumSums> change_left;
        /// What lies in the cell, for each unit of its area.
        std::array<float, NumSums> density;
    };

    struct alignas(32) Colors {
        std::array<float, NumSums> values;
    };
    /// What the texels of a pair have so far.
    struct alignas(64) Pair {
        Sums texels;
        /// The least of 0 and the colours that they meet: where a texel touches a sun, rounding may
        /// make less of its dark.
        alignas(64) std::array<float, NumSums> least;
    };

    Points corners;
    /// The ends of edges on the face, where the tile reaches over the face's sides.
    Points starts, ends;

    /// [corners] the sums along the edges to the right of each and down from it.
    alignas(64) Sums of_across, of_down;
    Pieces across, down;

    std::vector<Pair> pairs;

    /// The part of the face that the tile meets: its cells row by row, and of each row the columns
    /// from and to.
    std::vector<Cell> cells;
    std::vector<glm::ivec2> columns;
    /// [cells] the density at each cell's middle, and that of change_left.
    std::vector<double> middles, changes;
    /// [cells of a row] the colours of both sides, and 1 for solid angle.
    std::vector<Colors> colors;
    /// The part's first cell, and its numbers of columns and rows.
    glm::ivec2 first = {}, size = {};

    /// A texel of the face has 2^shift x 2^shift cells. Cells along a side, and how far these reach
    /// in [-1, 1].
    std::int32_t shift = 0, num_cells = 0;
    float scale = 0.0f;

    std::uint32_t width = 0, height = 0;
    /// Whether no face was added yet.
    bool is_first = true;
    bool is_cut = false;
};

} // namespace relumine::cubemap
