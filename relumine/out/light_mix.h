// A picture taken apart by what lights it.
#pragma once

#include "relight/pictures/layered_picture.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"

namespace relumine {

/// Draws the scene in its light, and what each light adds: "environment", the environment without
/// layers, then every light layer that shines, from the lowest to the highest, by its name, then
/// the scene's own lamps, each with its glow. A part is the picture with this layer and all below
/// it, less the picture without this layer; so the parts add up to the picture, and a layer that
/// dims has negative light. The light is the same afterwards, and the painter shows lamps as it has
/// them.
///
/// Throws:  as Painter::draw(), and std::logic_error unless an environment lights the scene.
/// Cost:    a picture and an edit for each part, of rooms one more picture; bounces, where there
///          are any, for each.
[[nodiscard]] relight::LayeredPicture light_mix(LitScene& lit, Painter& painter);

} // namespace relumine
