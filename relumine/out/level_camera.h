// Cameras that stand level, for views that a person turns.
#pragma once

#include "mesh/camera.h"

namespace relumine {

/// Returns a camera as a view has it that stays level as it is turned. One that looks nearly
/// straight up or down stands half a degree off that line, to the side on which its picture's lower
/// or upper edge is: its roll becomes a direction. `roll_degrees` of all others is what such a view
/// leaves out.
[[nodiscard]] mesh::Camera leveled(const mesh::Camera& camera);

/// Returns a camera that sees the same at its target from no farther than `most`, with a wider
/// field of view: orthographic cameras look from afar.
[[nodiscard]] mesh::Camera brought_near(mesh::Camera camera, float most);

} // namespace relumine
