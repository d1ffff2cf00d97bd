// What the files of parts say of themselves, without the plan, and what is missing before they can
// be joined.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

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

struct PartCheck {
    /// Parts of the whole that the first sound file belongs to; 0 where no file is sound.
    std::size_t num_parts = 0;
    /// Indices, from 0 on.
    std::vector<std::uint32_t> missing = {};
    /// A line for each file that cannot be joined: "path: expected X, got Y".
    std::vector<std::string> faults = {};

    [[nodiscard]] bool is_whole() const {
        return num_parts > 0 && missing.empty() && faults.empty();
    }
};

/// Looks whether files are all parts of a planned precompute or of light, each whole and there
/// once.
///
/// Memory:  the largest file.
/// Cost:    reads each file once.
[[nodiscard]] PartCheck check_parts(std::span<const std::filesystem::path> paths);

} // namespace relumine::prt
