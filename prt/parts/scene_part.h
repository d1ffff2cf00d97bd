// A part of a finished scene: what a process needs that lights some of the receivers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/scene/scene_file.h"
#include "prt/team.h"

namespace relumine::prt {

/// What a process must know of the rows of bounces that others have.
struct SharedBounces {
    /// first_emitter() of all rows
    std::size_t first = 0;
    /// [num_receivers] emitters of all rows
    std::vector<std::uint32_t> num_emitters = {};
};

struct ScenePart {
    /// The whole scene without its counts. Its bounces have the rows of the part alone (has_row()).
    Scene scene;
    /// The transfer of the part's receivers by themselves, in spatial order.
    Transfer transfer = {};
    /// [receivers of the part]
    std::vector<glm::vec3> positions = {};
    /// [receivers of the part] their indices in the whole scene.
    std::vector<std::uint32_t> receivers = {};
    /// Only where light bounces
    std::optional<SharedBounces> bounces = {};
};

/// Reads the part's tiles of a scene, and checks them.
///
/// Memory:  the mesh, all receivers, the counts, highlights and rows of the part, the file as it is
///          on disk, and for a while 4 bytes for each cell of a highlight.
/// Throws:  as load_scene().
[[nodiscard]] ScenePart load_scene_part(const std::filesystem::path& path, const Part& part);

/// The light of a part's receivers.
struct LitPart {
    Part part;
    /// Receivers of the whole scene
    std::uint32_t num_receivers = 0;
    /// The scene and its light: the same text in all parts that belong together.
    std::string light;
    /// [receivers of the part] indices
    std::vector<std::uint32_t> receivers = {};
    /// [receivers of the part]
    std::vector<glm::vec3> radiance = {};
};

/// Writes the light of a part, whole or not at all. Returns the file's size in bytes.
///
/// Throws:  std::runtime_error that names the path.
std::uint64_t save_lit_part(const std::filesystem::path& path, const LitPart& part);

/// Reads the light of all parts, in any order: [num_receivers] in the scene's order.
///
/// Throws:  std::runtime_error that names the file that is damaged, no part, of other light, given
///          twice or missing.
[[nodiscard]] std::vector<glm::vec3> join_lit_parts(std::span<const std::filesystem::path> paths);

} // namespace relumine::prt
