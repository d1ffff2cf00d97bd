// Places of a glTF file's nodes: as the nodes say, or as an animation moves them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>

#include "mesh/camera.h"
#include "mesh/formats/gltf_document.h"
#include "mesh/pose.h"

namespace relumine::mesh::gltf {

/// A place in the form of nodes and instances: the scale comes first, the translation last.
struct Placement {
    std::vector<double> translation = {0.0, 0.0, 0.0};
    /// A quaternion: x, y, z, w.
    std::vector<double> rotation = {0.0, 0.0, 0.0, 1.0};
    std::vector<double> scale = {1.0, 1.0, 1.0};
};

/// Throws:  std::runtime_error for a rotation of zeros.
[[nodiscard]] glm::dmat4 matrix_of(const Placement& placement);

/// What an animation says of a node at one moment. Empty: the node's own value.
struct NodePose {
    std::optional<std::vector<double>> translation, rotation, scale, weights;
};

/// By node.
using NodePoses = std::map<std::uint64_t, NodePose>;

/// Returns what an animation moves. What it sets elsewhere, by KHR_animation_pointer, is set in the
/// document: call this first. A pointer that leads nowhere is a warning.
/// Throws:  std::runtime_error "expected X, got Y" for an animation that the file does not have,
///          and for keys that are broken.
[[nodiscard]] NodePoses read_pose(Document& document, const Pose& pose,
                                  std::vector<std::string>& warnings);

/// Returns whether KHR_node_visibility hides the node, and so all below it.
[[nodiscard]] bool is_hidden(const Json& node);

/// Returns the node's place in its parent.
[[nodiscard]] glm::dmat4 local_transform(const Json& node, const NodePose& moved);

struct FileCamera {
    /// Where the node is, with a target one unit ahead.
    Camera camera;
    /// Eye and view, of unit length, without rounding.
    glm::dvec3 eye{0.0}, ahead{0.0};
    /// Half the height of an orthographic camera's picture; 0: it is a perspective camera.
    double half_height = 0.0;
};

/// Returns the camera at a node; nothing for values that no picture can have.
[[nodiscard]] std::optional<FileCamera> camera_at(const Json& camera, const glm::dmat4& transform);

} // namespace relumine::mesh::gltf
