// What both ways into a .prt scene have in common for fuzzing.
#pragma once

#include "prt/scene/scene_file.h"

namespace relumine::fuzz {

/// Uses a scene that passed all checks: lights it (unless it is large), so that an index that
/// should not have passed is met.
void require_sound(const prt::Scene& scene);

} // namespace relumine::fuzz
