// Groups of a scene that were taken away, and can be brought back.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// Returns a group that was taken away, or null.
[[nodiscard]] const AbsentGroup* absent(const Scene& scene, std::uint32_t group);
/// Returns the names of the groups that were taken away.
[[nodiscard]] std::vector<std::string> absent_names(const Scene& scene);

/// Returns the numbers of a group's triangles, ascending.
[[nodiscard]] std::vector<std::uint32_t> triangles_of(const mesh::TriangleMesh& mesh,
                                                      std::uint32_t group);

/// What a triangle is when it is away.
[[nodiscard]] inline mesh::Triangle away(const mesh::Triangle& triangle) {
    return {triangle[0], triangle[0], triangle[0]};
}

/// Returns all triangles of the scene's mesh as they are with all groups there.
[[nodiscard]] std::vector<mesh::Triangle> whole_mesh(const Scene& scene);
/// Returns the same of Scene::blockers.
[[nodiscard]] std::vector<mesh::Triangle> whole_blockers(const Scene& scene);

/// Takes a group away whose triangles are there still, without any change of the light, and fills
/// the rest of `own` in.
void take_away(Scene& scene, AbsentGroup& own);

} // namespace relumine::prt
