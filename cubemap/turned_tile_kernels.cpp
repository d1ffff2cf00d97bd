#include "cubemap/turned_tile_kernels.h"

#include <algorithm>

#include <glm/common.hpp>
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
constexpr std::size_t Stride = Work::Stride;

using IntLanes = hn::RebindToSigned<Lanes>;
using Doubles = hn::CappedTag<double, MaxLanes / 2>;
using SumLanes = hn::CappedTag<double, Work::NumSums>;
constexpr std::size_t NumSums = Work::NumSums;
/// Sums of one side, or a part of them.
using SideLanes = hn::CappedTag<double, Work::NumValues>;

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

/// Writes what a row's cells from `begin` to `end` have at their middles.
void find_densities(std::int32_t row, std::int32_t begin, std::int32_t end, const Density& density,
                    Work& work) {
    const Vec v = middle(number(static_cast<float>(row)), work.scale);
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(Lanes()));
    for (std::int32_t column = begin; column < end; column += lanes) {
        const Vec u = middle(hn::Iota(Lanes(), static_cast<float>(column)), work.scale);
        const Vec inverse = hn::Div(number(1.0f), hn::MulAdd(u, u, hn::MulAdd(v, v, number(1.0f))));
        store_wide(hn::Mul(inverse, hn::Sqrt(inverse)), work.middles.data() + (column - begin));
        const Vec y_slope = hn::Mul(number(-3.0f * work.scale), hn::Mul(inverse, v));
        store_wide(density.change(y_slope), work.changes.data() + (column - begin));
    }
}

