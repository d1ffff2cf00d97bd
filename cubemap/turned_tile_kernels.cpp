#include "cubemap/turned_tile_kernels.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include <glm/common.hpp>
#include <glm/vec4.hpp>
#include <hwy/cache_control.h>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cubemap/turned_tile_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cubemap/turned_density-inl.h"
#include "files/wasm_doubles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::cubemap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Work = TileWork;
using Points = Work::Points;
using Cell = Work::Cell;
using Faces = TexelPair<const glm::vec3>;
constexpr std::size_t Stride = Work::Stride;

using IntLanes = hn::RebindToSigned<Lanes>;
using Doubles = hn::CappedTag<double, MaxLanes / 2>;
using SumLanes = hn::CappedTag<double, Work::NumSums>;
constexpr std::size_t NumSums = Work::NumSums;
/// 1 where a sum is of solid angle.
HWY_ALIGN constexpr std::array<float, NumSums> IsAngle = {0.0f, 0.0f, 0.0f, 1.0f,
                                                          0.0f, 0.0f, 0.0f, 1.0f};

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

void widen(const float* values, std::size_t count, double* to) {
    const Doubles d;
    const hn::Rebind<float, Doubles> narrow;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d))
        hn::StoreU(hn::PromoteTo(d, hn::Load(narrow, values + i)), d, to + i);
}
void store_wide(Vec values, double* to) {
    HWY_ALIGN std::array<float, MaxLanes> narrow;
    hn::Store(values, Lanes(), narrow.data());
    widen(narrow.data(), hn::Lanes(Lanes()), to);
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

/// Of a cell of the part.
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

/// Copies what a row's cells from `begin` to `end` have of both sides. The fourth numbers mean
/// nothing.
void copy_colors(std::int32_t row, std::int32_t begin, std::int32_t end, const Faces& faces,
                 Work& work) {
    const std::int32_t shift = work.shift;
    for (std::size_t side = 0; side < Work::NumSides; ++side) {
        const TexelRows<const glm::vec3> texels = faces[side];
        const glm::vec3* line = texels.at(0, row >> shift);
        const glm::vec3* first = line + (begin >> shift) * texels.next_column;
        // Four numbers are one more than a colour, and a map may end there.
        const glm::vec3* last = std::max(first, line + ((end - 1) >> shift) * texels.next_column);
        float* to = work.colors.data()->values.data() + side * Work::NumValues;
        for (std::int32_t column = begin; column < end; ++column, to += NumSums) {
            const glm::vec3* texel = line + (column >> shift) * texels.next_column;
            std::memcpy(to, texel, texel == last ? sizeof(glm::vec3) : sizeof(glm::vec4));
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
    const auto one = hn::Set(narrow, 1.0f);
    for (std::size_t j = 0; j < NumSums; j += hn::Lanes(ds)) {
        const auto is_angle = hn::Eq(hn::Load(narrow, IsAngle.data() + j), one);
        auto sum = hn::Zero(ds), change_sum = hn::Zero(ds);
        auto least = hn::Load(narrow, pair.least.data() + j);
        const auto light_of = [&](std::size_t i) {
            const auto values =
                hn::IfThenElse(is_angle, one, hn::Load(narrow, colors[i].values.data() + j));
            least = hn::Min(least, values);
            return hn::Mul(hn::PromoteTo(ds, values), hn::Set(ds, middles[i]));
        };
        const auto change_of = [&](std::size_t i) {
            return hn::Set(ds, changes[i]);
        };
        const auto store = [&](std::size_t i, const auto& light) {
            Cell& cell = cells[i];
            hn::Store(sum, ds, cell.left.data() + j);
            hn::Store(change_sum, ds, cell.change_left.data() + j);
            hn::Store(hn::DemoteTo(narrow, light), narrow, cell.density.data() + j);
        };
        if (end == work.num_cells)
            for (std::size_t i = count; i-- > 0;) {
                const auto light = light_of(i);
                sum = hn::NegMulAdd(light, across, sum);
                change_sum = hn::NegMulAdd(light, change_of(i), change_sum);
                store(i, light);
            }
        else
            for (std::size_t i = 0; i < count; ++i) {
                const auto light = light_of(i);
                store(i, light);
                sum = hn::MulAdd(light, across, sum);
                change_sum = hn::MulAdd(light, change_of(i), change_sum);
            }
        hn::Store(least, narrow, pair.least.data() + j);
    }
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

/// Edges, as many as there are lanes, that go from cell to cell.
class Walk {
public:
    /// Of the lanes, only the first `count` go anywhere.
    Walk(const Points& from, std::size_t start, const Points& to, std::size_t end,
         std::size_t count, const Work& work, const Density& density)
        : density_(density), scale_(work.scale), first_column_(static_cast<float>(work.first.x)),
          first_row_(static_cast<float>(work.first.y)),
          num_columns_(static_cast<float>(work.size.x)) {
        const Lanes d;
        const auto is_edge = hn::FirstN(d, count);
        const auto load = [&](const auto& values, std::size_t at) {
            return hn::IfThenElseZero(is_edge, hn::LoadU(d, values.data() + at));
        };
        column_ = load(from.column, start);
        row_ = load(from.row, start);
        x_ = start_x_ = load(from.x, start);
        y_ = start_y_ = load(from.y, start);
        end_column_ = load(to.column, end);
        end_row_ = load(to.row, end);
        const Vec end_x = load(to.x, end);
        end_y_ = load(to.y, end);
        const Vec columns = hn::Sub(end_column_, column_), rows = hn::Sub(end_row_, row_);
        const Vec zero = hn::Zero(d), one = number(1.0f);
        column_step_ = hn::Min(hn::Max(columns, number(-1.0f)), one);
        row_step_ = hn::Min(hn::Max(rows, number(-1.0f)), one);
        side_x_ = hn::Max(column_step_, zero);
        side_y_ = hn::Max(row_step_, zero);
        width_ = hn::Add(columns, hn::Sub(end_x, x_));
        height_ = hn::Add(rows, hn::Sub(end_y_, y_));
        per_column_ = hn::Div(one, hn::Max(hn::Abs(width_), number(Least)));
        per_row_ = hn::Div(one, hn::Max(hn::Abs(height_), number(Least)));
        next_x_ = hn::Mul(hn::Abs(hn::Sub(side_x_, x_)), per_column_);
        next_y_ = hn::Mul(hn::Abs(hn::Sub(side_y_, y_)), per_row_);
        up_to_here_ = density_.up_to(hn::Sub(y_, number(0.5f)));
        num_pieces_ = 1 + static_cast<std::size_t>(hn::GetLane(
                              hn::MaxOfLanes(d, hn::Add(hn::Abs(columns), hn::Abs(rows)))));
    }

    /// The largest number of cells that an edge meets.
    [[nodiscard]] std::size_t num_pieces() const { return num_pieces_; }

    /// Where the line of the next pieces goes, as in TileWork::Pieces.
    struct Line {
        std::int32_t* cells;
        double *of_left, *of_change;
        float* of_density;
    };
    void next(const Line& line) {
        const Lanes d;
        const Vec zero = hn::Zero(d), half = number(0.5f), one = number(1.0f), last = number(2.0f);
        const auto has_columns = hn::Ne(column_, end_column_);
        const auto has_rows = hn::Ne(row_, end_row_);
        // Rounding neither makes an edge longer nor lets it miss a cell.
        const Vec until_x = hn::IfThenElse(has_columns, hn::Min(next_x_, one), last);
        const Vec until_y = hn::IfThenElse(has_rows, hn::Min(next_y_, one), last);
        const auto goes_across = hn::And(has_columns, hn::Le(until_x, until_y));
        const auto goes_down = hn::AndNot(goes_across, has_rows);
        const Vec until = hn::Min(hn::Min(until_x, until_y), one);
        const Vec x_there = hn::Min(hn::Max(hn::MulAdd(until, width_, start_x_), zero), one);
        const Vec y_there = hn::Sub(
            hn::Add(hn::Min(hn::Max(hn::MulAdd(until, height_, start_y_), zero), one), one), one);
        const Vec x = hn::IfThenElse(goes_across, side_x_, x_there);
        const Vec y =
            hn::IfThenElse(goes_across, y_there, hn::IfThenElse(goes_down, side_y_, end_y_));
        const Vec height = hn::Sub(y, y_);
        const Density::Slopes slopes =
            density_.slopes(middle(column_, scale_), middle(row_, scale_));
        const Vec in_cell = hn::Mul(
            height, density_.mean_left_of(slopes, hn::MulSub(half, hn::Add(x, x_), half),
                                          hn::MulSub(half, hn::Add(y, y_), half),
                                          hn::Mul(half, hn::Sub(x, x_)), hn::Mul(half, height)));
        const Density::Heights up_to = density_.up_to(hn::Sub(y, half));
        const Vec cell = hn::MulAdd(hn::Sub(row_, number(first_row_)), number(num_columns_),
                                    hn::Sub(column_, number(first_column_)));
        hn::StoreU(hn::ConvertTo(IntLanes(), cell), IntLanes(), line.cells);
        store_wide(hn::Add(height, hn::Sub(up_to.density, up_to_here_.density)), line.of_left);
        store_wide(hn::Sub(up_to.change, up_to_here_.change), line.of_change);
        hn::StoreU(in_cell, d, line.of_density);
        // On to the next cell.
        const Vec columns = hn::IfThenElseZero(goes_across, column_step_);
        const Vec rows = hn::IfThenElseZero(goes_down, row_step_);
        column_ = hn::Add(column_, columns);
        row_ = hn::Add(row_, rows);
        start_x_ = hn::Sub(start_x_, columns);
        start_y_ = hn::Sub(start_y_, rows);
        x_ = hn::Sub(x, columns);
        y_ = hn::Sub(y, rows);
        up_to_here_.change = up_to.change; // the same at both sides of a row
        up_to_here_.density =
            hn::IfThenElse(goes_down, density_.up_to(hn::Sub(y_, half)).density, up_to.density);
        next_x_ = hn::Add(next_x_, hn::IfThenElseZero(goes_across, per_column_));
        next_y_ = hn::Add(next_y_, hn::IfThenElseZero(goes_down, per_row_));
    }

private:
    static constexpr float Least = 1e-30f;

    const Density& density_;
    float scale_, first_column_, first_row_, num_columns_;
    /// Where the edges begin, from the upper left corner of the cells where they are.
    Vec start_x_, start_y_;
    /// Where they end.
    Vec end_column_, end_row_, end_y_;
    Vec width_, height_;
    /// Parts of the edge until the next column and row, and for each one more.
    Vec next_x_, next_y_, per_column_, per_row_;
    /// The cells where they are, the place where they came in, and the sides they go to.
    Vec column_, row_, column_step_, row_step_, x_, y_, side_x_, side_y_;
    Density::Heights up_to_here_;
    std::size_t num_pieces_;
};

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
    constexpr std::size_t Step = hn::MaxLanes(SumLanes()), NumVectors = NumSums / Step,
                          NarrowStep = hn::MaxLanes(NarrowLanes()),
                          NumNarrow = NumSums / NarrowStep;
    const SumLanes ds;
    const NarrowLanes narrow;
    const std::size_t lanes = hn::Lanes(Lanes());
    const Cell* cells = work.cells.data();
    const std::int32_t* indices = pieces.cells.data();
    const double *of_left = pieces.of_left.data(), *of_change = pieces.of_change.data();
    const float* of_density = pieces.of_density.data();
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
                sum[j] = hn::MulAdd(hn::Set(ds, of_change[k]),
                                    hn::Load(ds, cell.change_left.data() + j * Step), sum[j]);
            }
            for (std::size_t j = 0; j < NumNarrow; ++j)
                of_texels[j] = hn::MulAdd(hn::Set(narrow, of_density[k]),
                                          hn::Load(narrow, cell.density.data() + j * NarrowStep),
                                          of_texels[j]);
        }
        HWY_ALIGN std::array<float, NumSums> in_texels;
        for (std::size_t j = 0; j < NumNarrow; ++j)
            hn::Store(of_texels[j], narrow, in_texels.data() + j * NarrowStep);
        for (std::size_t j = 0; j < NumVectors; ++j) {
            const auto wide = hn::PromoteTo(
                ds, hn::Load(hn::Rebind<float, SumLanes>(), in_texels.data() + j * Step));
            hn::Store(hn::Add(sum[j], wide), ds, sums[i].data() + j * Step);
        }
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

void add_texels(const Work& work, Work::Pair& pair) {
    // What rounding leaves of sums that cancel.
    constexpr double Rounding = 4e-15;
    const SumLanes ds;
    for (std::size_t y = 0; y < work.height; ++y)
        for (std::size_t x = 0; x < work.width; ++x) {
            const std::size_t at = y * Stride + x;
            for (std::size_t j = 0; j < NumSums; j += hn::Lanes(ds)) {
                const auto top = hn::Load(ds, work.of_across[at].data() + j);
                const auto right = hn::Load(ds, work.of_down[at + 1].data() + j);
                const auto bottom = hn::Load(ds, work.of_across[at + Stride].data() + j);
                const auto left = hn::Load(ds, work.of_down[at].data() + j);
                const auto sum = hn::Sub(hn::Add(top, right), hn::Add(bottom, left));
                const auto size = hn::Add(hn::Add(hn::Abs(top), hn::Abs(right)),
                                          hn::Add(hn::Abs(bottom), hn::Abs(left)));
                const auto is_sum = hn::Gt(hn::Abs(sum), hn::Mul(size, hn::Set(ds, Rounding)));
                double* texel = pair.texels[at].data() + j;
                const auto kept = hn::IfThenElseZero(is_sum, sum);
                hn::Store(work.is_first ? kept : hn::Add(hn::Load(ds, texel), kept), ds, texel);
            }
        }
}

void store_means(const Work& work, const Work::Pair& pair, const TexelPair<glm::vec3>& tiles) {
    const SumLanes ds;
    const hn::Rebind<float, SumLanes> narrow;
    for (std::size_t y = 0; y < work.height; ++y)
        for (std::size_t x = 0; x < work.width; ++x) {
            const Work::Sum& sum = pair.texels[y * Stride + x];
            const auto scale = hn::Set(ds, 1.0 / sum[3]); // both sides have the same solid angle
            HWY_ALIGN std::array<float, NumSums> means;
            for (std::size_t j = 0; j < NumSums; j += hn::Lanes(ds)) {
                const auto exact = hn::Mul(scale, hn::Load(ds, sum.data() + j));
                hn::StoreU(
                    hn::Max(hn::DemoteTo(narrow, exact), hn::LoadU(narrow, pair.least.data() + j)),
                    narrow, means.data() + j);
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
