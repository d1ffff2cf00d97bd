// Cuts polygons into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Cuts polygons of a mesh into triangles by ear clipping, without new vertices. A polygon of n
/// corners gives n - 2 triangles that cover it exactly. Concave polygons are allowed, and holes if
/// doubled edges join them to the outline. Convex polygons become fans. A polygon that crosses
/// itself has no triangulation, but still gives n - 2 triangles.
///
/// Cost:    O(n) for convex polygons, at worst O(n^2) for concave ones.
class Triangulator {
public:
    /// `positions` must outlive the triangulator.
    explicit Triangulator(std::span<const glm::vec3> positions) : positions_(positions) {}

    /// Appends the triangles of one polygon. The polygon has at least three corners, all of them
    /// valid indices. Triangles hold places in `polygon`, so the data of a corner can be found.
    /// Throws:  std::runtime_error for a polygon of many thousand corners that would take minutes
    ///          to cut. Most of these cross themselves.
    void cut(std::span<const std::uint32_t> polygon,
             std::vector<std::array<std::uint32_t, 3>>& triangles);

    /// Appends the same triangles as indices of vertices.
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
    /// The current polygon as a ring.
    std::vector<Corner> corners_;
    /// Corners that are not convex, sorted by point.x. Some entries are out of date.
    std::vector<ReflexCorner> reflex_;
    /// Corner-in-triangle tests that are left before the mesh is refused. One takes about 2 ns.
    double work_left_ = 5e7;
};

} // namespace relumine::mesh
