// What the file of a part says of itself, without the plan or the other parts.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "prt/team.h"

namespace relumine::prt {

enum class SceneFileKind {
    /// No file of sections at all
    Other,
    Scene,
    /// load_plan() reads it.
    Plan,
    /// join_parts() takes it.
    ScenePart,
    /// join_lit_parts() takes it.
    LightPart,
};

/// Says which kind of file of sections a file is, whatever its name.
///
/// Throws:  std::runtime_error "path: expected X, got Y" for one that is damaged or cannot be read.
[[nodiscard]] SceneFileKind scene_file_kind(const std::filesystem::path& path);

struct PartFacts {
    Part part = {};
    /// Receivers of the part
    std::size_t num_receivers = 0;
    /// What all parts that belong together have: the hash of their plan, or what names their scene
    /// and light.
    std::string whole = {};
    /// It carries the plan, as the first part of a scene does.
    bool has_plan = false;
};

/// Checks the file of a part as join does, and reads what it says of itself.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] PartFacts part_facts(const std::filesystem::path& path);

} // namespace relumine::prt
