// A mesh as an eye sees it.
#pragma once

#include <mutex>
#include <optional>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/picture_view.h"

namespace relumine::relight {

/// An added floor lies a hair below what stands on it, so that they share no plane. To an eye above
/// the floor, the hair is not there.
///
/// Threads: rays() may run from any number of threads at once.
class SeenMesh {
public:
    /// All must outlive this object.
    SeenMesh(const mesh::TriangleMesh& mesh, const prt::RayScene& rays, const FadingFloor& floor,
             const glm::vec3& eye);

    /// Triangles have the numbers of the mesh.
    [[nodiscard]] const mesh::TriangleMesh& mesh() const { return raised_ ? *raised_ : mesh_; }
    /// What traces the eye's rays. It is made when it is first asked for.
    [[nodiscard]] const prt::RayScene& rays() const;

private:
    const mesh::TriangleMesh& mesh_;
    const prt::RayScene& rays_;
    std::optional<mesh::TriangleMesh> raised_;
    mutable std::once_flag is_made_;
    mutable std::optional<prt::RayScene> raised_rays_;
};

} // namespace relumine::relight
