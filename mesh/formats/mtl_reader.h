// Wavefront MTL: the materials of OBJ files.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mesh/materials/material.h"
#include "mesh/materials/texture.h"

namespace relumine::mesh {

/// Returns the file `name` that a mesh file in `folder` refers to: as written, or with / for \. If
/// there is none, capitals do not matter, and the end of the path does, as far as it leads to a
/// file in the folder: paths of other computers. Empty if there is no such file.
[[nodiscard]] std::filesystem::path find_file(const std::filesystem::path& folder,
                                              const std::string& name);

/// The materials of all libraries of one OBJ file.
class MtlLibrary {
public:
    explicit MtlLibrary(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Adds a library. It reads colours, emission, alpha, the extension for physically based
    /// rendering, their textures (with -s, -o and -clamp) and normal maps, and skips the rest. A
    /// material with a statement of the extension is MetallicRoughness. A second definition of a
    /// material replaces the first. A missing library or image goes to `missing`. A number out of
    /// range is brought into it. A statement that cannot be read, and a broken image, are left out.
    /// Each has a warning.
    ///
    /// Files of Blender and MeshLab, as their comments say, are read as these mean them: Blender's
    /// Ks and Ns are Specular and roughness of its Principled BSDF, MeshLab's Ks is nothing, and
    /// its Tr is opacity. So is Tr of others where materials would be invisible without.
    void read(const std::string& name);

    /// Returns the index of a material. A name that no library defines becomes a white Lambert
    /// material; it counts as missing if libraries were read. It is grey if a library could not be
    /// read.
    [[nodiscard]] std::uint32_t index_of(const std::string& name);

    /// Returns what the libraries have and the materials do not, a line each. Call it once, at the
    /// end.
    [[nodiscard]] std::vector<std::string> take_warnings();

    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<std::string> missing;
    /// How the libraries were read where that is a choice, a line each.
    std::vector<std::string> notes;

private:
    /// The program that wrote a library.
    enum class Writer { Other, BlenderOld, Blender, MeshLab };
    /// What a material's library says of it that is settled when all is read.
    struct Unsettled {
        std::optional<float> d = {}, transparency = {};
        /// Ka, and illum: Blender keeps metallic there.
        float ambient = 1.0f;
        int illumination = 2;
    };

    void parse(std::span<const std::byte> bytes, const std::string& name,
               const std::filesystem::path& folder);
    void read_value(Material& material, const class TextReader& reader,
                    const std::filesystem::path& folder);
    void read_normal_map(Material& material, const class TextReader& reader,
                         const std::filesystem::path& folder);
    void read_alpha_map(Material& material, const class TextReader& reader,
                        const std::filesystem::path& folder);
    [[nodiscard]] bool read_physical(Material& material, const class TextReader& reader,
                                     const std::filesystem::path& folder);
    [[nodiscard]] std::optional<std::filesystem::path> find(const std::filesystem::path& folder,
                                                            const std::string& name);
    [[nodiscard]] glm::vec3 color(const Material& material, const class TextReader& reader,
                                  double max = 1.0);
    [[nodiscard]] float scalar(const Material& material, const class TextReader& reader,
                               double max = 1.0);
    void read_alpha(const Material& material, const class TextReader& reader);
    void settle_alphas(Writer writer);
    void settle_highlights(Writer writer);
    void finish(Material& material);
    void note_unread(std::span<const std::string_view> words);
    [[nodiscard]] std::optional<std::uint32_t> texture_of(const std::filesystem::path& path,
                                                          const std::string& name, bool is_alpha);
    [[nodiscard]] std::optional<TextureSlot> texture(std::span<const std::string_view> words,
                                                     const class TextReader& reader,
                                                     const std::filesystem::path& folder,
                                                     bool is_alpha = false);
    void forget(std::uint32_t texture, std::size_t num_before);
    void note(std::string_view unread);
    [[nodiscard]] std::uint32_t add(const std::string& name);

    std::filesystem::path folder_;
    /// What is not yet settled of the materials of the library that is read, by their indices.
    std::map<std::uint32_t, Unsettled> unsettled_;
    std::map<std::string, std::uint32_t, std::less<>> indices_;
    /// Texture of each image file, or of its alpha. Empty: the image is broken.
    std::map<std::pair<std::string, bool>, std::optional<std::uint32_t>> texture_indices_;
    ImageBudget budget_;
    /// Keywords that are not read.
    std::vector<std::string> warnings_, unread_;
    /// The bump multiplier of the last texture: -bm.
    float bump_ = 1.0f;
    bool has_library_ = false, is_broken_ = false;
};

} // namespace relumine::mesh
