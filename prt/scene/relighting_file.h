// Scenes on disk for programs that only relight: the sections of a .prt file that this takes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/scene/scene_file.h"

namespace relumine::prt {

class SectionReader;

/// What relighting needs of a scene: no materials, lamps or highlights. Radiance is for albedo 1.
struct RelightingScene {
    Scene scene;
    /// [num_receivers] with which light bounces; empty: not known.
    std::vector<glm::vec3> albedo = {};
};

/// Writes such a file: a part of the .prt file, and the albedo.
///
/// Shape:   `albedo` is [num_receivers].
/// Throws:  as save_scene().
std::uint64_t save_relighting_scene(const std::filesystem::path& path, RelightingScene scene);

/// Returns the bytes of one for a page: as few as can be, with positions to 1/65,535 of the mesh's
/// longest side and normals to 4e-6 (prt/scene/packed_mesh.h). Of a scene of vertices.
[[nodiscard]] std::vector<std::byte> packed_relighting_scene(RelightingScene scene);

/// Reads one, or a .prt file, where the albedo is that of the receivers' surfaces. Checks it as
/// load_scene() does.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] RelightingScene relighting_scene_of(const SectionReader& reader);

} // namespace relumine::prt
