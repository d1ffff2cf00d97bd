// The one check of a scene's values: whatever is read from a file, and whatever is written to one,
// passes it.
#pragma once

#include <filesystem>

#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// Checks that a scene can be lit and drawn: numbers are finite and in their ranges, normals and
/// directions to the eye are unit vectors, rays can start at all positions, a precompute accepts
/// the settings, the tree is as deep as they say, the floor fits the mesh. Indices, sizes and
/// counts were checked before. `path` is for messages.
///
/// Throws:  std::runtime_error "path: expected X, got Y" for the first failure.
void check_scene(const Scene& scene, const std::filesystem::path& path);

/// Checks highlights alone, as check_scene() does.
void check_highlights(const GlossyTransfer& glossy, const std::filesystem::path& path);

} // namespace relumine::prt
