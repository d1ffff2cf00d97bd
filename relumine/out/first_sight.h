// What a mesh is shown as while its precompute is under way.
#pragma once

#include "relumine/in/mesh.h"
#include "relumine/in/scene.h"
#include "relumine/out/output_options.h"

namespace relumine {

/// Returns a scene that is soon there: the mesh's vertices, and some thousand more on large faces,
/// under 384 directions, without light from surface to surface. Sharp lights, the sun above all,
/// and lamps are traced as ever.
///
/// Throws:  as precompute().
/// Cost:    some 100 rays a vertex.
[[nodiscard]] Scene quick_scene(Mesh mesh);

/// Returns the options of a picture that is soon drawn: 400 pixels on its longer side at most, one
/// sample a pixel, two rays for what it mirrors.
[[nodiscard]] OutputOptions quick_picture(OutputOptions options);

} // namespace relumine
