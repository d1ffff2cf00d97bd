// Materials and textures of a glTF file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh/gltf_document.h"
#include "mesh/material.h"
#include "mesh/texture.h"

namespace relumine::mesh::gltf {

struct Materials {
    /// The file's, in its order
    std::vector<Material> materials;
    /// [materials], the TEXCOORD that its textures use, if any
    std::vector<std::optional<std::uint64_t>> uv_sets;
    std::vector<Texture> textures;
    std::vector<std::string> missing;
};

/// Throws std::runtime_error "expected X, got Y". Factors, textures, samplers,
/// KHR_texture_transform; KHR_materials_unlit is a Lambert material. Alpha, emission, normal maps
/// and the other extensions are skipped.
[[nodiscard]] Materials read_materials(Document& document);

} // namespace relumine::mesh::gltf
