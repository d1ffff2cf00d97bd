// Wavefront MTL: the materials of OBJ files.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mesh/materials/material.h"
#include "mesh/materials/texture.h"

namespace relumine::mesh {

/// Returns the file `name` that a mesh file in `folder` refers to: as written, or with / for \.
/// Empty if there is no such file.
[[nodiscard]] std::filesystem::path find_file(const std::filesystem::path& folder,
                                              const std::string& name);

/// The materials of all libraries of one OBJ file.
class MtlLibrary {
public:
    explicit MtlLibrary(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Adds a library. It reads Kd, Ks, Ns, Pr, Pm and map_Kd (with -s, -o and -clamp) and skips
    /// the rest. A material with Pr or Pm is MetallicRoughness. A second definition of a material
    /// replaces the first. A missing library or image goes to `missing`.
    /// Throws:  std::runtime_error "name: expected X, got Y".
    void read(const std::string& name);

    /// Returns the index of a material. A name that no library defines becomes a white Lambert
    /// material; it counts as missing if libraries were read.
    [[nodiscard]] std::uint32_t index_of(const std::string& name);

    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<std::string> missing;

private:
    void parse(std::span<const std::byte> bytes, const std::filesystem::path& folder);
    [[nodiscard]] std::optional<TextureSlot> texture(std::span<const std::string_view> words,
                                                     const class TextReader& reader,
                                                     const std::filesystem::path& folder);
    [[nodiscard]] std::uint32_t add(const std::string& name);

    std::filesystem::path folder_;
    std::map<std::string, std::uint32_t, std::less<>> indices_;
    std::map<std::string, std::uint32_t> texture_indices_;
    bool has_library_ = false;
};

} // namespace relumine::mesh
