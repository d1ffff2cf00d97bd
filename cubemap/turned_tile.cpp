#include "cubemap/turned_tile.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace relumine::cubemap {

namespace {

using Work = TileWork;

// Cells along a side of a face, at least. Over larger ones the density of solid angle curves more
// than second order says.
constexpr std::uint32_t LeastCells = 256;

/// A point of the face by itself, as the kernels find those of corners.
void set_point(const glm::dvec2& position, const Work& work, std::size_t at, Work::Points& points) {
    const auto cell = [&](double p) {
        return static_cast<float>(std::clamp(static_cast<std::int32_t>(p), 0, work.num_cells - 1));
    };
    const auto place = [](double p, float of) {
        const auto exact = static_cast<float>(p - double{of});
        return (exact + 1.0f) - 1.0f;
    };
    points.column[at] = cell(position.x);
    points.row[at] = cell(position.y);
    points.x[at] = place(position.x, points.column[at]);
    points.y[at] = place(position.y, points.row[at]);
}

/// Keeps the part of an edge between 0 and n along an axis. Returns whether there is any.
bool cut(glm::dvec2& a, glm::dvec2& b, int axis, double n) {
    if (std::max(a[axis], b[axis]) <= 0.0 || std::min(a[axis], b[axis]) >= n)
        return false;
    const glm::dvec2 step = b - a, start = a;
    for (glm::dvec2* end : {&a, &b}) {
        const double side = std::clamp((*end)[axis], 0.0, n);
        if (side == (*end)[axis])
            continue;
        *end = start + step * ((side - start[axis]) / step[axis]);
        (*end)[axis] = side;
    }
    return true;
}

/// Of the edges of width x height corners, each to the corner `next` further on, sets the ends of
/// what lies on the face. Edges beside it become points.
void cut_edges(std::size_t width, std::size_t height, std::size_t next, Work& work) {
    const double n = work.num_cells;
    const auto is_inside = [&](std::size_t at) {
        return work.x[at] >= 0.0 && work.x[at] <= n && work.y[at] >= 0.0 && work.y[at] <= n;
    };
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t at = y * Work::Stride + x;
            const auto copy = [&](std::size_t from, Work::Points& points) {
                points.column[at] = work.corners.column[from];
                points.row[at] = work.corners.row[from];
                points.x[at] = work.corners.x[from];
                points.y[at] = work.corners.y[from];
            };
            const bool starts_inside = is_inside(at), ends_inside = is_inside(at + next);
            glm::dvec2 a(work.x[at], work.y[at]), b(work.x[at + next], work.y[at + next]);
            if (!(starts_inside && ends_inside) && !(cut(a, b, 0, n) && cut(a, b, 1, n))) {
                copy(at, work.starts);
                copy(at, work.ends);
                continue;
            }
            if (starts_inside)
                copy(at, work.starts);
            else
                set_point(a, work, at, work.starts);
            if (ends_inside)
                copy(at + next, work.ends);
            else
                set_point(b, work, at, work.ends);
        }
}

/// Sets the part of the face that the tile meets.
void find_part(Work& work) {
    // A tile's outermost corners have the bounds of all.
    const std::size_t lower = work.height * Work::Stride;
    const double n = work.num_cells;
    glm::dvec2 least(n), most(0.0);
    for (const std::size_t at :
         {std::size_t{0}, std::size_t{work.width}, lower, lower + work.width}) {
        least = glm::min(least, glm::dvec2(work.x[at], work.y[at]));
        most = glm::max(most, glm::dvec2(work.x[at], work.y[at]));
    }
    work.is_cut = least.x < 0.0 || least.y < 0.0 || most.x > n || most.y > n;
    const auto cell = [&](const glm::dvec2& p) {
        return glm::clamp(glm::ivec2(glm::floor(p)), 0, work.num_cells - 1);
    };
    work.first = cell(least - Work::Margin);
    work.size = cell(most + Work::Margin) + 1 - work.first;
    const auto num_cells =
        static_cast<std::size_t>(work.size.x) * static_cast<std::size_t>(work.size.y);
    if (work.cells.size() < num_cells)
        work.cells.resize(num_cells);
    // Kernels write whole vectors.
    const std::size_t most_columns = static_cast<std::size_t>(work.size.x) + Work::Stride;
    if (work.middles.size() < most_columns) {
        work.middles.resize(most_columns);
        work.changes.resize(most_columns);
    }
}

} // namespace

void TurnedTile::begin(std::uint32_t width, std::uint32_t height) {
    work_->width = width;
    work_->height = height;
    work_->is_first = true;
    work_->least = {};
}

void TurnedTile::add(const TilePlace& place, const glm::vec3* face, std::uint32_t resolution) {
    Work& work = *work_;
    work.face = face;
    work.resolution = static_cast<std::int32_t>(resolution);
    work.shift = resolution < LeastCells ? 1 : 0;
    work.num_cells = work.resolution << work.shift;
    work.scale = 2.0f / static_cast<float>(work.num_cells);
    place_corners(place, work);
    find_part(work);
    fill_cells(work);
    if (work.is_cut)
        cut_edges(work.width, work.height + 1, 1, work);
    sum_across(work);
    if (work.is_cut)
        cut_edges(work.width + 1, work.height, Work::Stride, work);
    sum_down(work);
    add_texels(work);
    work.is_first = false;
}

void TurnedTile::store(glm::vec3* texels, std::size_t stride) const {
    store_means(*work_, texels, stride);
}

} // namespace relumine::cubemap
