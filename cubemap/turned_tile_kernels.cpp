#include "cubemap/turned_tile_kernels.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include <hwy/cache_control.h>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cubemap/turned_tile_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cubemap/turned_density-inl.h"
#include "cubemap/turned_walk-inl.h"
#include "files/wasm_doubles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::cubemap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Work = TileWork;
using Points = Work::Points;
using Cell = Work::Cell;
using Faces = TexelPair<const glm::vec3>;
constexpr std::size_t Stride = Work::Stride;

using SumLanes = hn::CappedTag<double, Work::NumSums>;
constexpr std::size_t NumSums = Work::NumSums;
/// Vectors of sums, and the numbers of each.
constexpr std::size_t Step = hn::MaxLanes(SumLanes()), NumVectors = NumSums / Step;

void place_corners(const TilePlace& place, Work& work) {
    const Doubles d;
    const auto half = hn::Set(d, 0.5 * work.num_cells);
    for (std::size_t y = 0; y <= work.height; ++y) {
        const glm::dvec3 first = place.corner(0.0, static_cast<double>(y));
        for (std::size_t x = 0; x < Stride; x += hn::Lanes(d)) {
            const auto steps = hn::Iota(d, static_cast<double>(x));
            const auto along = [&](int axis) {
                return hn::MulAdd(hn::Set(d, place.across[axis]), steps, hn::Set(d, first[axis]));
            };
            const auto scale = hn::Div(half, along(2));
            const std::size_t at = y * Stride + x;
            hn::Store(hn::MulAdd(along(0), scale, half), d, work.corners.position_x.data() + at);
            hn::Store(hn::MulAdd(along(1), scale, half), d, work.corners.position_y.data() + at);
        }
    }
}

/// From coordinates on the face to cells and places in them.
void split(const double* positions, std::int32_t num_cells, float* cells, float* places) {
    const Doubles wide;
    const hn::Rebind<float, Doubles> half;
    for (std::size_t i = 0; i < hn::Lanes(Lanes()); i += hn::Lanes(wide)) {
        const auto position = hn::LoadU(wide, positions + i);
        const auto cell =
            hn::Max(hn::Zero(wide), hn::Min(hn::Floor(position), hn::Set(wide, num_cells - 1.0)));
        const auto place = hn::DemoteTo(half, hn::Sub(position, cell));
        // Multiples of 2^-23, whose differences are exact.
        const auto one = hn::Set(half, 1.0f);
        hn::StoreU(hn::DemoteTo(half, cell), half, cells + i);
        hn::StoreU(hn::Sub(hn::Add(place, one), one), half, places + i);
    }
}

void find_cells(std::size_t num_rows, const Work& work, Points& points) {
    for (std::size_t at = 0; at < num_rows * Stride; at += hn::Lanes(Lanes())) {
        split(points.position_x.data() + at, work.num_cells, points.column.data() + at,
              points.x.data() + at);
        split(points.position_y.data() + at, work.num_cells, points.row.data() + at,
              points.y.data() + at);
    }
}

/// Returns the index of a cell of the part.
std::size_t index_of(std::int32_t column, std::int32_t row, const Work& work) {
    return static_cast<std::size_t>((row - work.first.y) * work.size.x + column - work.first.x);
}

/// Writes what a row's cells from `begin` to `end` have at their middles.
void find_densities(std::int32_t row, std::int32_t begin, std::int32_t end, const Density& density,
                    Work& work) {
    const std::size_t first = index_of(begin, row, work);
    const Vec v = middle(number(static_cast<float>(row)), work.scale);
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(Lanes()));
    for (std::int32_t column = begin; column < end; column += lanes) {
        const Vec u = middle(hn::Iota(Lanes(), static_cast<float>(column)), work.scale);
        const Vec inverse = hn::Div(number(1.0f), hn::MulAdd(u, u, hn::MulAdd(v, v, number(1.0f))));
        const std::size_t at = first + static_cast<std::size_t>(column - begin);
        store_wide(hn::Mul(inverse, hn::Sqrt(inverse)), work.middles.data() + at);
        const Vec y_slope = hn::Mul(number(-3.0f * work.scale), hn::Mul(inverse, v));
        store_wide(density.change(y_slope), work.changes.data() + at);
    }
}

