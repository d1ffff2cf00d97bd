// Places that a user gives: among the coordinates of the mesh's file, which may be those of a map.
// The positions of a mesh count from TriangleMesh::offset on.
#pragma once

#include <glm/vec3.hpp>

#include "mesh/camera.h"
#include "mesh/triangle_mesh.h"

namespace relumine {

using mesh::Camera;

/// Returns a place of the file as the mesh's positions count.
[[nodiscard]] inline glm::vec3 place_in(const mesh::TriangleMesh& mesh, const glm::dvec3& place) {
    return glm::vec3(place - mesh.offset);
}

/// Returns where a position of the mesh is in its file.
[[nodiscard]] inline glm::dvec3 place_of(const mesh::TriangleMesh& mesh,
                                         const glm::vec3& position) {
    return glm::dvec3(position) + mesh.offset;
}

/// A camera among the coordinates of a mesh's file.
struct PlacedCamera {
    glm::dvec3 eye{0.0};
    glm::dvec3 target{0.0};
    /// Camera's members
    float fov_degrees = 35.0f, roll_degrees = 0.0f;

    PlacedCamera() = default;
    // NOLINTNEXTLINE(google-explicit-constructor): the same where there is no offset
    PlacedCamera(const Camera& camera)
        : eye(camera.eye), target(camera.target), fov_degrees(camera.fov_degrees),
          roll_degrees(camera.roll_degrees) {}
    [[nodiscard]] Camera in(const mesh::TriangleMesh& mesh) const {
        return {.eye = place_in(mesh, eye),
                .target = place_in(mesh, target),
                .fov_degrees = fov_degrees,
                .roll_degrees = roll_degrees};
    }
    bool operator==(const PlacedCamera&) const = default;
};

/// A box among the coordinates of a mesh's file.
struct PlacedBox {
    glm::dvec3 min{0.0};
    glm::dvec3 max{0.0};

    PlacedBox() = default;
    PlacedBox(const glm::dvec3& low, const glm::dvec3& high) : min(low), max(high) {}
    // NOLINTNEXTLINE(google-explicit-constructor): the same where there is no offset
    PlacedBox(const mesh::Bounds& box) : min(box.min), max(box.max) {}
    [[nodiscard]] mesh::Bounds in(const mesh::TriangleMesh& mesh) const {
        return {.min = place_in(mesh, min), .max = place_in(mesh, max)};
    }
    bool operator==(const PlacedBox&) const = default;
};

} // namespace relumine
