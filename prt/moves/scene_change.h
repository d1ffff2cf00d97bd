// What is another in a scene after a move.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/bounces/bounce_matrix.h"
#include "prt/moves/bounces_patch.h"
#include "prt/moves/counts_patch.h"
#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// What differs between a scene and the one that its counts were made for.
struct SceneDifference {
    /// They hold all triangles that block or send light in one of the two alone.
    std::vector<mesh::Bounds> boxes = {};
    /// Boxes around those of each of the two
    std::array<mesh::Bounds, 2> around = {};
    /// [num_receivers] true where a receiver has another position or another normal.
    std::vector<bool> receivers = {};
};

/// What a move changes in a scene, to be exchanged with what the scene has.
///
/// Memory:  some 80 bytes for each vertex of the group, and the counts and bounces that are others.
struct SceneChange {
    /// The indices in the scene's mesh of the groups that change: one, or those of joined()
    std::vector<std::uint32_t> groups;
    /// The groups' vertices, ascending, and what they have: as TriangleMesh
    std::vector<std::uint32_t> vertices;
    std::vector<glm::vec3> positions, normals;
    /// The vertices whose lifts differ, and those, as TriangleMesh and Scene::free_lifts
    std::vector<std::uint32_t> lifted;
    std::vector<glm::vec3> lifts, free_lifts;
    /// The groups' triangles, where they have tangents or are another
    std::vector<std::uint32_t> triangles;
    std::vector<std::array<glm::vec4, 3>> corner_tangents;
    std::vector<mesh::Triangle> corners;
    /// The groups' vertices in the blockers, where the mesh is none
    std::vector<std::uint32_t> blocker_vertices;
    std::vector<glm::vec3> blocker_positions;
    /// The groups' triangles there, where they are another
    std::vector<std::uint32_t> blocker_triangles;
    std::vector<mesh::Triangle> blocker_corners;
    /// Scene::absent, where a group goes away or comes back
    std::optional<std::vector<AbsentGroup>> absent;
    /// The receivers that differ, and their places
    std::vector<std::uint32_t> receivers, places;
    std::vector<glm::vec3> receiver_positions, receiver_normals, normals_by_place;
    CountsPatch counts;
    /// What the bounces change in, or all of them. Neither: the scene keeps those of before.
    std::optional<BouncesPatch> bounces_patch;
    std::optional<BounceMatrix> bounces;
    /// SceneSettings::rim_step
    std::optional<float> rim_step;
    /// What a change and its undo both differ in
    SceneDifference difference;
};

/// Returns the blocks whose counts or receivers differ: for each tile of VisibleCounts a bit for
/// each of its blocks.
[[nodiscard]] std::vector<std::uint64_t> changed_blocks(const VisibleCounts& counts,
                                                        const SceneChange& change);

/// Returns what two changes of a group differ in together, for those who follow: blocks, places and
/// boxes, nothing to be exchanged.
[[nodiscard]] SceneChange outline(const SceneChange& first, const SceneChange& second);

} // namespace relumine::prt