/// Copies the colours of a row's cells from `begin` to `end` on both sides, and 1 for solid angle.
void copy_colors(std::int32_t row, std::int32_t begin, std::int32_t end, const Faces& faces,
                 Work& work) {
    const std::int32_t shift = work.shift;
    for (std::size_t side = 0; side < Work::NumSides; ++side) {
        const std::ptrdiff_t step = faces[side].next_column;
        const glm::vec3* texels = faces[side].at(0, row >> shift);
        float* to = work.colors.data()->values.data() + side * Work::NumValues;
        for (std::int32_t column = begin; column < end; ++column, to += NumSums) {
            std::memcpy(to, texels + (column >> shift) * step, sizeof(glm::vec3));
            to[3] = 1.0f;
        }
    }
}

/// Fills a row's cells from `begin` to `end`. Sums run from the left; where the part ends at the
/// face's right side, from there, so that what lies outside the face has no part in an edge's sum.
void fill_row(std::int32_t row, std::int32_t begin, std::int32_t end, const Density& density,
              const Faces& faces, Work& work, Work::Pair& pair) {
    copy_colors(row, begin, end, faces, work);
    const std::size_t first = index_of(begin, row, work);
    const auto count = static_cast<std::size_t>(end - begin);
    const Work::Colors* colors = work.colors.data();
    const double *middles = &work.middles[first], *changes = &work.changes[first];
    Cell* cells = &work.cells[first];
    const SumLanes ds;
    const hn::Rebind<float, SumLanes> narrow;
    const auto across = hn::Set(ds, double{density.across_middle()});
    hn::Vec<SumLanes> sums[NumVectors], change_sums[NumVectors];
    hn::Vec<decltype(narrow)> least[NumVectors];
    for (std::size_t j = 0; j < NumVectors; ++j) {
        sums[j] = change_sums[j] = hn::Zero(ds);
        least[j] = hn::Load(narrow, pair.least.data() + j * Step);
    }
    const auto light_of = [&](std::size_t i, std::size_t j) {
        const auto values = hn::Load(narrow, colors[i].values.data() + j * Step);
        least[j] = hn::Min(least[j], values);
        return hn::Mul(hn::PromoteTo(ds, values), hn::Set(ds, middles[i]));
    };
    const auto store = [&](std::size_t i, std::size_t j, const auto& light) {
        Cell& cell = cells[i];
        hn::Store(sums[j], ds, cell.left.data() + j * Step);
        hn::Store(hn::DemoteTo(narrow, change_sums[j]), narrow, cell.change_left.data() + j * Step);
        hn::Store(hn::DemoteTo(narrow, light), narrow, cell.density.data() + j * Step);
    };
    if (end == work.num_cells)
        for (std::size_t i = count; i-- > 0;)
            for (std::size_t j = 0; j < NumVectors; ++j) {
                const auto light = light_of(i, j);
                sums[j] = hn::NegMulAdd(light, across, sums[j]);
                change_sums[j] = hn::NegMulAdd(light, hn::Set(ds, changes[i]), change_sums[j]);
                store(i, j, light);
            }
    else
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < NumVectors; ++j) {
                const auto light = light_of(i, j);
                store(i, j, light);
                sums[j] = hn::MulAdd(light, across, sums[j]);
                change_sums[j] = hn::MulAdd(light, hn::Set(ds, changes[i]), change_sums[j]);
            }
    for (std::size_t j = 0; j < NumVectors; ++j)
        hn::Store(least[j], narrow, pair.least.data() + j * Step);
}

/// That at the middle of the tile's part.
Density density_of(const Work& work) {
    const auto middle = [&](std::int32_t first, std::int32_t count) {
        return (static_cast<float>(first) + 0.5f * static_cast<float>(count)) * work.scale - 1.0f;
    };
    return {middle(work.first.x, work.size.x), middle(work.first.y, work.size.y), work.scale};
}

