// Things that move in a precomputed scene: a move costs what it changes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "prt/moves/moved_scene.h"
#include "prt/moves/recount.h"
#include "relumine/in/precompute_options.h"
#include "relumine/in/scene.h"
#include "relumine/in/scene_rays.h"

namespace relumine {

/// Whether a group goes to another place, takes another pose, is taken away, or is brought back to
/// where it stood.
enum class Going { To, Pose, Away, Back };

/// Moves a group of the scene's mesh.
struct GroupMove {
    std::string name = {};
    /// From its present place to the next one, in the coordinates of the mesh's file with Y up
    glm::dmat4 matrix{1.0};
    /// The matrix counts with To alone.
    Going going = Going::To;
    /// With Pose: the group's vertices, by ascending number, in the coordinates of the mesh's file
    /// with Y up
    std::vector<glm::dvec3> vertices = {};
    /// Their normals. Empty: normals turn as the group's smooth normals do.
    std::vector<glm::vec3> normals = {};
};

/// Returns the move of a group to the pose that it has in another mesh: that of the same file, as
/// MeshOptions::pose reads it, or one without groups, which is the group as a whole.
///
/// Throws:  std::invalid_argument for a name that no group of the mesh has.
[[nodiscard]] GroupMove pose_of(const std::string& name, const mesh::TriangleMesh& mesh);

/// NAME=X,Y,Z[,DEGREES]: a step, and a turn about the vertical axis through the middle of the
/// group's box. NAME=away and NAME=back: the group is taken away and brought back. NAME=FILE: it
/// takes the pose that it has in a file of a mesh, which pose_of() makes a move.
struct GroupStep {
    std::string name = {};
    glm::dvec3 by{0.0};
    double degrees = 0.0;
    Going going = Going::To;
    /// With Pose
    std::string file = {};
    bool operator==(const GroupStep&) const = default;
};
struct GroupStepText {
    static constexpr const char* Type = "NAME=X,Y,Z[,DEGREES]";
    static GroupStep read(const std::string& text);
    static std::string show(const GroupStep& step);
};

/// Returns the middle of a group's box, in the coordinates of the mesh's file.
///
/// Throws:  std::invalid_argument as move() for a name.
[[nodiscard]] glm::dvec3 middle_of(const Scene& scene, const std::string& name);
/// Returns the move that a step is, of the group as it stands or of one with its middle elsewhere.
///
/// Throws:  std::invalid_argument as move() for a name.
[[nodiscard]] GroupMove move_of(const Scene& scene, const GroupStep& step);
[[nodiscard]] GroupMove move_of(const GroupStep& step, const glm::dvec3& middle);

/// Throws:  std::invalid_argument for a scene that was precomputed without
///          PrecomputeOptions::movable.
void require_movable(const Scene& scene);
/// Returns the number of a group.
///
/// Throws:  as require_movable(); std::invalid_argument for a name that none has.
[[nodiscard]] std::uint32_t group_named(const Scene& scene, const std::string& name);

struct MoveReport {
    /// Receivers that went along
    std::size_t num_moved = 0;
    /// What was counted anew, of num_all pairs of blocks of 16 receivers and clusters
    prt::RecountStatistics counts = {};
    std::uint64_t num_all = 0;
    /// Something is now outside of the box that held the scene.
    bool leaves_box = false;
    double seconds_bounces = 0.0, seconds = 0.0;
};

/// Returns a handle for move() that tells the progress of all its stages as one.
[[nodiscard]] PrecomputeWork move_work(const prt::Work& work);

/// Moves a group of a scene that was precomputed with PrecomputeOptions::movable. The clusters
/// stay. The counts become those that a precompute finds for these clusters, bit by bit: only rays
/// are traced that the group can have met before or can meet now. So are the rays of bounces, where
/// the scene knows how many each receiver has; otherwise all are sampled anew. What the precompute
/// made of the scene beyond that stays: receivers where they look from, vertices that refinement
/// added, lifts. Receivers of a group that is taken away stay, and see what they see without it.
///
/// Returns what undoes the move: prt::exchange(scene, change). A second exchange makes it again.
/// Report:  where given, filled.
/// Rays:    those of the scene, which follow it. Without them they are made for the move.
/// Throws:  std::invalid_argument for a scene without groups, a name that no group has, and as
///          prt::moved(), prt::taken_away() and prt::brought_back(); Cancelled. Nothing has changed
///          then.
prt::SceneChange move(Scene& scene, const GroupMove& to, const PrecomputeWork& work = {},
                      MoveReport* report = nullptr, SceneRays* rays = nullptr);
/// Moves several groups at once, each by Going::To or Going::Pose: what they change is found
/// together, so it costs about as much as what they cover, and not a move for each. The counts are
/// those of one move after the other.
///
/// Throws:  std::invalid_argument also for no group, and as prt::joined().
prt::SceneChange move(Scene& scene, std::span<const GroupMove> to, const PrecomputeWork& work = {},
                      MoveReport* report = nullptr, SceneRays* rays = nullptr);

/// Returns about how many clusters a precompute of a scene as it stands would choose: moves keep
/// those that there are.
///
/// Cost:    a quarter of the precompute's clusters, 1/16 with 260,000 receivers and more: it asks a
///          sample of the receivers (prt::plan_clusters()).
/// Throws:  as require_movable(); Cancelled.
[[nodiscard]] std::size_t fresh_clusters(const Scene& scene, const prt::Work& work = {});

} // namespace relumine