/// Fills a row's cells from `begin` to `end`. Sums run from the left; where the part ends at the
/// face's right side, from there, so that what lies outside the face has no part in an edge's sum.
void fill_row(std::int32_t row, std::int32_t begin, std::int32_t end, const Density& density,
              Work& work) {
    find_densities(row, begin, end, density, work);
    Cell* cells = work.cells.data() + std::ptrdiff_t{row - work.first.y} * work.size.x +
                  (begin - work.first.x);
    const bool from_right = end == work.num_cells;
    const std::ptrdiff_t count = end - begin;
    const std::int32_t in_texel = begin - (begin >> work.shift << work.shift);
    const SideLanes ds;
    const hn::Rebind<float, SideLanes> narrow;
    using Sums = hn::Vec<SideLanes>;
    using Light = hn::Vec<decltype(narrow)>;
    constexpr std::size_t Step = hn::MaxLanes(SideLanes()), NumVectors = NumSums / Step;
    const auto side_of = [](std::size_t i) {
        return i * Step / Work::NumValues;
    };
    const auto value_of = [](std::size_t i) {
        return i * Step % Work::NumValues;
    };
    // A vector has four numbers, one more than a colour.
    std::array<TexelRows<const glm::vec3>, Work::NumSides> texels;
    std::array<const glm::vec3*, Work::NumSides> last;
    std::array<std::array<float, Work::NumValues>, Work::NumSides> tail;
    for (std::size_t side = 0; side < Work::NumSides; ++side) {
        texels[side] = work.faces[side];
        texels[side].first = texels[side].at(begin >> work.shift, row >> work.shift);
        last[side] = std::max(texels[side].at(0, 0),
                              texels[side].at((count - 1 + in_texel) >> work.shift, 0));
        tail[side] = {last[side]->x, last[side]->y, last[side]->z, 1.0f};
    }
    const auto across = hn::Set(ds, double{density.across_middle()});
    const auto one = hn::Set(narrow, 1.0f);
    Sums sum[NumVectors], change_sum[NumVectors];
    Light least[NumVectors];
    for (std::size_t i = 0; i < NumVectors; ++i) {
        sum[i] = change_sum[i] = hn::Zero(ds);
        least[i] = hn::LoadU(narrow, work.least.data() + i * Step);
    }
    const auto light_of = [&](std::size_t i, std::ptrdiff_t column, const Sums& density_there) {
        const std::size_t side = side_of(i);
        const glm::vec3* texel = texels[side].at((column + in_texel) >> work.shift, 0);
        const float* color = texel == last[side] ? tail[side].data() : &texel->x;
        const auto is_color = hn::FirstN(narrow, 3 - std::min<std::size_t>(value_of(i), 3));
        const auto values =
            hn::IfThenElse(is_color, hn::LoadU(narrow, color + value_of(i)), one);
        least[i] = hn::Min(least[i], values);
        return hn::Mul(hn::PromoteTo(ds, values), density_there);
    };
    const auto store = [&](std::size_t i, Cell& cell, const Sums& light) {
        hn::Store(sum[i], ds, cell.left.data() + i * Step);
        hn::Store(change_sum[i], ds, cell.change_left.data() + i * Step);
        hn::Store(hn::DemoteTo(narrow, light), narrow, cell.density.data() + i * Step);
    };
    const auto at = [&](const std::vector<double>& values, std::ptrdiff_t column) {
        return hn::Set(ds, values[static_cast<std::size_t>(column)]);
    };
    if (from_right)
        for (std::ptrdiff_t column = count - 1; column >= 0; --column)
            for (std::size_t i = 0; i < NumVectors; ++i) {
                const Sums light = light_of(i, column, at(work.middles, column));
                sum[i] = hn::NegMulAdd(light, across, sum[i]);
                change_sum[i] = hn::NegMulAdd(light, at(work.changes, column), change_sum[i]);
                store(i, cells[column], light);
            }
    else
        for (std::ptrdiff_t column = 0; column < count; ++column)
            for (std::size_t i = 0; i < NumVectors; ++i) {
                const Sums light = light_of(i, column, at(work.middles, column));
                store(i, cells[column], light);
                sum[i] = hn::MulAdd(light, across, sum[i]);
                change_sum[i] = hn::MulAdd(light, at(work.changes, column), change_sum[i]);
            }
    for (std::size_t i = 0; i < NumVectors; ++i)
        hn::StoreU(least[i], narrow, work.least.data() + i * Step);
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

void fill_cells(Work& work) {
    const Density density = density_of(work);
    work.columns.clear();
    // All rows are asked for before the first is needed.
    constexpr std::ptrdiff_t CacheLine = 64 / sizeof(float);
    for (std::int32_t row = work.first.y; row < work.first.y + work.size.y; ++row) {
        const glm::ivec2 columns = columns_in_row(row, work);
        work.columns.push_back(columns);
        for (const TexelRows<const glm::vec3>& face : work.faces) {
            const float* first = &face.at(columns.x >> work.shift, row >> work.shift)->x;
            const float* last = &face.at((columns.y - 1) >> work.shift, row >> work.shift)->x;
            for (const float* at = std::min(first, last); at <= std::max(first, last);
                 at += CacheLine)
                hwy::Prefetch(at);
        }
    }
    for (std::int32_t r = 0; r < work.size.y; ++r) {
        const glm::ivec2 columns = work.columns[static_cast<std::size_t>(r)];
        fill_row(work.first.y + r, columns.x, columns.y, density, work);
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

    /// Of the pieces in the next cells: the cell, and the factors of what it holds.
    struct Pieces {
        std::int32_t* cells;
        float *heights, *changes, *in_cells;
    };
    void next(const Pieces& pieces) {
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
        hn::Store(hn::ConvertTo(IntLanes(), cell), IntLanes(), pieces.cells);
        hn::Store(hn::Add(height, hn::Sub(up_to.density, up_to_here_.density)), d, pieces.heights);
        hn::Store(hn::Sub(up_to.change, up_to_here_.change), d, pieces.changes);
        hn::Store(in_cell, d, pieces.in_cells);
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

/// Sums over the edges from start to end, as many as there are lanes.
void sum_lanes(const Points& from, std::size_t start, const Points& to, std::size_t end,
               std::size_t count, const Work& work, const Density& density, Work::Sum* sums) {
    // As many at once; edges are seldom longer.
    constexpr std::size_t MaxPieces = 8;
    using NarrowLanes = hn::CappedTag<float, NumSums>;
    constexpr std::size_t Step = hn::MaxLanes(SumLanes()), NumVectors = NumSums / Step,
                          NarrowStep = hn::MaxLanes(NarrowLanes()),
                          NumNarrow = NumSums / NarrowStep;
    const SumLanes ds;
    const NarrowLanes narrow;
    const std::size_t lanes = hn::Lanes(Lanes());
    HWY_ALIGN std::array<std::int32_t, MaxPieces * MaxLanes> cells;
    HWY_ALIGN std::array<float, MaxPieces * MaxLanes> heights, changes, in_cells;
    HWY_ALIGN std::array<double, MaxPieces * MaxLanes> wide_heights, wide_changes;
    Walk walk(from, start, to, end, count, work, density);
    for (std::size_t done = 0; done < walk.num_pieces();) {
        const std::size_t num_pieces = std::min(MaxPieces, walk.num_pieces() - done);
        for (std::size_t k = 0; k < num_pieces * lanes; k += lanes)
            walk.next(
                {cells.data() + k, heights.data() + k, changes.data() + k, in_cells.data() + k});
        widen(heights.data(), num_pieces * lanes, wide_heights.data());
        widen(changes.data(), num_pieces * lanes, wide_changes.data());
        for (std::size_t i = 0; i < count; ++i) {
            hn::Vec<SumLanes> sum[NumVectors];
            hn::Vec<NarrowLanes> of_texels[NumNarrow];
            for (std::size_t j = 0; j < NumVectors; ++j)
                sum[j] = done == 0 ? hn::Zero(ds) : hn::Load(ds, sums[i].data() + j * Step);
            for (std::size_t j = 0; j < NumNarrow; ++j)
                of_texels[j] = hn::Zero(narrow);
            for (std::size_t k = i; k < num_pieces * lanes; k += lanes) {
                const Cell& cell = work.cells[static_cast<std::size_t>(cells[k])];
                for (std::size_t j = 0; j < NumVectors; ++j) {
                    sum[j] = hn::MulAdd(hn::Set(ds, wide_heights[k]),
                                        hn::Load(ds, cell.left.data() + j * Step), sum[j]);
                    sum[j] = hn::MulAdd(hn::Set(ds, wide_changes[k]),
                                        hn::Load(ds, cell.change_left.data() + j * Step), sum[j]);
                }
                for (std::size_t j = 0; j < NumNarrow; ++j)
                    of_texels[j] = hn::MulAdd(
                        hn::Set(narrow, in_cells[k]),
                        hn::Load(narrow, cell.density.data() + j * NarrowStep), of_texels[j]);
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
        done += num_pieces;
    }
}

void add_texels(Work& work) {
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
                double* texel = work.texels[at].data() + j;
                const auto kept = hn::IfThenElseZero(is_sum, sum);
                hn::Store(work.is_first ? kept : hn::Add(hn::Load(ds, texel), kept), ds, texel);
            }
        }
}

void store_means(const Work& work,
                 const std::array<TexelRows<glm::vec3>, Work::NumSides>& tiles) {
    const SumLanes ds;
    const hn::Rebind<float, SumLanes> narrow;
    for (std::size_t y = 0; y < work.height; ++y)
        for (std::size_t x = 0; x < work.width; ++x) {
            const Work::Sum& sum = work.texels[y * Stride + x];
            const auto scale = hn::Set(ds, 1.0 / sum[3]); // both sides have the same solid angle
            HWY_ALIGN std::array<float, NumSums> means;
            for (std::size_t j = 0; j < NumSums; j += hn::Lanes(ds)) {
                const auto exact = hn::Mul(scale, hn::Load(ds, sum.data() + j));
                hn::StoreU(
                    hn::Max(hn::DemoteTo(narrow, exact), hn::LoadU(narrow, work.least.data() + j)),
                    narrow, means.data() + j);
            }
            for (std::size_t side = 0; side < Work::NumSides; ++side) {
                const float* mean = means.data() + side * Work::NumValues;
                *tiles[side].at(static_cast<std::ptrdiff_t>(x), static_cast<std::ptrdiff_t>(y)) = {
                    mean[0], mean[1], mean[2]};
            }
        }
}

void sum_edges(std::size_t width, std::size_t height, const Points& starts, const Points& ends,
               std::size_t to_end, const Work& work, Work::Sums& sums) {
    const Density density = density_of(work);
    const std::size_t lanes = hn::Lanes(Lanes());
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; x += lanes) {
            const std::size_t at = y * Stride + x;
            sum_lanes(starts, at, ends, at + to_end, std::min(lanes, width - x), work, density,
                      sums.data() + at);
        }
}

} // namespace relumine::cubemap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::cubemap {

namespace {
HWY_EXPORT(place_corners);
HWY_EXPORT(fill_cells);
HWY_EXPORT(find_cells);
HWY_EXPORT(sum_edges);
HWY_EXPORT(add_texels);
HWY_EXPORT(store_means);
} // namespace

void place_corners(const TilePlace& place, TileWork& work) {
    HWY_DYNAMIC_DISPATCH(place_corners)(place, work);
}

void fill_cells(TileWork& work) {
    HWY_DYNAMIC_DISPATCH(fill_cells)(work);
}

void find_cells(std::size_t num_rows, const TileWork& work, TileWork::Points& points) {
    HWY_DYNAMIC_DISPATCH(find_cells)(num_rows, work, points);
}

void sum_edges(std::size_t width, std::size_t height, const TileWork::Points& starts,
               const TileWork::Points& ends, std::size_t to_end, const TileWork& work,
               TileWork::Sums& sums) {
    HWY_DYNAMIC_DISPATCH(sum_edges)(width, height, starts, ends, to_end, work, sums);
}

void add_texels(TileWork& work) {
    HWY_DYNAMIC_DISPATCH(add_texels)(work);
}

void store_means(const TileWork& work,
                 const std::array<TexelRows<glm::vec3>, TileWork::NumSides>& tiles) {
    HWY_DYNAMIC_DISPATCH(store_means)(work, tiles);
}

} // namespace relumine::cubemap
#endif // HWY_ONCE