/// The columns of a row that the tile meets.
glm::ivec2 columns_in_row(std::int32_t row, const Work& work) {
    const double top = row - Work::Margin, bottom = row + 1 + Work::Margin;
    const std::array<std::size_t, 5> corners = {0, work.width, work.height * Stride + work.width,
                                                work.height * Stride, 0};
    const std::int32_t end = work.first.x + work.size.x;
    double least = end, most = work.first.x;
    for (std::size_t i = 0; i < 4; ++i) {
        const double x = work.corners.position_x[corners[i]],
                     y = work.corners.position_y[corners[i]],
                     end_x = work.corners.position_x[corners[i + 1]],
                     end_y = work.corners.position_y[corners[i + 1]];
        if (std::max(y, end_y) < top || std::min(y, end_y) > bottom)
            continue;
        const double slope = y == end_y ? 0.0 : (end_x - x) / (end_y - y);
        const double at_start = x + (std::clamp(y, top, bottom) - y) * slope,
                     at_end = end_x + (std::clamp(end_y, top, bottom) - end_y) * slope;
        least = std::min({least, at_start, at_end});
        most = std::max({most, at_start, at_end});
    }
    const auto cell = [](double position) {
        return static_cast<std::int32_t>(std::max(position, 0.0));
    };
    return {std::clamp(cell(least - Work::Margin), work.first.x, end - 1),
            std::clamp(cell(most + Work::Margin) + 1, work.first.x + 1, end)};
}

/// Asks for the texels of a row's cells. Inline: gcc drops calls of functions that do nothing else.
HWY_INLINE void prefetch(std::int32_t row, const glm::ivec2& columns, const Faces& faces,
                         const Work& work) {
    constexpr std::ptrdiff_t CacheLine = 64 / sizeof(float);
    for (const TexelRows<const glm::vec3>& face : faces) {
        const float* first = &face.at(columns.x >> work.shift, row >> work.shift)->x;
        const float* last = &face.at((columns.y - 1) >> work.shift, row >> work.shift)->x;
        const std::ptrdiff_t step = std::max(CacheLine, 3 * std::abs(face.next_column));
        for (const float* at = std::min(first, last); at <= std::max(first, last); at += step)
            hwy::Prefetch(at);
    }
}

void find_columns(const Faces& first, Work& work) {
    const Density density = density_of(work);
    work.columns.clear();
    for (std::int32_t row = work.first.y; row < work.first.y + work.size.y; ++row) {
        const glm::ivec2 columns = columns_in_row(row, work);
        work.columns.push_back(columns);
        prefetch(row, columns, first, work);
        find_densities(row, columns.x, columns.y, density, work);
    }
}

void fill_cells(const Faces& faces, const Faces* next, Work& work, Work::Pair& pair) {
    const Density density = density_of(work);
    for (std::int32_t r = 0; r < work.size.y; ++r) {
        const glm::ivec2 columns = work.columns[static_cast<std::size_t>(r)];
        const std::int32_t row = work.first.y + r;
        fill_row(row, columns.x, columns.y, density, faces, work, pair);
        if (next != nullptr)
            prefetch(row, columns, *next, work);
    }
}

/// Makes room for more lines.
void reserve_lines(std::size_t count, Work::Pieces& pieces) {
    const std::size_t size = pieces.size + count * MaxLanes;
    if (size <= pieces.cells.size())
        return;
    pieces.cells.resize(2 * size);
    pieces.of_left.resize(2 * size);
    pieces.of_change.resize(2 * size);
    pieces.of_density.resize(2 * size);
}

