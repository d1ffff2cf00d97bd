// Overlaps of spherical polygons with the texels of a cube map.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/face.h"
#include "cubemap/grid_cut.h"

namespace relumine::cubemap {

/// Returns the solid angle of a polygon on a face, given in coordinates [-1, 1]^2. The integral
/// takes the density (1 + u^2 + v^2)^(-3/2) to second order about `centre`. The expansion is
/// additive: pieces of one cell add up to the cell if all use the cell's centre.
///
/// Error:   relative, below (distance from centre)^3 / 2 for a piece and far less for a whole cell.
[[nodiscard]] inline double solid_angle_about(const glm::dvec2& centre, const Polygon& polygon) {
    if (polygon.size() < 3)
        return 0.0;
    double moment = 0.0, moment_x = 0.0, moment_y = 0.0, moment_xx = 0.0, moment_xy = 0.0,
           moment_yy = 0.0;
    glm::dvec2 a = polygon.back() - centre;
    for (const glm::dvec2& corner : polygon) {
        const glm::dvec2 b = corner - centre;
        const double cross = a.x * b.y - b.x * a.y;
        moment += cross;
        moment_x += (a.x + b.x) * cross;
        moment_y += (a.y + b.y) * cross;
        moment_xx += (a.x * a.x + a.x * b.x + b.x * b.x) * cross;
        moment_xy += (a.x * b.y + 2.0 * (a.x * a.y + b.x * b.y) + b.x * a.y) * cross;
        moment_yy += (a.y * a.y + a.y * b.y + b.y * b.y) * cross;
        a = b;
    }
    const double inverse = 1.0 / (1.0 + glm::dot(centre, centre));
    const double density = inverse * std::sqrt(inverse);
    const double slope = -3.0 * inverse,
                 bend = 15.0 * inverse * inverse; // factors of u, v and their products
    return density * (moment / 2.0 + slope * (centre.x * moment_x + centre.y * moment_y) / 6.0 +
                      ((slope + bend * centre.x * centre.x) * moment_xx +
                       (slope + bend * centre.y * centre.y) * moment_yy +
                       bend * centre.x * centre.y * moment_xy) /
                          24.0);
}

/// Finds the texels under a spherical polygon.
///
/// Threads: use one object per thread; it keeps its buffers.
class TexelOverlaps {
public:
    // Solid angles of pieces have an error of 3e-7 in cells of 1/128 of a face. No caller needs
    // finer cells.
    static constexpr std::uint32_t FinestCell = 128;

    explicit TexelOverlaps(std::uint32_t resolution)
        : cells_per_texel_((FinestCell + resolution - 1) / resolution),
          num_cells_(resolution * cells_per_texel_) {}

    /// Calls `visit(face, x, y, solid_angle)` for the texels that the polygon overlaps; a texel may
    /// come more than once. Corners are directions of any length, clockwise seen from the centre of
    /// the sphere and within a half-sphere. Edges are great circles.
    template<typename Visit>
    void find(std::span<const glm::dvec3> corners, const Visit& visit) {
        const Face first = face_point(corners.front()).face;
        bool one_face = true;
        for (const glm::dvec3& corner : corners)
            one_face = one_face && face_point(corner).face == first;
        if (one_face) {
            clipped_.assign(corners.begin(), corners.end());
            cut(first, visit);
            return;
        }
        for (const Face face : AllFaces) {
            clip(corners, face);
            if (clipped_.size() >= 3)
                cut(face, visit);
        }
    }

private:
    /// Puts the polygon's part inside the pyramid of a face into clipped_.
    void clip(std::span<const glm::dvec3> corners, Face face) {
        const auto [right, down, out] = FaceAxes(face);
        const std::array<glm::dvec3, 4> planes = {out - right, out + right, out - down, out + down};
        clipped_.assign(corners.begin(), corners.end());
        for (const glm::dvec3& plane : planes) {
            kept_.clear();
            if (clipped_.empty())
                return;
            glm::dvec3 previous = clipped_.back();
            double previous_height = glm::dot(plane, previous);
            for (const glm::dvec3& current : clipped_) {
                const double height = glm::dot(plane, current);
                if ((height < 0.0 && previous_height > 0.0) ||
                    (height > 0.0 && previous_height < 0.0))
                    kept_.push_back(previous + (current - previous) *
                                                   (previous_height / (previous_height - height)));
                if (height >= 0.0)
                    kept_.push_back(current);
                previous = current;
                previous_height = height;
            }
            std::swap(clipped_, kept_);
        }
    }

    template<typename Visit>
    void cut(Face face, const Visit& visit) {
        const FaceAxes axes(face);
        const double n = num_cells_;
        polygon_.clear();
        for (const glm::dvec3& corner : clipped_) {
            const glm::dvec3 parts = axes.parts(corner);
            if (!(parts.z > 0.0))
                return; // the part is the origin alone
            polygon_.emplace_back((parts.x / parts.z + 1.0) * 0.5 * n,
                                  (parts.y / parts.z + 1.0) * 0.5 * n);
        }
        UnitLines columns(num_cells_), rows(num_cells_);
        cutter_.cut(polygon_, columns, rows,
                    [&](std::size_t column, std::size_t row, const Polygon& piece) {
                        to_face(piece);
                        const glm::dvec2 centre((2.0 * static_cast<double>(column) + 1.0) / n - 1.0,
                                                (2.0 * static_cast<double>(row) + 1.0) / n - 1.0);
                        const double overlap = solid_angle_about(centre, scaled_);
                        // Rounding may make the area of a sliver negative. With a bright texel,
                        // such an area would make a dark pixel negative.
                        if (overlap > 0.0)
                            visit(face, static_cast<std::uint32_t>(column / cells_per_texel_),
                                  static_cast<std::uint32_t>(row / cells_per_texel_), overlap);
                    });
    }

    /// Converts units of cells to [-1, 1]^2, into scaled_.
    void to_face(const Polygon& piece) {
        scaled_.clear();
        for (const glm::dvec2& point : piece)
            scaled_.push_back(point * (2.0 / num_cells_) - 1.0);
    }

    std::uint32_t cells_per_texel_, num_cells_;
    std::vector<glm::dvec3> clipped_, kept_;
    Polygon polygon_, scaled_;
    GridCutter cutter_;
};

} // namespace relumine::cubemap
