// Things that move in a precomputed scene: a move costs what it changes.
#pragma once

#include <cstdint>
#include <string>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "prt/moves/moved_scene.h"
#include "prt/moves/recount.h"
#include "relumine/in/precompute_options.h"
#include "relumine/in/scene.h"
#include "relumine/in/scene_rays.h"

namespace relumine {

/// Moves a group of the scene's mesh.
struct GroupMove {
    std::string name = {};
    /// From its present place to the next one, in the coordinates of the mesh's file with Y up
    glm::dmat4 matrix{1.0};
};

/// NAME=X,Y,Z[,DEGREES]: a step, and a turn about the vertical axis through the middle of the
/// group's box.
struct GroupStep {
    std::string name = {};
    glm::dvec3 by{0.0};
    double degrees = 0.0;
    bool operator==(const GroupStep&) const = default;
};
struct GroupStepText {
    static constexpr const char* Type = "NAME=X,Y,Z[,DEGREES]";
    static GroupStep read(const std::string& text);
    static std::string show(const GroupStep& step);
};

/// Returns the move that a step is.
///
/// Throws:  std::invalid_argument as move() for a name.
[[nodiscard]] GroupMove move_of(const Scene& scene, const GroupStep& step);

/// Returns the number of a group of a scene that was precomputed with PrecomputeOptions::movable.
///
/// Throws:  std::invalid_argument for a scene without groups, and a name that none has.
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

/// Moves a group of a scene that was precomputed with PrecomputeOptions::movable. The clusters
/// stay. The counts become those that a precompute finds for these clusters, bit by bit: only rays
/// are traced that the group can have met before or can meet now. So are the rays of bounces, where
/// the scene knows how many each receiver has; otherwise all are sampled anew. What the precompute
/// made of the scene beyond that stays: receivers where they look from, vertices that refinement
/// added, lifts.
///
/// Returns what undoes the move: prt::exchange(scene, change). A second exchange makes it again.
/// Report:  where given, filled.
/// Rays:    those of the scene, which follow it. Without them they are made for the move.
/// Throws:  std::invalid_argument for a scene without groups, a name that no group has, and as
///          prt::moved(); Cancelled. Nothing has changed then.
prt::SceneChange move(Scene& scene, const GroupMove& to, const PrecomputeWork& work = {},
                      MoveReport* report = nullptr, SceneRays* rays = nullptr);

} // namespace relumine
