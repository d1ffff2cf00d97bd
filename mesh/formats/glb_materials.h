// Materials and textures as binary glTF has them.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/json.h"
#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Describes a mesh's materials as glTF does, with the images of their textures. A file has each
/// image once, in the bytes of the file that it came from.
class GlbMaterials {
public:
    /// The mesh must outlive this object.
    explicit GlbMaterials(const TriangleMesh& mesh);

    /// Whether v of the mesh's uvs counts from below, and of glTF's from above: v becomes 1 - v.
    [[nodiscard]] bool turns_v() const { return turns_v_; }
    /// Adds materials, textures, samplers, images and extensionsUsed to a file. `first_view` is the
    /// number of the first of the views of images().
    void describe(files::Json& document, std::size_t first_view) const;
    /// Image files, whose bytes stand in a view each.
    [[nodiscard]] const std::vector<std::span<const std::byte>>& images() const { return images_; }
    /// What of the mesh's materials a file does not have, a line each.
    [[nodiscard]] const std::vector<std::string>& left_out() const { return left_out_; }

private:
    [[nodiscard]] files::Json material(const Material& material);
    [[nodiscard]] files::Json base(const Material& material);
    [[nodiscard]] files::Json extensions(const Material& material);
    void set_texture(files::Json& object, const char* key, const std::optional<TextureSlot>& slot);
    [[nodiscard]] files::Json transform(const TextureSlot& slot) const;
    [[nodiscard]] std::optional<std::size_t> image(std::uint32_t texture);
    [[nodiscard]] std::size_t texture(std::size_t image, const TextureSlot& slot);
    void leave_out(const Material& material, const char* what);

    const TriangleMesh& mesh_;
    bool turns_v_;
    std::vector<std::span<const std::byte>> images_;
    std::vector<std::string_view> types_;
    std::map<std::uint32_t, std::optional<std::size_t>> image_of_;
    files::Json::Array materials_, textures_, samplers_;
    std::set<std::string> used_;
    std::vector<std::string> left_out_;
};

} // namespace relumine::mesh
