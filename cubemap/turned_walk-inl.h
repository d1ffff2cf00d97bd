// Edges of a tile of a turned map, on their way from cell to cell. Compiled once per instruction
// set, inside a Highway block.
#if defined(RELUMINE_CUBEMAP_TURNED_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_CUBEMAP_TURNED_WALK_INL_H
#undef RELUMINE_CUBEMAP_TURNED_WALK_INL_H
#else
#define RELUMINE_CUBEMAP_TURNED_WALK_INL_H
#endif

#include <array>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "cubemap/turned_density-inl.h"
#include "cubemap/turned_tile_work.h"
#include "files/wasm_doubles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::cubemap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using IntLanes = hn::RebindToSigned<Lanes>;
using Doubles = hn::CappedTag<double, MaxLanes / 2>;

inline void widen(const float* values, std::size_t count, double* to) {
    const Doubles d;
    const hn::Rebind<float, Doubles> narrow;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d))
        hn::StoreU(hn::PromoteTo(d, hn::Load(narrow, values + i)), d, to + i);
}
inline void store_wide(Vec values, double* to) {
    HWY_ALIGN std::array<float, MaxLanes> narrow;
    hn::Store(values, Lanes(), narrow.data());
    widen(narrow.data(), hn::Lanes(Lanes()), to);
}

/// Edges, as many as there are lanes, that go from cell to cell.
class Walk {
public:
    /// Begins the edges of the first `count` lanes. The others go nowhere.
    Walk(const TileWork::Points& from, std::size_t start, const TileWork::Points& to,
         std::size_t end, std::size_t count, const TileWork& work, const Density& density)
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

} // namespace relumine::cubemap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif // toggle