/// Sums along `count` edges, whose pieces lie in the lines between.
void sum_lines(const Work::Pieces& pieces, std::size_t first, std::size_t end, std::size_t count,
               const Work& work, Work::Sum* sums) {
    using NarrowLanes = hn::CappedTag<float, NumSums>;
    constexpr std::size_t NarrowStep = hn::MaxLanes(NarrowLanes()),
                          NumNarrow = NumSums / NarrowStep;
    const SumLanes ds;
    const NarrowLanes narrow;
    const std::size_t lanes = hn::Lanes(Lanes());
    const Cell* cells = work.cells.data();
    const std::int32_t* indices = pieces.cells.data();
    const double *of_left = pieces.of_left.data(), *of_change = pieces.of_change.data();
    const float* of_density = pieces.of_density.data();
    const auto wide = [&](const std::array<float, NumSums>& values, std::size_t j) {
        return hn::PromoteTo(ds, hn::Load(hn::Rebind<float, SumLanes>(), values.data() + j * Step));
    };
    for (std::size_t i = 0; i < count; ++i) {
        hn::Vec<SumLanes> sum[NumVectors];
        hn::Vec<NarrowLanes> of_texels[NumNarrow];
        for (auto& vector : sum)
            vector = hn::Zero(ds);
        for (auto& vector : of_texels)
            vector = hn::Zero(narrow);
        for (std::size_t k = first + i; k < end; k += lanes) {
            const Cell& cell = cells[indices[k]];
            for (std::size_t j = 0; j < NumVectors; ++j) {
                sum[j] = hn::MulAdd(hn::Set(ds, of_left[k]),
                                    hn::Load(ds, cell.left.data() + j * Step), sum[j]);
                sum[j] = hn::MulAdd(hn::Set(ds, of_change[k]), wide(cell.change_left, j), sum[j]);
            }
            for (std::size_t j = 0; j < NumNarrow; ++j)
                of_texels[j] = hn::MulAdd(hn::Set(narrow, of_density[k]),
                                          hn::Load(narrow, cell.density.data() + j * NarrowStep),
                                          of_texels[j]);
        }
        HWY_ALIGN std::array<float, NumSums> in_texels;
        for (std::size_t j = 0; j < NumNarrow; ++j)
            hn::Store(of_texels[j], narrow, in_texels.data() + j * NarrowStep);
        for (std::size_t j = 0; j < NumVectors; ++j)
            hn::Store(hn::Add(sum[j], wide(in_texels, j)), ds, sums[i].data() + j * Step);
    }
}

void walk_edges(std::size_t width, std::size_t height, const Points& starts, const Points& ends,
                std::size_t to_end, const Work& work, Work::Pieces& pieces, Work::Sums& sums) {
    const Density density = density_of(work);
    const std::size_t lanes = hn::Lanes(Lanes());
    const bool keeps_pieces = work.pairs.size() > 1;
    pieces.size = 0;
    pieces.num_lines.clear();
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; x += lanes) {
            const std::size_t at = y * Stride + x, count = std::min(lanes, width - x);
            Walk walk(starts, at, ends, at + to_end, count, work, density);
            reserve_lines(walk.num_pieces(), pieces);
            const std::size_t first = pieces.size;
            for (std::size_t i = 0; i < walk.num_pieces(); ++i, pieces.size += lanes)
                walk.next({&pieces.cells[pieces.size], &pieces.of_left[pieces.size],
                           &pieces.of_change[pieces.size], &pieces.of_density[pieces.size]});
            sum_lines(pieces, first, pieces.size, count, work, sums.data() + at);
            if (keeps_pieces)
                pieces.num_lines.push_back(walk.num_pieces());
            else
                pieces.size = 0;
        }
}

void sum_edges(std::size_t width, std::size_t height, const Work::Pieces& pieces, const Work& work,
               Work::Sums& sums) {
    const std::size_t lanes = hn::Lanes(Lanes());
    std::size_t first = 0;
    const std::size_t* num_lines = pieces.num_lines.data();
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; x += lanes) {
            const std::size_t end = first + *num_lines++ * lanes;
            sum_lines(pieces, first, end, std::min(lanes, width - x), work,
                      sums.data() + y * Stride + x);
            first = end;
        }
}

/// What the faces so far give to a texel of a pair, some of the sums.
HWY_INLINE hn::Vec<SumLanes> texel_sum(const Work& work, const Work::Pair& pair, std::size_t at,
                                       std::size_t lane) {
    // What rounding leaves of sums that cancel.
    constexpr double Rounding = 4e-15;
    const SumLanes ds;
    const auto top = hn::Load(ds, work.of_across[at].data() + lane);
    const auto right = hn::Load(ds, work.of_down[at + 1].data() + lane);
    const auto bottom = hn::Load(ds, work.of_across[at + Stride].data() + lane);
    const auto left = hn::Load(ds, work.of_down[at].data() + lane);
    const auto sum = hn::Sub(hn::Add(top, right), hn::Add(bottom, left));
    const auto size =
        hn::Add(hn::Add(hn::Abs(top), hn::Abs(right)), hn::Add(hn::Abs(bottom), hn::Abs(left)));
    const auto is_sum = hn::Gt(hn::Abs(sum), hn::Mul(size, hn::Set(ds, Rounding)));
    const auto kept = hn::IfThenElseZero(is_sum, sum);
    return work.is_first ? kept : hn::Add(hn::Load(ds, pair.texels[at].data() + lane), kept);
}

