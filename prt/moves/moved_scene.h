// A scene in which a group of the mesh stands elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "prt/bounces/bounce_matrix.h"
#include "prt/moves/counts_patch.h"
#include "prt/moves/recount.h"
#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// What a move changes in a scene, to be exchanged with what the scene has.
///
/// Memory:  some 80 bytes for each vertex of the group, and the counts and bounces that are others.
struct SceneChange {
    /// Of the scene's mesh
    std::uint32_t group = 0;
    /// The group's vertices, and what they have: as TriangleMesh
    std::vector<std::uint32_t> vertices;
    std::vector<glm::vec3> positions, normals, lifts;
    /// The group's triangles, where they have tangents
    std::vector<std::uint32_t> triangles;
    std::vector<std::array<glm::vec4, 3>> corner_tangents;
    /// Of the blockers, where the mesh is none
    std::vector<std::uint32_t> blocker_vertices;
    std::vector<glm::vec3> blocker_positions;
    /// The receivers that differ, and their places
    std::vector<std::uint32_t> receivers, places;
    std::vector<glm::vec3> receiver_positions, receiver_normals, normals_by_place;
    CountsPatch counts;
    std::optional<BounceMatrix> bounces;
    /// SceneSettings::rim_step
    std::optional<float> rim_step;
    /// The same in both directions
    SceneDifference difference;
};

/// Exchanges what a change has with what the scene has. A second call undoes the first.
void exchange(Scene& scene, SceneChange& change);

/// Returns the blocks whose counts or receivers differ: for each tile of VisibleCounts a bit for
/// each of its blocks.
[[nodiscard]] std::vector<std::uint64_t> changed_blocks(const VisibleCounts& counts,
                                                        const SceneChange& change);

/// Returns the geometry of the scene after a move, without counts and bounces. `matrix` takes the
/// group from its present place to the next one, in the coordinates of the mesh's file (Y up).
///
/// Receivers on the group go with it. All others stay, points in space among them.
///
/// Throws:  std::invalid_argument for a matrix that is not finite, singular, mirrors or is no
///          affine map; a group whose vertices others share, or that is the added floor's;
///          receivers that belong to an eye.
[[nodiscard]] SceneChange moved(const Scene& scene, std::uint32_t group, const glm::dmat4& matrix);

} // namespace relumine::prt
