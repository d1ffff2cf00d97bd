// Edits of the light of a scene: layers, the turn of the map, undo.
//
// They throw as EditedEnvironment::edit(), and cost what it costs.
#pragma once

#include <cstddef>
#include <vector>

#include "cubemap/layers/light_layer.h"
#include "relumine/in/environment.h"
#include "relumine/light/lit_scene.h"

namespace relumine {

/// Replaces the environment under the layers by another. Only what differs is updated, where both
/// have the same resolution and nothing is turned: for files that are saved again and again.
UpdateReport update(LitScene& lit, Environment environment);
/// Replaces all layers, bottom first, in one update.
UpdateReport set_layers(LitScene& lit, std::vector<cubemap::LightLayer> layers);
/// Replaces one layer, as while it is dragged. Throws std::out_of_range for an index, too.
UpdateReport set_layer(LitScene& lit, std::size_t index, const cubemap::LightLayer& layer);
/// Turns base and layers together about +Y, from their unturned state. Layers keep the directions
/// they were given. Ending::Moving is for a slider while it moves.
UpdateReport set_rotation(LitScene& lit, double degrees, Ending ending = Ending::Quick);

/// Marks the present state for undo() to return to. The first edit marks the state before it; other
/// edits without a mark are not in the history.
void mark(LitScene& lit);
/// Forgets all marks; the present state becomes the only one.
void forget_history(LitScene& lit);
/// Goes back to the last mark, from that to the mark before, or forward again. The radiance is that
/// at the mark, bit by bit. Returns an empty report where there is no such mark.
UpdateReport undo(LitScene& lit);
UpdateReport redo(LitScene& lit);

} // namespace relumine
