// Materials and textures of a glTF file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mesh/formats/gltf_document.h"
#include "mesh/materials/material.h"
#include "mesh/materials/texture.h"

namespace relumine::mesh::gltf {

/// The materials of a file.
struct Materials {
    /// Materials in the file's order.
    std::vector<Material> materials;
    /// [materials] the numbers of the TEXCOORD sets that the material's textures use: that of the
    /// colours comes first.
    std::vector<std::array<std::optional<std::uint32_t>, 2>> uv_sets;
    std::vector<Texture> textures;
    std::vector<std::string> missing;
    /// What the materials have and the result does not, a line each.
    std::vector<std::string> warnings;
};

/// Whether a body spreads the light in it (KHR_materials_volume_scatter, a draft) and is so thick
/// that less than a twentieth crosses it straight on: wax, skin, milk. Those read as opaque ones.
[[nodiscard]] bool is_milky(const Json& material);

/// Reads factors, textures, samplers, emission, and the extensions of docs/materials.md;
/// left_out() names the rest. A material that cannot be read becomes grey, an image is left out,
/// each with a warning.
[[nodiscard]] Materials read_materials(Document& document);

} // namespace relumine::mesh::gltf
