// A scene from the sections of its file.
#pragma once

#include <filesystem>

#include "prt/scene/scene_file.h"
#include "prt/scene/section_file.h"

namespace relumine::prt {

/// Does what load_scene() does, for a file's sections as read_sections() gives them.
///
/// path:   for messages only.
/// Throws: as load_scene() does.
[[nodiscard]] Scene scene_of(const std::filesystem::path& path, Sections&& sections);

/// Does the same for a scene whose counts are missing, as sections_without_light() makes it.
[[nodiscard]] Scene plan_of(const std::filesystem::path& path, Sections&& sections);

/// Returns the sections of a scene without counts, highlights and bounces. They refer to the scene,
/// which must last until they are written.
///
/// Throws: as save_scene() does.
[[nodiscard]] NewSections sections_without_light(const std::filesystem::path& path,
                                                 const Scene& scene);

} // namespace relumine::prt
