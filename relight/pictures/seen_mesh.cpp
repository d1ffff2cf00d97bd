#include "relight/pictures/seen_mesh.h"

#include "mesh/floor.h"

namespace relumine::relight {

SeenMesh::SeenMesh(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
                   const FadingFloor& floor, const glm::vec3& eye)
    : mesh_(mesh), rays_(rays) {
    if (floor.gap > 0.0f && eye.y > mesh.positions[floor.first_vertex].y + floor.gap)
        raised_ = mesh::with_raised_floor(mesh, floor.first_vertex, floor.gap);
}

const prt::RayScene& SeenMesh::rays() const {
    if (!raised_)
        return rays_;
    std::call_once(is_made_, [this] { raised_rays_.emplace(*raised_); });
    return *raised_rays_;
}

} // namespace relumine::relight
