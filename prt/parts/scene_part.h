// A part of a finished scene: what a process needs that lights some of the receivers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/reduction.h"
#include "prt/scene/scene_file.h"

namespace relumine::prt {

struct ScenePart {
    /// The scene with receivers and transfer of the part alone: positions, normals and surfaces, in
    /// spatial order.
    Scene scene;
    /// [receivers of the part] their indices in the whole scene.
    std::vector<std::uint32_t> receivers;
    /// Of the whole scene
    std::size_t num_receivers = 0;
};

/// Reads the part's tiles of a scene of the present version, and checks them.
///
/// Memory:  the mesh, all receivers, the counts of the part, and the file as it is on disk.
/// Throws:  as load_scene(); std::runtime_error "path: expected X, got Y" for a scene with
/// highlights
///          or bounces.
[[nodiscard]] ScenePart load_scene_part(const std::filesystem::path& path, const Part& part);

/// The light of a part's receivers.
struct LitPart {
    Part part;
    /// Of the whole scene
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

/// Returns a number that tells bytes apart: xxHash64.
[[nodiscard]] std::uint64_t bytes_hash(std::span<const std::byte> bytes);

} // namespace relumine::prt
