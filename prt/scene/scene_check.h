// `relumine info FILE.prt --check`: whether a scene file is what a precompute writes.
#pragma once

#include <filesystem>

#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// More than load_scene() asks of a scene in order to work with it: normals and directions to the
/// eye of length one or zero, uvs finite, colours not negative, settings that a precompute accepts,
/// a tree as deep as they say, a floor that fits the mesh. `path` is for messages. Throws
/// std::runtime_error "path: expected X, got Y" for the first thing that is not so.
void check_scene(const Scene& scene, const std::filesystem::path& path);

} // namespace relumine::prt
