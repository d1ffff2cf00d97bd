// Cameras that show a whole mesh.
#pragma once

#include <optional>

#include "mesh/subject.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/camera.h"

namespace relumine::relight {

using prt::Camera;

/// Where a camera stands that looks at a mesh.
struct CameraAngles {
    /// Turns about +Y from the side that the mesh shows as its front, to its right, degrees.
    double azimuth = 24.0;
    /// Above the horizon, degrees in [-90, 90].
    double elevation = 20.0;
    /// From the middle of what is looked at, in the mesh's unit. Empty: the picture is filled.
    std::optional<double> distance = {};
};

struct Framing {
    CameraAngles angles = {};
    /// The horizontal direction from the mesh to a camera of azimuth 0.
    glm::dvec3 front{0.0, 0.0, 1.0};
    /// Vertical field of view.
    float fov_degrees = 35.0f;
    /// The picture's width over its height.
    float aspect = 1024.0f / 768.0f;
};

/// Returns a camera that looks at the mesh, from the front, a little from the right and from above
/// unless told otherwise. What stands on the ground fills two thirds of the picture's width or
/// height and is in its middle (mesh::subject()).
///
/// Cost:    O(vertices + triangles).
[[nodiscard]] Camera framed(const mesh::TriangleMesh& mesh, const Framing& framing = {});

/// Returns framed(), or the view from another side where this one shows a wall in front of what the
/// mesh holds: a stage, a shelf, a room without a fourth wall. It turns by quarters to where fronts
/// of surfaces are seen deep in the mesh's box.
///
/// Cost:    framed() and 108 rays for every triangle; four times as much where it turns.
[[nodiscard]] Camera framed_from_open_side(const mesh::TriangleMesh& mesh,
                                           const Framing& framing = {});

using mesh::subject_bounds;

/// Returns a camera inside of a mesh that is a room, at eye height, with its back to an open side
/// or the farthest wall; nothing for other meshes. In a room most rays from the middle meet the
/// front of something, near the bounding box rather than near the middle, and its floor and ceiling
/// are at least half of the box apart.
///
/// Cost:    O(triangles).
[[nodiscard]] std::optional<Camera> inside_room(const mesh::TriangleMesh& mesh,
                                                const Framing& framing = {});

} // namespace relumine::relight
