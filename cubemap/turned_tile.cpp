#include "cubemap/turned_tile.h"

#include <algorithm>

#include <glm/common.hpp>

#include "cubemap/turned_tile_kernels.h"

namespace relumine::cubemap {

namespace {

using Work = TileWork;

// Cells along a side of a face, at least. Over larger ones the density of solid angle curves more
// than second order says.
constexpr std::uint32_t LeastCells = 256;

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

/// Sets the ends of the parts of edges that lie on the face. Edges run from width x height corners,
/// each to the corner `next` further on. Edges beside the face become points.
void cut_edges(std::size_t width, std::size_t height, std::size_t next, Work& work) {
    const double n = work.num_cells;
    const auto is_inside = [&](const glm::dvec2& p) {
        return p.x >= 0.0 && p.x <= n && p.y >= 0.0 && p.y <= n;
    };
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t at = y * Work::Stride + x;
            glm::dvec2 a = work.corners.position(at), b = work.corners.position(at + next);
            const bool is_on_face =
                (is_inside(a) && is_inside(b)) || (cut(a, b, 0, n) && cut(a, b, 1, n));
            if (!is_on_face)
                a = b = work.corners.position(at);
            work.starts.set(at, a);
            work.ends.set(at, b);
        }
}

/// Sums along the edges of width x height corners, each to the corner `next` further on.
void walk(std::size_t width, std::size_t height, std::size_t next, Work& work, Work::Pieces& pieces,
          Work::Sums& sums) {
    if (work.is_cut) {
        cut_edges(width, height, next, work);
        find_cells(height, work, work.starts);
        find_cells(height, work, work.ends);
        walk_edges(width, height, work.starts, work.ends, 0, work, pieces, sums);
    } else {
        walk_edges(width, height, work.corners, work.corners, next, work, pieces, sums);
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
        least = glm::min(least, work.corners.position(at));
        most = glm::max(most, work.corners.position(at));
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
    work.colors.resize(std::max(work.colors.size(), static_cast<std::size_t>(work.size.x)));
    // Kernels write whole vectors.
    const std::size_t num_densities = num_cells + Work::Stride;
    if (work.middles.size() < num_densities) {
        work.middles.resize(num_densities);
        work.changes.resize(num_densities);
    }
}

} // namespace

void TurnedTile::begin(std::uint32_t width, std::uint32_t height, std::size_t num_pairs) {
    work_->width = width;
    work_->height = height;
    work_->is_first = true;
    work_->pairs.resize(num_pairs);
    for (Work::Pair& pair : work_->pairs)
        pair.least = {};
}

void TurnedTile::add(const TilePlace& place, std::span<const TexelPair<const glm::vec3>> faces,
                     std::uint32_t resolution, std::span<const TexelPair<glm::vec3>> tiles) {
    Work& work = *work_;
    work.shift = resolution < LeastCells ? 1 : 0;
    work.num_cells = static_cast<std::int32_t>(resolution) << work.shift;
    work.scale = 2.0f / static_cast<float>(work.num_cells);
    place_corners(place, work);
    find_part(work);
    find_columns(faces[0], work);
    if (!work.is_cut)
        find_cells(work.height + 1, work, work.corners);
    const std::size_t width = work.width, height = work.height;
    for (std::size_t i = 0; i < work.pairs.size(); ++i) {
        const bool is_last = i + 1 == work.pairs.size();
        fill_cells(faces[i], is_last ? nullptr : &faces[i + 1], work, work.pairs[i]);
        if (i == 0) {
            walk(width, height + 1, 1, work, work.across, work.of_across);
            walk(width + 1, height, Work::Stride, work, work.down, work.of_down);
        } else {
            sum_edges(width, height + 1, work.across, work, work.of_across);
            sum_edges(width + 1, height, work.down, work, work.of_down);
        }
        if (tiles.empty())
            add_texels(work, work.pairs[i]);
        else
            store_means(work, work.pairs[i], tiles[i]);
    }
    work.is_first = false;
}

} // namespace relumine::cubemap
