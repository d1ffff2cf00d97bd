// A scene from the sections of its file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "prt/scene/scene_file.h"
#include "prt/scene/section_file.h"

namespace relumine::prt {

/// Does what load_scene() does, for a file's sections and version as read_sections() gives them.
///
/// path:   for messages only.
/// Throws: as load_scene() does.
[[nodiscard]] Scene scene_of(const std::filesystem::path& path, Sections&& sections,
                             std::uint32_t version = SceneFileVersion);

} // namespace relumine::prt
