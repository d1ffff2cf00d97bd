// A scene in which a group of the mesh stands elsewhere.
#pragma once

#include <cstdint>

#include <glm/mat4x4.hpp>

#include "prt/moves/scene_change.h"
#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// Exchanges what a change has with what the scene has. A second call undoes the first.
void exchange(Scene& scene, SceneChange& change);

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
