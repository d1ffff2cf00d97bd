#include "mesh/gltf_materials.h"

#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

namespace relumine::mesh::gltf {

namespace {

class MaterialReader {
public:
    explicit MaterialReader(Document& document) : document_(document) {}
    Materials read();

private:
    [[nodiscard]] Material material(const Json& description, std::size_t index);
    [[nodiscard]] std::optional<TextureSlot> slot(const Json& parent, const char* key,
                                                  bool is_srgb);
    [[nodiscard]] std::optional<std::uint32_t> image(std::uint64_t index);
    [[nodiscard]] Texture decode(const Json& description, std::uint64_t index,
                                 std::span<const std::byte> bytes) const;

    Document& document_;
    Materials result_;
    /// Texture of each image. Empty: the image is missing.
    std::map<std::uint64_t, std::optional<std::uint32_t>> images_;
    /// UV set of the current material.
    std::optional<std::uint64_t> uv_set_;
};

Texture MaterialReader::decode(const Json& description, std::uint64_t index,
                               std::span<const std::byte> bytes) const {
    const std::string uri = text(description, "uri");
    const std::string name = !uri.empty() && !uri.starts_with("data:")
                                 ? uri
                                 : text(description, "name", fmt::format("image {}", index));
    try {
        Texture texture = decode_texture(bytes, VOrigin::Top);
        texture.name = name;
        return texture;
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("{}: {}", name, error.what()));
    }
}

/// Returns the texture of an image. Each image is decoded once, and only if a material uses it.
std::optional<std::uint32_t> MaterialReader::image(std::uint64_t index) {
    if (const auto found = images_.find(index); found != images_.end())
        return found->second;
    const Json& description = document_.element("images", index);
    std::optional<std::uint32_t> texture;
    if (const std::string uri = text(description, "uri"); uri.empty()) {
        result_.textures.push_back(
            decode(description, index, document_.view(whole(description, "bufferView"))));
        texture = static_cast<std::uint32_t>(result_.textures.size() - 1);
    } else if (const auto bytes = document_.fetch(uri)) {
        result_.textures.push_back(decode(description, index, *bytes));
        texture = static_cast<std::uint32_t>(result_.textures.size() - 1);
    } else {
        result_.missing.push_back(uri);
    }
    images_.emplace(index, texture);
    return texture;
}

Wrap wrap_mode(const Json& sampler, const char* key) {
    switch (const std::uint64_t mode = whole(sampler, key, 10497)) {
    case 10497:
        return Wrap::Repeat;
    case 33071:
        return Wrap::Clamp;
    case 33648:
        return Wrap::Mirror;
    default:
        throw std::runtime_error(
            fmt::format("expected 10497, 33071 or 33648 as \"{}\", got {}", key, mode));
    }
}

std::optional<TextureSlot> MaterialReader::slot(const Json& parent, const char* key, bool is_srgb) {
    const Json& info = child(parent, key);
    if (info.empty())
        return std::nullopt;
    const Json& texture = document_.element("textures", whole(info, "index"));
    if (!texture.contains("source")) // only an optional extension has an image
        return std::nullopt;
    const std::optional<std::uint32_t> index = image(whole(texture, "source"));
    if (!index)
        return std::nullopt;
    TextureSlot slot{.texture = *index, .is_srgb = is_srgb};
    if (texture.contains("sampler")) {
        const Json& sampler = document_.element("samplers", whole(texture, "sampler"));
        slot.wrap = {wrap_mode(sampler, "wrapS"), wrap_mode(sampler, "wrapT")};
    }
    std::uint64_t uv_set = whole(info, "texCoord", 0);
    if (const Json& transform = child(child(info, "extensions"), "KHR_texture_transform");
        !transform.empty()) {
        // The extension defines uv' = translation * rotation * scale * uv, with a rotation from v
        // to u.
        const std::vector<double> scale = numbers(transform, "scale", {1.0, 1.0});
        const std::vector<double> offset = numbers(transform, "offset", {0.0, 0.0});
        const double angle = number(transform, "rotation", 0.0);
        const double c = std::cos(angle), s = std::sin(angle);
        slot.uv_from_mesh_uv = glm::mat2(c * scale[0], -s * scale[0], s * scale[1], c * scale[1]);
        slot.uv_offset = glm::vec2(offset[0], offset[1]);
        uv_set = whole(transform, "texCoord", uv_set);
    }
    if (uv_set_ && *uv_set_ != uv_set)
        throw std::runtime_error(
            fmt::format("expected one texCoord for the textures of a material, got {} and {}",
                        *uv_set_, uv_set));
    uv_set_ = uv_set;
    return slot;
}

Material MaterialReader::material(const Json& description, std::size_t index) {
    const Json& pbr = child(description, "pbrMetallicRoughness");
    Material material;
    material.name = text(description, "name", fmt::format("material {}", index));
    const std::vector<double> base = numbers(pbr, "baseColorFactor", {1.0, 1.0, 1.0, 1.0});
    for (const double value : base)
        if (!(value >= 0.0 && value <= 1.0))
            throw std::runtime_error(
                fmt::format("expected numbers of 0 to 1 as \"baseColorFactor\", got {}", value));
    material.base_color = glm::vec3(base[0], base[1], base[2]);
    material.base_color_texture = slot(pbr, "baseColorTexture", true);
    if (child(description, "extensions").contains("KHR_materials_unlit"))
        return material; // vertex colours of such a material are radiance
    material.model = MaterialModel::MetallicRoughness;
    material.times_vertex_color = true;
    material.metallic = fraction(pbr, "metallicFactor", 1.0f);
    material.roughness = fraction(pbr, "roughnessFactor", 1.0f);
    material.metallic_roughness_texture = slot(pbr, "metallicRoughnessTexture", false);
    return material;
}

Materials MaterialReader::read() {
    for (std::size_t i = 0; i < document_.count("materials"); ++i) {
        uv_set_.reset();
        try {
            result_.materials.push_back(material(document_.element("materials", i), i));
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(fmt::format("material {}: {}", i, error.what()));
        }
        result_.uv_sets.push_back(uv_set_);
    }
    return std::move(result_);
}

} // namespace

Materials read_materials(Document& document) {
    return MaterialReader(document).read();
}

} // namespace relumine::mesh::gltf
