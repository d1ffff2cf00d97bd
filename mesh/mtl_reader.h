// Wavefront MTL: the materials of OBJ files.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mesh/material.h"
#include "mesh/texture.h"

namespace relumine::mesh {

/// The file `name` that a mesh file in `folder` refers to: as written, or with / for \. Empty where
/// there is no such file.
[[nodiscard]] std::filesystem::path find_file(const std::filesystem::path& folder,
                                              const std::string& name);

/// The materials of the libraries of one OBJ file.
class MtlLibrary {
public:
    explicit MtlLibrary(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Adds a library: Kd, Ks, Ns, Pr, Pm, map_Kd (with -s, -o and -clamp); the rest is skipped. A
    /// material with Pr or Pm is MetallicRoughness. A library or an image that is not there goes to
    /// `missing`. A material that is defined again replaces the first. Throws std::runtime_error
    /// "name: expected X, got Y".
    void read(const std::string& name);

    /// Index of a material; a name that no library has becomes white and Lambert, a missing one
    /// when libraries were read.
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
