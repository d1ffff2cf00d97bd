// Where the rays start that ask what lights a point of a mesh.
#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

/// Returns smooth_position(), but the point's own place where something stands between the two: a
/// low-poly wall with smooth normals pretends to bulge through the beams before it. Rays start at
/// ray_origin() of the position, and never beyond the front of another surface: before one that is
/// nearer than the bias they start halfway to it. Where a point touches a surface that faces it, no
/// light gets between the two, and rays start inside of its own solid. A point on a side of its
/// triangle stands a little inside.
[[nodiscard]] glm::vec3 lit_position(const mesh::TriangleMesh& mesh, const RayScene& rays,
                                     const MeshPoint& at, const glm::vec3& normal, float bias);

/// Moves receivers of pixels and texels as lit_position() says; off a side of their triangle where
/// it is the rim of a surface. Others stay as they are, and so do vertices, which have no
/// Receivers::points.
///
/// Cost:    a ray for each receiver, and one more on curved parts; parallel.
void leave_obstacles(const mesh::TriangleMesh& mesh, const RayScene& rays, float bias,
                     Receivers& receivers);

/// Gives such vertices lifts that would look from beyond another surface. Vertices that another
/// solid hides, and look from outside of it, stay as they are. `rim_step` is that of
/// vertex_receivers(); none: the mesh's own.
void leave_obstacles(const RayScene& rays, float bias, mesh::TriangleMesh& mesh,
                     std::optional<float> rim_step = {});

/// Returns the lift that a vertex would have were nothing in its way, as far as that one tells: of
/// a lift that leave_obstacles() gave, none.
[[nodiscard]] glm::vec3 free_lift(const glm::vec3& lift, const glm::vec3& normal);

} // namespace relumine::prt