void add_texels(const Work& work, Work::Pair& pair) {
    for (std::size_t y = 0; y < work.height; ++y)
        for (std::size_t x = 0; x < work.width; ++x) {
            const std::size_t at = y * Stride + x;
            for (std::size_t lane = 0; lane < NumSums; lane += Step)
                hn::Store(texel_sum(work, pair, at, lane), SumLanes(),
                          pair.texels[at].data() + lane);
        }
}

void store_means(const Work& work, const Work::Pair& pair, const TexelPair<glm::vec3>& tiles) {
    const SumLanes ds;
    const hn::Rebind<float, SumLanes> narrow;
    for (std::size_t y = 0; y < work.height; ++y)
        for (std::size_t x = 0; x < work.width; ++x) {
            hn::Vec<SumLanes> sums[NumVectors];
            HWY_ALIGN Work::Sum sum;
            for (std::size_t j = 0; j < NumVectors; ++j) {
                sums[j] = texel_sum(work, pair, y * Stride + x, j * Step);
                hn::Store(sums[j], ds, sum.data() + j * Step);
            }
            const auto scale = hn::Set(ds, 1.0 / sum[3]); // both sides have the same solid angle
            HWY_ALIGN std::array<float, NumSums> means;
            for (std::size_t j = 0; j < NumVectors; ++j) {
                const auto least = hn::Load(narrow, pair.least.data() + j * Step);
                hn::Store(hn::Max(hn::DemoteTo(narrow, hn::Mul(scale, sums[j])), least), narrow,
                          means.data() + j * Step);
            }
            for (std::size_t side = 0; side < Work::NumSides; ++side) {
                const float* mean = means.data() + side * Work::NumValues;
                *tiles[side].at(static_cast<std::ptrdiff_t>(x),
                                static_cast<std::ptrdiff_t>(y)) = {mean[0], mean[1], mean[2]};
            }
        }
}

} // namespace relumine::cubemap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::cubemap {

namespace {
HWY_EXPORT(place_corners);
HWY_EXPORT(find_columns);
HWY_EXPORT(fill_cells);
HWY_EXPORT(find_cells);
HWY_EXPORT(walk_edges);
HWY_EXPORT(sum_edges);
HWY_EXPORT(add_texels);
HWY_EXPORT(store_means);
} // namespace

void place_corners(const TilePlace& place, TileWork& work) {
    HWY_DYNAMIC_DISPATCH(place_corners)(place, work);
}

void find_columns(const TexelPair<const glm::vec3>& first, TileWork& work) {
    HWY_DYNAMIC_DISPATCH(find_columns)(first, work);
}

void fill_cells(const TexelPair<const glm::vec3>& faces, const TexelPair<const glm::vec3>* next,
                TileWork& work, TileWork::Pair& pair) {
    HWY_DYNAMIC_DISPATCH(fill_cells)(faces, next, work, pair);
}

void find_cells(std::size_t num_rows, const TileWork& work, TileWork::Points& points) {
    HWY_DYNAMIC_DISPATCH(find_cells)(num_rows, work, points);
}

void walk_edges(std::size_t width, std::size_t height, const TileWork::Points& starts,
                const TileWork::Points& ends, std::size_t to_end, const TileWork& work,
                TileWork::Pieces& pieces, TileWork::Sums& sums) {
    HWY_DYNAMIC_DISPATCH(walk_edges)(width, height, starts, ends, to_end, work, pieces, sums);
}

void sum_edges(std::size_t width, std::size_t height, const TileWork::Pieces& pieces,
               const TileWork& work, TileWork::Sums& sums) {
    HWY_DYNAMIC_DISPATCH(sum_edges)(width, height, pieces, work, sums);
}

void add_texels(const TileWork& work, TileWork::Pair& pair) {
    HWY_DYNAMIC_DISPATCH(add_texels)(work, pair);
}

void store_means(const TileWork& work, const TileWork::Pair& pair,
                 const TexelPair<glm::vec3>& tiles) {
    HWY_DYNAMIC_DISPATCH(store_means)(work, pair, tiles);
}

} // namespace relumine::cubemap
#endif // HWY_ONCE
