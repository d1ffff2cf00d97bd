// Where the rays start that ask what lights a point of a mesh.
#pragma once

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

/// Returns smooth_position(), but the point's own place where something stands between the two: a
/// low-poly wall with smooth normals pretends to bulge through the beams before it. Rays start at
/// ray_origin() of the position.
[[nodiscard]] glm::vec3 lit_position(const mesh::TriangleMesh& mesh, const RayScene& rays,
                                     const MeshPoint& at, const glm::vec3& normal, float bias);

/// Moves receivers of pixels and texels that stand on the smooth surface beyond an obstacle back to
/// their own places. Others stay as they are, and so do vertices, which have no Receivers::points.
///
/// Cost:    a ray for each receiver on a curved part; parallel.
void leave_obstacles(const mesh::TriangleMesh& mesh, const RayScene& rays, float bias,
                     Receivers& receivers);

} // namespace relumine::prt
