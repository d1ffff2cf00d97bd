// Cuts a polygon of the plane along the lines of an axis-parallel grid.
//
// Polygons need not be convex. A piece may then have seams without area along a grid line; an
// integral over the piece does not see such a seam. Buffers are kept between calls, so cutting
// millions of polygons allocates nothing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

namespace relumine::cubemap {

using Polygon = std::vector<glm::dvec2>;

/// Returns the area of a polygon. The area is positive if the polygon runs clockwise with y
/// pointing down.
[[nodiscard]] inline double area(const Polygon& polygon) {
    if (polygon.size() < 3)
        return 0.0;
    // Coordinates are relative to the first corner, so small pieces far from the origin keep their
    // digits.
    const glm::dvec2 origin = polygon.front();
    double twice = 0.0;
    glm::dvec2 previous = polygon[1] - origin;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        const glm::dvec2 current = polygon[i] - origin;
        twice += previous.x * current.y - current.x * previous.y;
        previous = current;
    }
    return 0.5 * twice;
}

/// Splits a polygon at the line where coordinate Axis (0: x, 1: y) equals `position`.
template<int Axis>
void split(const Polygon& polygon, double position, Polygon& below, Polygon& above) {
    below.clear();
    above.clear();
    if (polygon.empty())
        return;
    glm::dvec2 previous = polygon.back();
    double previous_height = previous[Axis] - position;
    for (const glm::dvec2& current : polygon) {
        const double height = current[Axis] - position;
        if ((height < 0.0 && previous_height > 0.0) || (height > 0.0 && previous_height < 0.0)) {
            glm::dvec2 crossing =
                previous + (current - previous) * (previous_height / (previous_height - height));
            crossing[Axis] = position;
            below.push_back(crossing);
            above.push_back(crossing);
        }
        if (height <= 0.0)
            below.push_back(current);
        if (height >= 0.0)
            above.push_back(current);
        previous = current;
        previous_height = height;
    }
}

/// The grid lines of one direction. Cell i lies between lines i and i + 1. Lines are any ascending
/// positions. A periodic grid goes on to both sides: its lines repeat, one unit further each time.
class GridLines {
public:
    GridLines(const std::vector<double>& lines, bool periodic)
        : lines_(&lines), num_cells_(static_cast<std::ptrdiff_t>(lines.size()) - 1),
          periodic_(periodic) {}

    [[nodiscard]] double line(std::ptrdiff_t i) const {
        if (!periodic_ || (i >= 0 && i <= num_cells_))
            return (*lines_)[static_cast<std::size_t>(i)];
        const std::ptrdiff_t turn = (i < 0 ? i - num_cells_ + 1 : i) / num_cells_;
        return (*lines_)[static_cast<std::size_t>(i - turn * num_cells_)] +
               static_cast<double>(turn);
    }

    /// Returns the cell that holds a position. A position on a line belongs to the cell after the
    /// line. A position outside a grid that is not periodic belongs to the outermost cell. The
    /// search starts at the cell found last, because neighbouring polygons follow each other.
    [[nodiscard]] std::ptrdiff_t cell(double position) {
        while ((periodic_ || last_ > 0) && position < line(last_))
            --last_;
        while ((periodic_ || last_ < num_cells_ - 1) && position >= line(last_ + 1))
            ++last_;
        return last_;
    }

    /// Returns the cell's number within [0, num_cells).
    [[nodiscard]] std::size_t wrapped(std::ptrdiff_t i) const {
        const std::ptrdiff_t rest = i % num_cells_;
        return static_cast<std::size_t>(rest < 0 ? rest + num_cells_ : rest);
    }

private:
    const std::vector<double>* lines_;
    std::ptrdiff_t num_cells_;
    bool periodic_;
    std::ptrdiff_t last_ = 0;
};

/// Grid lines at the whole numbers 0 ... num_cells.
class UnitLines {
public:
    explicit UnitLines(std::size_t num_cells)
        : last_cell_(static_cast<std::ptrdiff_t>(num_cells) - 1) {}
    [[nodiscard]] static double line(std::ptrdiff_t i) { return static_cast<double>(i); }
    [[nodiscard]] std::ptrdiff_t cell(double position) const {
        return std::clamp(static_cast<std::ptrdiff_t>(position), std::ptrdiff_t{0}, last_cell_);
    }
    [[nodiscard]] static std::size_t wrapped(std::ptrdiff_t i) {
        return static_cast<std::size_t>(i);
    }

private:
    std::ptrdiff_t last_cell_;
};

/// Cuts polygons along the lines of a grid.
class GridCutter {
public:
    /// Calls `visit(column, row, piece)` for every cell of the grid that the polygon meets. The
    /// polygon's content is lost.
    template<typename Columns, typename Rows, typename Visit>
    void cut(Polygon& polygon, Columns& columns, Rows& rows, const Visit& visit) {
        if (polygon.empty())
            return;
        const auto [left, right] = range<0>(polygon);
        const std::ptrdiff_t last_column = columns.cell(right);
        for (std::ptrdiff_t column = columns.cell(left); column < last_column; ++column) {
            split<0>(polygon, columns.line(column + 1), strip_, rest_);
            cut_strip(strip_, columns.wrapped(column), rows, visit);
            std::swap(polygon, rest_);
        }
        cut_strip(polygon, columns.wrapped(last_column), rows, visit);
    }

private:
    template<int Axis>
    [[nodiscard]] static std::pair<double, double> range(const Polygon& polygon) {
        double low = polygon.front()[Axis], high = low;
        for (const glm::dvec2& point : polygon) {
            low = std::min(low, point[Axis]);
            high = std::max(high, point[Axis]);
        }
        return {low, high};
    }

    template<typename Rows, typename Visit>
    void cut_strip(Polygon& strip, std::size_t column, Rows& rows, const Visit& visit) {
        if (strip.size() < 3)
            return;
        const auto [top, bottom] = range<1>(strip);
        const std::ptrdiff_t last_row = rows.cell(bottom);
        for (std::ptrdiff_t row = rows.cell(top); row < last_row; ++row) {
            split<1>(strip, rows.line(row + 1), piece_, strip_rest_);
            visit(column, rows.wrapped(row), std::as_const(piece_));
            std::swap(strip, strip_rest_);
        }
        visit(column, rows.wrapped(last_row), std::as_const(strip));
    }

    Polygon strip_, rest_, piece_, strip_rest_;
};

} // namespace relumine::cubemap
