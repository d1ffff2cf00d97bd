// The option --lit-by: a part of the environment.
#pragma once

#include <span>
#include <string>

#include "relumine/light/layers.h"

namespace relumine::app {

/// The region of the layer of that name, or "X,Y,Z,RADIUS": a disc with a hard edge. Throws
/// UsageError for anything else.
[[nodiscard]] cubemap::Region lit_by_region(const std::string& text,
                                            std::span<const cubemap::LightLayer> layers);

} // namespace relumine::app
