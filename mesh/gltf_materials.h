// Materials and textures of a glTF file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh/gltf_document.h"
#include "mesh/material.h"
#include "mesh/texture.h"

namespace relumine::mesh::gltf {

/// The materials of a file.
struct Materials {
    /// Materials in the file's order.
    std::vector<Material> materials;
    /// [materials] the number of the TEXCOORD set that the material's textures use. Empty: no
    /// textures.
    std::vector<std::optional<std::uint64_t>> uv_sets;
    std::vector<Texture> textures;
    std::vector<std::string> missing;
};

/// Reads factors, textures, samplers and KHR_texture_transform. A KHR_materials_unlit material
/// becomes Lambert. Alpha, emission, normal maps and the other extensions are skipped.
/// Throws:  std::runtime_error "expected X, got Y".
[[nodiscard]] Materials read_materials(Document& document);

} // namespace relumine::mesh::gltf
