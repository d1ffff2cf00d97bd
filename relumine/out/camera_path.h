// A camera that moves: key frames in a file, and the camera at any frame between them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "relumine/in/places.h"

namespace relumine {

/// Where the camera stands at a frame, among the coordinates of the mesh's file.
struct CameraKey {
    double frame = 0.0;
    PlacedCamera camera = {};
    bool operator==(const CameraKey&) const = default;
};

struct CameraPath {
    /// Two at least, frames ascending from 0 on.
    std::vector<CameraKey> keys = {};
    /// Whether the file says the field of view. Otherwise all keys have Camera's own.
    bool names_fov = false;
    bool operator==(const CameraPath&) const = default;

    /// Returns how many whole frames there are from frame 0 to the last key.
    [[nodiscard]] std::size_t num_frames() const;
};

/// The last frame that a key may stand at.
inline constexpr double LastCameraFrame = 99999.0;

/// Reads a camera path (docs/animate.md).
///
/// Throws:  std::runtime_error "path:line: expected X, got Y" for anything that the format does not
///          allow: unknown fields, fewer than two keys, frames that do not ascend, an eye that is
///          its target; "path: cannot read" for no file.
[[nodiscard]] CameraPath load_camera_path(const std::filesystem::path& path);

/// Returns the camera at a frame, which may lie between whole frames. It starts and stops softly,
/// passes keys without a jerk, and stands still between two keys that are the same. The field of
/// view never leaves the range of the two keys around. Before the first key and after the last the
/// camera is theirs.
///
/// Between keys eye and target may meet: has_direction() tells.
/// Throws:  std::invalid_argument for a path without keys.
[[nodiscard]] PlacedCamera camera_at(const CameraPath& path, double frame);

/// Whether eye and target are apart.
[[nodiscard]] bool has_direction(const PlacedCamera& camera);

} // namespace relumine
