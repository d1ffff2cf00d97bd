#include "prt/receivers/lit_position.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "mesh/edge_uses.h"

namespace relumine::prt {

namespace {

/// Surfaces touch within this part of the bias.
constexpr float Touching = 0.05f;

using Crossing = RayScene::Crossing;

bool has_corner(const Crossing& crossing, const glm::vec3& at) {
    return std::find(crossing.corners.begin(), crossing.corners.end(), at) !=
           crossing.corners.end();
}

/// Whether two triangles are the two sides of a sheet, which may be cut along other diagonals: two
/// corners or more are the same.
bool are_sides_of_one(const Crossing& a, const Crossing& b) {
    return std::count_if(a.corners.begin(), a.corners.end(),
                         [&](const glm::vec3& corner) { return has_corner(b, corner); }) >= 2;
}

/// What lies on a way from a surface.
struct WayOut {
    /// How far the first front is that is not touched
    float nearest = std::numeric_limits<float>::infinity();
    /// The front of another surface lies on the own one.
    bool touches = false;
};

/// Looks from a point of a surface to where its rays would start. `vertex` is the vertex that the
/// point belongs to, or null: surfaces with this corner are its own.
WayOut way_out(const RayScene& rays, const glm::vec3& own, const glm::vec3& origin, float bias,
               const glm::vec3* vertex) {
    const float touching = Touching * bias, length = glm::distance(own, origin);
    if (!(length > 0.0f))
        return {};
    thread_local std::vector<Crossing> crossings;
    rays.crossings(own - touching / length * (origin - own), origin, crossings);
    const auto distance = [&](const Crossing& crossing) {
        return crossing.part * (length + touching) - touching;
    };
    WayOut result;
    for (const Crossing& crossing : crossings) {
        // A way through a back leaves a solid that the point is in.
        if (!crossing.is_front || (vertex != nullptr && has_corner(crossing, *vertex)))
            continue;
        if (distance(crossing) > touching)
            result.nearest = std::min(result.nearest, distance(crossing));
        else
            // The own surface is met from behind. Where it has two sides, the other is no surface
            // before it, and a ray from the other side meets no back.
            result.touches =
                result.touches ||
                (std::any_of(crossings.begin(), crossings.end(),
                             [&](const Crossing& other) {
                                 return !other.is_front && distance(other) <= touching;
                             }) &&
                 std::none_of(crossings.begin(), crossings.end(), [&](const Crossing& other) {
                     return !other.is_front && are_sides_of_one(crossing, other);
                 }));
    }
    return result;
}

/// Returns a point's position: on the smooth surface, or on its own where something stands between
/// the two, and so that its rays start before all other surfaces.
glm::vec3 before_obstacles(const RayScene& rays, const glm::vec3& own, const glm::vec3& smooth,
                           const glm::vec3& normal, float bias, const glm::vec3* vertex = nullptr) {
    // As much room must be left beyond the smooth surface, or the next thing nearly touches it.
    constexpr float Room = 2.0f;
    const glm::vec3 origin = ray_origin(own, normal, bias);
    const glm::vec3 way = ray_origin(smooth, normal, bias) - origin;
    // What is closer than the bias is no obstacle to a point without a way, either.
    const bool leads_away = vertex == nullptr && glm::dot(way, way) > bias * bias;
    const glm::vec3& position = leads_away && rays.occluded(origin, way, Room) ? own : smooth;
    if (!(glm::dot(normal, normal) > 0.0f))
        return position;
    WayOut out = way_out(rays, own, ray_origin(position, normal, bias), bias, vertex);
    const auto is_free = [&] {
        return !out.touches && !std::isfinite(out.nearest);
    };
    if (is_free())
        return position;
    if (position != own)
        out = way_out(rays, own, origin, bias, vertex);
    // What touches another surface has no room before it: it looks from inside of its own solid.
    return is_free()     ? own
           : out.touches ? own - 2.0f * bias * normal
                         : own + (0.5f * out.nearest - bias) * normal;
}

} // namespace

glm::vec3 lit_position(const mesh::TriangleMesh& mesh, const RayScene& rays, const MeshPoint& at,
                       const glm::vec3& normal, float bias) {
    const unsigned sides = sides_at(mesh, at);
    const MeshPoint standing = sides == 0 ? at : off_sides(mesh, at, sides, bias);
    return before_obstacles(rays, value_at(mesh, mesh.positions, standing),
                            smooth_position(mesh, standing), normal, bias);
}

namespace {

/// Returns the sides of triangles where no other triangle of the surface goes on, as sides_at() has
/// them.
std::vector<unsigned> rims(const mesh::TriangleMesh& mesh) {
    std::vector<unsigned> result(mesh.num_triangles(), 0);
    const std::vector<mesh::EdgeUse> uses = mesh::edge_uses(mesh.triangles);
    mesh::for_each_edge(uses, [&](std::span<const mesh::EdgeUse> edge) {
        if (!mesh::is_smooth_join(edge))
            for (const mesh::EdgeUse& use : edge)
                result[use.triangle()] |= 1u << (use.corner + 2) % 3;
    });
    return result;
}

/// Returns the sides that each receiver has to leave: those on a rim of a surface.
std::vector<unsigned> sides_to_leave(const mesh::TriangleMesh& mesh, const Receivers& receivers) {
    std::vector<unsigned> sides(receivers.points.size());
    files::parallel_for(std::size_t{0}, sides.size(),
                        [&](std::size_t i) { sides[i] = sides_at(mesh, receivers.points[i]); });
    if (std::all_of(sides.begin(), sides.end(), [](unsigned of) { return of == 0; }))
        return sides;
    const std::vector<unsigned> all = rims(mesh);
    for (std::size_t i = 0; i < sides.size(); ++i)
        sides[i] &= all[receivers.points[i].triangle];
    return sides;
}

} // namespace

void leave_obstacles(const mesh::TriangleMesh& mesh, const RayScene& rays, float bias,
                     Receivers& receivers) {
    const std::vector<unsigned> sides = sides_to_leave(mesh, receivers);
    files::parallel_for(std::size_t{0}, receivers.points.size(), [&](std::size_t i) {
        const MeshPoint& point = receivers.points[i];
        glm::vec3 own = value_at(mesh, mesh.positions, point);
        glm::vec3& position = receivers.positions[i];
        if (sides[i] != 0) {
            const glm::vec3 standing =
                value_at(mesh, mesh.positions, off_sides(mesh, point, sides[i], bias));
            position += standing - own;
            own = standing;
        }
        position = before_obstacles(rays, own, position, receivers.normals[i], bias);
    });
}

void leave_obstacles(const RayScene& rays, float bias, mesh::TriangleMesh& mesh,
                     std::optional<float> rim_step) {
    std::vector<glm::vec3> lifts = std::exchange(mesh.lifts, {});
    lifts.resize(mesh.num_vertices(), glm::vec3(0.0f));
    const std::vector<glm::vec3> own =
        (rim_step ? vertex_receivers(mesh, *rim_step) : vertex_receivers(mesh)).positions;
    files::parallel_for(std::size_t{0}, lifts.size(), [&](std::size_t i) {
        const glm::vec3 lifted = own[i] + lifts[i];
        // A vertex that another solid hides looks from elsewhere.
        if (leads_along(lifts[i], mesh.normals[i]))
            return;
        const glm::vec3 position =
            before_obstacles(rays, own[i], lifted, mesh.normals[i], bias, &mesh.positions[i]);
        if (position != lifted)
            lifts[i] = position - own[i];
    });
    if (std::any_of(lifts.begin(), lifts.end(),
                    [](const glm::vec3& lift) { return lift != glm::vec3(0.0f); }))
        mesh.lifts = std::move(lifts);
}

glm::vec3 free_lift(const glm::vec3& lift, const glm::vec3& normal) {
    // What stands in the way sends a vertex back into its own solid.
    return !leads_along(lift, normal) && glm::dot(lift, normal) < 0.0f ? glm::vec3(0.0f) : lift;
}

} // namespace relumine::prt
