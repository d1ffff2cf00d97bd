#include "relight/kernels/band_sums.h"

#include <algorithm>
#include <array>

#include "cubemap/face.h"
#include "files/parallel.h"

namespace relumine::relight {

namespace {

constexpr std::size_t Width = TexelColumn::Width;
/// A task is a band. Cells of the least level that a precompute has by default are as high.
constexpr std::size_t BandsPerFace = 8;

} // namespace

BandSums::BandSums(std::uint32_t face_resolution, std::span<const prt::Cell> cells)
    : cells_(cells), num_columns_(face_resolution / Width),
      steps_per_band_(num_columns_ / BandsPerFace), is_summed_(cells.size()) {
    if (face_resolution % (Width * BandsPerFace) != 0)
        return;
    cell_at_.assign(row_of(cubemap::NumFaces, 0), NoCell);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const prt::Cell& cell = cells[i];
        const std::size_t edge = columns_of(cell);
        if (edge == 0 || edge > steps_per_band_)
            continue;
        const auto row = [&](std::size_t step) {
            const std::size_t first = row_of(static_cast<std::size_t>(cell.face), step);
            return std::span(cell_at_).subspan(first + cell.x * edge, edge);
        };
        const std::size_t begin = cell.y * edge, end = begin + edge;
        bool is_free = true;
        for (std::size_t step = begin; step < end; ++step)
            for (const std::uint32_t other : row(step))
                is_free = is_free && other == NoCell;
        if (!is_free)
            continue;
        is_summed_[i] = true;
        for (std::size_t step = begin; step < end; ++step) {
            const auto own = row(step);
            std::fill(own.begin(), own.end(), static_cast<std::uint32_t>(i));
        }
    }
}

std::size_t BandSums::columns_of(const prt::Cell& cell) const {
    const std::size_t cells_per_edge = std::size_t{1} << cell.level;
    return num_columns_ % cells_per_edge == 0 ? num_columns_ / cells_per_edge : 0;
}

BandSums::Result BandSums::sums(const cubemap::CubeMap& environment,
                                std::span<const float> weights) const {
    Result result{.sums = std::vector<TexelSums>(cells_.size())};
    if (!reads_all())
        return result;
    std::array<std::uint32_t, BandsPerFace * cubemap::NumFaces> largest_bits{};
    files::parallel_for(std::size_t{0}, largest_bits.size(), [&](std::size_t i) {
        largest_bits[i] = sum_band(environment, weights, i / BandsPerFace,
                                   i % BandsPerFace * steps_per_band_, result.sums);
    });
    result.largest_bits = *std::max_element(largest_bits.begin(), largest_bits.end());
    return result;
}

std::uint32_t BandSums::sum_band(const cubemap::CubeMap& environment,
                                 std::span<const float> weights, std::size_t face,
                                 std::size_t first_step, std::vector<TexelSums>& sums) const {
    std::uint32_t largest_bits = 0;
    const std::size_t resolution = environment.resolution;
    std::vector<TexelColumn> columns(num_columns_);
    for (std::size_t step = first_step; step < first_step + steps_per_band_; ++step) {
        const std::size_t row = step * Width;
        const glm::vec3* texels =
            &environment.at(static_cast<cubemap::Face>(face), 0, static_cast<std::uint32_t>(row));
        largest_bits = std::max(largest_bits, add_rows(texels, weights.data() + row * resolution,
                                                       resolution, Width, columns));
        const bool is_last = step + 1 == first_step + steps_per_band_;
        const std::uint32_t* const here = &cell_at_[row_of(face, step)];
        const std::uint32_t* const below = is_last ? nullptr : here + num_columns_;
        for (std::size_t i = 0; i < num_columns_; ++i) {
            TexelColumn& column = columns[i];
            const std::uint32_t index = here[i];
            if (below != nullptr && below[i] == index && index != NoCell &&
                column.height < TexelColumn::MaxHeight)
                continue;
            if (index != NoCell) {
                const prt::Cell& cell = cells_[index];
                const std::size_t edge = columns_of(cell);
                column.add_to(sums[index], Width * (i - cell.x * edge),
                              row + Width - column.height - Width * cell.y * edge);
            }
            column = {};
        }
    }
    return largest_bits;
}

} // namespace relumine::relight
