// The other side of surfaces that pass light on: leaves, paper.
#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "prt/receivers/mesh_point.h"
#include "prt/receivers/texture_view.h"
#include "prt/visibility/twin_triangles.h"
#include "relight/surfaces/mesh_light.h"

namespace relumine::relight {

/// The other side of a point, and the part of its light that the surface passes on.
struct OtherSide {
    prt::MeshPoint at;
    glm::vec3 part;
};

/// Returns it where a surface passes light on, the mesh has its other side, and the light comes
/// with materials.
[[nodiscard]] std::optional<OtherSide>
other_side(const mesh::TriangleMesh& mesh, const prt::MeshPoint& point, const MeshLight& light,
           const prt::TwinTriangles& twins, const prt::TextureView* view = nullptr);

} // namespace relumine::relight
