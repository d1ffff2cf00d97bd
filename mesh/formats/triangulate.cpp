// Ear clipping.
// Based on: G. H. Meisters, "Polygons have ears", 1975. Only reflex corners are tested against the
// closed triangle, as in Eberly, "Triangulation by ear clipping", 2002.
//
// Debian has no suitable library: mapbox's earcut comes for Python alone, and GLU's tessellator
// adds vertices of its own.
#include "mesh/formats/triangulate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace relumine::mesh {

namespace {

/// Returns twice the signed area of a, b, c; positive counter-clockwise.
double turn_of(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

} // namespace

/// Drops the axis along which the polygon's Newell normal is longest, so coordinates stay exact.
/// Orients the result counter-clockwise. Returns false for a polygon without area.
bool Triangulator::project(std::span<const std::uint32_t> polygon) {
    // Coordinates are relative to the first corner. Otherwise the normal of a small polygon far
    // from the origin would be lost in rounding.
    const glm::dvec3 origin(positions_[polygon[0]]);
    glm::dvec3 normal(0.0);
    for (std::size_t i = 0; i < polygon.size(); ++i)
        normal += glm::cross(glm::dvec3(positions_[polygon[i]]) - origin,
                             glm::dvec3(positions_[polygon[(i + 1) % polygon.size()]]) - origin);
    int axis = std::abs(normal.x) >= std::abs(normal.y) ? 0 : 1;
    if (std::abs(normal.z) > std::abs(normal[axis]))
        axis = 2;
    if (!(std::abs(normal[axis]) > 0.0))
        return false;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0.0)
        std::swap(u, v);

    const auto n = static_cast<std::uint32_t>(polygon.size());
    corners_.resize(n);
    for (std::uint32_t i = 0; i < n; ++i) {
        const glm::vec3& position = positions_[polygon[i]];
        corners_[i] = {
            {position[u], position[v]}, i == 0 ? n - 1 : i - 1, i + 1 == n ? 0 : i + 1, false};
    }
    return true;
}

void Triangulator::find_reflex_corners() {
    reflex_.clear();
    for (std::uint32_t i = 0; i < corners_.size(); ++i)
        if (turn(i) <= 0.0)
            reflex_.push_back({corners_[i].point, i});
    std::sort(reflex_.begin(), reflex_.end(), [](const ReflexCorner& a, const ReflexCorner& b) {
        return std::pair(a.point.x, a.corner) < std::pair(b.point.x, b.corner);
    });
}

/// A cut removes reflex corners or makes them convex. A convex corner never becomes reflex again.
void Triangulator::drop_reflex_corners_out_of_date() {
    std::erase_if(reflex_, [this](const ReflexCorner& reflex) {
        return corners_[reflex.corner].clipped || turn(reflex.corner) > 0.0;
    });
}

double Triangulator::turn(std::uint32_t corner) const {
    const Corner& c = corners_[corner];
    return turn_of(corners_[c.previous].point, c.point, corners_[c.next].point);
}

bool Triangulator::is_ear(std::uint32_t corner, Ear kind) {
    work_left_ -= 1.0;
    const double area = turn(corner);
    if (kind != Ear::Empty)
        return kind == Ear::Any || area == 0.0;
    if (!(area > 0.0))
        return false;

    // An ear holds no other corner. If there are corners in the triangle, one of them is reflex. A
    // corner at the same place as a corner of the triangle is the end of a doubled edge that passes
    // the triangle by.
    const glm::dvec2 a = corners_[corners_[corner].previous].point;
    const glm::dvec2 b = corners_[corner].point;
    const glm::dvec2 c = corners_[corners_[corner].next].point;
    const double min_x = std::min({a.x, b.x, c.x}), max_x = std::max({a.x, b.x, c.x});
    const double min_y = std::min({a.y, b.y, c.y}), max_y = std::max({a.y, b.y, c.y});
    const auto begin =
        std::lower_bound(reflex_.begin(), reflex_.end(), min_x,
                         [](const ReflexCorner& reflex, double x) { return reflex.point.x < x; });
    for (auto it = begin; it != reflex_.end() && it->point.x <= max_x; ++it) {
        work_left_ -= 1.0;
        const glm::dvec2 p = it->point;
        if (p.y < min_y || p.y > max_y || p == a || p == b || p == c)
            continue;
        if (turn_of(a, b, p) >= 0.0 && turn_of(b, c, p) >= 0.0 && turn_of(c, a, p) >= 0.0 &&
            !corners_[it->corner].clipped && turn(it->corner) <= 0.0)
            return false;
    }
    return true;
}

void Triangulator::append(std::span<const std::uint32_t> polygon,
                          std::vector<Triangle>& triangles) {
    const std::size_t first = triangles.size();
    cut(polygon, triangles);
    for (std::size_t i = first; i < triangles.size(); ++i)
        for (std::uint32_t& corner : triangles[i])
            corner = polygon[corner];
}

void Triangulator::cut(std::span<const std::uint32_t> polygon,
                       std::vector<std::array<std::uint32_t, 3>>& triangles) {
    if (polygon.size() == 3 || !project(polygon)) {
        for (std::uint32_t i = 1; i + 1 < polygon.size(); ++i)
            triangles.push_back({0, i, i + 1});
        return;
    }
    find_reflex_corners();
    // Usual polygons need a few tests per corner. The mesh as a whole may spend many more before it
    // is refused.
    work_left_ += 1000.0 * static_cast<double>(polygon.size());

    // Ears with an area come first, so a corner on a straight edge gets triangles with an area too.
    // A cut can make ears only of its two neighbours. Looking there first keeps long strips with
    // ears at their ends alone from taking O(n^2).
    constexpr std::uint32_t None = std::numeric_limits<std::uint32_t>::max();
    std::size_t num_left = polygon.size();
    std::size_t num_cuts = 0;    // cuts since out-of-date reflex corners were dropped
    std::size_t num_refused = 0; // consecutive corners that are no ear
    std::uint32_t other_neighbour = None;
    Ear kind = Ear::Empty;
    std::uint32_t corner = 1;
    while (num_left > 2) {
        if (work_left_ < 0.0)
            throw std::runtime_error(
                fmt::format("expected polygons that are soon cut into triangles, got "
                            "one of {} corners that takes too long",
                            polygon.size()));
        const std::uint32_t previous = corners_[corner].previous;
        const std::uint32_t next = corners_[corner].next;
        if (is_ear(corner, kind)) {
            triangles.push_back({previous, corner, next});
            corners_[previous].next = next;
            corners_[next].previous = previous;
            corners_[corner].clipped = true;
            --num_left;
            if (2 * ++num_cuts > reflex_.size() + 32) {
                drop_reflex_corners_out_of_date();
                num_cuts = 0;
            }
            num_refused = 0;
            kind = Ear::Empty;
            other_neighbour = previous;
            corner = next;
        } else if (other_neighbour != None) {
            corner = std::exchange(other_neighbour, None);
        } else {
            corner = next;
            if (++num_refused == num_left) {
                num_refused = 0;
                kind = kind == Ear::Empty ? Ear::Flat : Ear::Any;
            }
        }
    }
}

} // namespace relumine::mesh
