// The environment with the lights that stand for it, as in [D05] Fig. 1.
#pragma once

#include "cubemap/image/environment.h"
#include "lights/place_lights.h"
#include "relight/pictures/picture.h"

namespace relumine::relight {

/// Draws the tone-mapped lat-long (Reinhard's global operator), the regions' borders as thin lines,
/// and every light as a small disc in its own colour with a dark ring. The picture is between 1024
/// and 2048 pixels wide where whole multiples of the lat-long's size allow it. Colours are linear
/// in [0, 1].
///
/// Throws:  std::invalid_argument for images that LatLongGrid refuses.
[[nodiscard]] Picture region_picture(const cubemap::EnvironmentImage& lat_long,
                                     const lights::Placement& placement);

} // namespace relumine::relight
