// A scene in which a group of the mesh stands elsewhere.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "prt/moves/scene_change.h"
#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// Exchanges what a change has with what the scene has. A second call undoes the first.
void exchange(Scene& scene, SceneChange& change);

/// Returns the step of vertex_receivers() before things moved.
[[nodiscard]] float rim_step_of(const Scene& scene);

/// Gives a change the places of its receivers, and what they have.
void set_places(const Scene& scene, SceneChange& change);

/// Returns the geometry of the scene after a move, without counts and bounces. `matrix` takes the
/// group from its present place to the next one, in the coordinates of the mesh's file (Y up).
///
/// Receivers on the group go with it. All others stay, points in space among them.
///
/// Throws:  std::invalid_argument for a matrix that is not finite, singular, mirrors or is no
///          affine map; a group whose vertices others share, or that is the added floor's;
///          receivers that belong to an eye; a group that was taken away.
[[nodiscard]] SceneChange moved(const Scene& scene, std::uint32_t group, const glm::dmat4& matrix);

/// Returns the same of a group that takes another pose: its vertices go each its own way.
/// They are the group's, by ascending number, in the coordinates of the mesh's file, with their
/// normals. Without these, normals turn as the group's smooth normals do.
///
/// Throws:  as moved(); std::invalid_argument for receivers that are no vertices, another number of
///          vertices or normals, and a group that was refined.
[[nodiscard]] SceneChange posed(const Scene& scene, std::uint32_t group,
                                std::span<const glm::dvec3> vertices,
                                std::span<const glm::vec3> normals = {});

/// Returns the change of several groups of a scene at once: each one is moved() or posed() there.
///
/// Throws:  std::invalid_argument for a group that changes twice, or is taken away or brought back.
[[nodiscard]] SceneChange joined(const Scene& scene, std::vector<SceneChange> changes);

/// Returns the same of a scene whose group is taken away, or is brought back to where it stood.
/// Its receivers stay, and see what they see without it.
///
/// Throws:  std::invalid_argument for a group that is away already, or that is there; as moved()
///          for a group.
[[nodiscard]] SceneChange taken_away(const Scene& scene, std::uint32_t group);
[[nodiscard]] SceneChange brought_back(const Scene& scene, std::uint32_t group);

} // namespace relumine::prt
