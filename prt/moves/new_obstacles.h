// Receivers near something that has moved.
#pragma once

#include "prt/moves/scene_change.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

/// Lets vertices and texels near a group, at its place before and after a change, stand before
/// other surfaces as leave_obstacles() lets them where a scene is precomputed: what the group
/// touched looks from its own surface again once the group is gone.
///
/// Scene:   as it is after the change, and changed further. `change` undoes that, too.
/// Rays:    of the scene's blocking_mesh() as it stands.
/// Cost:    O(vertices + triangles), and a ray or two for each receiver near the group.
void leave_new_obstacles(Scene& scene, const RayScene& rays, SceneChange& change);

} // namespace relumine::prt
