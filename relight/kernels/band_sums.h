// Sums of an environment's texels over many cells, read in the order in which they lie in memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cubemap/cube_map.h"
#include "prt/transfer/quadtree.h"
#include "relight/kernels/texel_kernel.h"

namespace relumine::relight {

/// The cells that are summed band by band: squares of whole TexelColumns, as high as a band at
/// most. Cells by themselves read a few lines of memory from each row, far apart, which takes twice
/// as long.
class BandSums {
public:
    /// `cells` must last as long as this.
    BandSums(std::uint32_t face_resolution, std::span<const prt::Cell> cells);

    [[nodiscard]] std::span<const prt::Cell> cells() const { return cells_; }
    /// Whether sums() has the cell's.
    [[nodiscard]] bool has(std::size_t cell) const { return is_summed_[cell]; }
    /// Whether sums() reads every texel, whichever cells have it.
    [[nodiscard]] bool reads_all() const { return !cell_at_.empty(); }

    struct Result {
        /// [cells] zero for a cell that has() denies.
        std::vector<TexelSums> sums;
        /// The largest that add_rows() returned.
        std::uint32_t largest_bits = 0;
    };
    /// Computes texel_sums() of the cells' texels, bit by bit; parallel.
    [[nodiscard]] Result sums(const cubemap::CubeMap& environment,
                              std::span<const float> weights) const;

private:
    /// Returns the largest that add_rows() returned.
    std::uint32_t sum_band(const cubemap::CubeMap& environment, std::span<const float> weights,
                           std::size_t face, std::size_t first_step,
                           std::vector<TexelSums>& sums) const;
    /// Returns the cell's edge in columns; 0 for a cell that is no square of whole columns.
    [[nodiscard]] std::size_t columns_of(const prt::Cell& cell) const;
    /// Returns the place of a step's first column in `cell_at_`.
    [[nodiscard]] std::size_t row_of(std::size_t face, std::size_t step) const {
        return (face * num_columns_ + step) * num_columns_;
    }

    static constexpr std::uint32_t NoCell = ~std::uint32_t{0};

    std::span<const prt::Cell> cells_;
    /// TexelColumns side by side on a face
    std::size_t num_columns_;
    /// A step is as many rows as a column is wide.
    std::size_t steps_per_band_;
    std::vector<bool> is_summed_;
    /// [face][step][column] index of the cell
    std::vector<std::uint32_t> cell_at_;
};

} // namespace relumine::relight
