// `relumine info FILE.prt --check`: whether a scene file is one that a precompute writes.
#pragma once

#include <filesystem>

#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// Checks more than load_scene() needs: normals and directions to the eye have length one or zero,
/// uvs are finite, colours are not negative, a precompute accepts the settings, the tree is as deep
/// as they say, the floor fits the mesh. `path` is for messages.
///
/// Throws:  std::runtime_error "path: expected X, got Y" for the first failure.
void check_scene(const Scene& scene, const std::filesystem::path& path);

} // namespace relumine::prt
