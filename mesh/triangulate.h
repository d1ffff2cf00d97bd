// Polygons into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Cuts polygons of a mesh into triangles by ear clipping, in the polygon's own vertices: n - 2
/// triangles for n corners, which cover the polygon exactly, also a concave one and one whose holes
/// are joined to its outline by doubled edges. Convex polygons become fans. A polygon that crosses
/// itself has no triangulation and becomes n - 2 triangles all the same. O(n) for convex polygons,
/// O(n^2) for concave ones at worst.
class Triangulator {
public:
    /// `positions` must outlive the triangulator.
    explicit Triangulator(std::span<const glm::vec3> positions) : positions_(positions) {}

    /// Appends the triangles of one polygon of at least three corners, all of them valid indices,
    /// as places in `polygon`: a corner keeps what belongs to it. Throws std::runtime_error for
    /// polygons of many thousand corners (self-crossing ones, above all) that would take minutes to
    /// cut.
    void cut(std::span<const std::uint32_t> polygon,
             std::vector<std::array<std::uint32_t, 3>>& triangles);

    /// The same, as indices of vertices.
    void append(std::span<const std::uint32_t> polygon, std::vector<Triangle>& triangles);

private:
    struct Corner {
        glm::dvec2 point;
        std::uint32_t previous, next;
        bool clipped;
    };
    struct ReflexCorner {
        glm::dvec2 point;
        std::uint32_t corner;
    };
    enum class Ear { Empty, Flat, Any };

    bool project(std::span<const std::uint32_t> polygon);
    void find_reflex_corners();
    void drop_reflex_corners_out_of_date();
    [[nodiscard]] double turn(std::uint32_t corner) const;
    [[nodiscard]] bool is_ear(std::uint32_t corner, Ear kind);

    std::span<const glm::vec3> positions_;
    /// Of the current polygon, a ring
    std::vector<Corner> corners_;
    /// Those that are not convex, sorted by point.x; some are out of date
    std::vector<ReflexCorner> reflex_;
    /// corner-in-triangle tests, some 2 ns each, before the mesh is given up
    double work_left_ = 5e7;
};

} // namespace relumine::mesh
