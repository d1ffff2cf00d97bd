#include <algorithm>
#include <cmath>
#include <concepts>
#include <map>
#include <optional>
#include <type_traits>
#include <variant>

#include "mesh/materials/material_members.h"
#include "mesh/opacity.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/scene/brdf_tables.h"
#include "prt/scene/json_members.h"
#include "prt/scene/section_group.h"

namespace relumine::prt {

namespace {

using files::Json;
using mesh::Material;
using mesh::MaterialMember;
using mesh::TextureSlot;

/// The textures that are stored, by their index in the mesh.
using Stored = std::map<std::uint32_t, std::size_t>;

Json json_of(const std::optional<TextureSlot>& slot, const Stored& stored) {
    if (!slot)
        return nullptr;
    const glm::mat2& m = slot->uv_from_mesh_uv;
    Json json = {
        {"image", stored.at(slot->texture)},
        {"srgb", slot->is_srgb},
        {"wrap", {static_cast<int>(slot->wrap[0]), static_cast<int>(slot->wrap[1])}},
        {"uv", {m[0][0], m[0][1], m[1][0], m[1][1], slot->uv_offset.x, slot->uv_offset.y}}};
    if (slot->uv_set != 0)
        json.set("uv_set", slot->uv_set);
    return json;
}

/// Returns a whole number below a limit.
std::uint32_t below(const Json& json, std::uint32_t limit) {
    const std::uint32_t number = natural(json);
    if (number >= limit)
        throw std::out_of_range("expected a smaller number");
    return number;
}

float finite(const Json& json) {
    const float number = real(json);
    if (!std::isfinite(number))
        throw std::out_of_range("expected a finite number");
    return number;
}

std::optional<TextureSlot> slot_of(const Json& json, std::size_t num_textures) {
    if (json.type() == Json::Type::Null)
        return std::nullopt;
    const Json::Array& uv = json.at("uv").values();
    const auto wrap = [&](std::size_t axis) {
        return static_cast<mesh::Wrap>(below(json.at("wrap").values().at(axis), 3));
    };
    return TextureSlot{.texture = below(json.at("image"), static_cast<std::uint32_t>(num_textures)),
                       .is_srgb = json.at("srgb").boolean(),
                       .wrap = {wrap(0), wrap(1)},
                       .uv_set = json.find("uv_set") ? below(json.at("uv_set"), 2) : 0,
                       .uv_from_mesh_uv = glm::mat2(finite(uv.at(0)), finite(uv.at(1)),
                                                    finite(uv.at(2)), finite(uv.at(3))),
                       .uv_offset = glm::vec2(finite(uv.at(4)), finite(uv.at(5)))};
}

/// Reads a number within a member's limits.
float within(const Json& json, const MaterialMember& member) {
    const float number = real(json);
    if (!(number >= member.least && number <= member.most))
        throw std::out_of_range("expected a number within its limits");
    return number;
}

template<typename Value>
Value value_of(const Json& json, const MaterialMember& member, std::size_t num_textures) {
    if constexpr (std::same_as<Value, std::optional<TextureSlot>>)
        return slot_of(json, num_textures);
    else if constexpr (std::same_as<Value, bool>)
        return json.boolean();
    else if constexpr (std::same_as<Value, float>)
        return within(json, member);
    else if constexpr (std::same_as<Value, glm::vec3>)
        return {within(json.values().at(0), member), within(json.values().at(1), member),
                within(json.values().at(2), member)};
    else
        return static_cast<Value>(below(json, static_cast<std::uint32_t>(member.most) + 1));
}

Material material_of(const Json& json, std::size_t num_textures, const BrdfTables& tables) {
    Material material;
    for (const MaterialMember& member : mesh::MaterialMembers)
        if (const Json* own = json.find(member.name_in_file()))
            std::visit(
                [&]<typename Value>(Value Material::* at) {
                    material.*at = value_of<Value>(*own, member, num_textures);
                },
                member.at);
        else if (member.stands(material, member.in_file))
            throw std::out_of_range("expected all members of a material");
    if (material.transmission > 0.0f)
        material.attenuation_distance = 1.0f / finite(json.at("attenuation_per_length"));
    if (material.attenuation_distance < 0.0f)
        throw std::out_of_range("expected a length of 0 or more");
    if (material.model == mesh::MaterialModel::Measured)
        material.measured =
            tables.at(below(json.at("brdf"), static_cast<std::uint32_t>(tables.size())));
    return material;
}

mesh::Texture texture_of(const Json& json, const std::vector<std::byte>& images,
                         std::size_t& offset, mesh::ImageBudget& budget) {
    const std::size_t size = natural(json.at("bytes"));
    if (size > images.size() - offset)
        throw std::out_of_range("expected an image in the section");
    mesh::Texture texture = mesh::decode_texture(
        std::span(images).subspan(offset, size),
        json.at("v_from_top").boolean() ? mesh::VOrigin::Top : mesh::VOrigin::Bottom, budget);
    offset += size;
    return texture;
}

/// Whether rays that look for what highlights mirror see the colours of the mesh: those of points
/// with an eye and traced highlights, where vertices know their light or something glows.
bool are_seen_in_mirrors(const Scene& scene) {
    const Receivers& receivers = scene.receivers;
    return !receivers.points.empty() && has_traced_highlights(scene) &&
           (receivers.num_added != 0 || !scene.lamps.empty());
}

/// Whether rays find a material's highlight, or see its colour in one.
bool mirrors(const Scene& scene, const Material& material) {
    return (scene.receivers.to_eye.empty() || are_seen_in_mirrors(scene)) &&
           has_highlight(material);
}

/// Whether pictures take colours from textures, or highlights.
bool shows_textures(const Scene& scene) {
    const mesh::TriangleMesh& mesh = scene.mesh;
    if (are_seen_in_mirrors(scene))
        return true;
    return on_vertices(scene.layout) && !scene.receivers.surfaces.empty() &&
           std::any_of(mesh.materials.begin(), mesh.materials.end(), [&](const Material& material) {
               return material.base_color_texture || material.emission_texture ||
                      material.normal_texture || material.diffuse_transmission > 0.0f ||
                      mirrors(scene, material);
           });
}

/// Whether rays look at the materials: those of light, or of pictures of vertices.
bool rays_ask(const Scene& scene) {
    const std::vector<Material>& materials = scene.mesh.materials;
    return mesh::lets_light_pass(scene.blocking_mesh()) ||
           (on_vertices(scene.layout) &&
            std::any_of(materials.begin(), materials.end(), mesh::lets_eye_pass));
}

/// The textures that are stored: image files as they were, and behind them the texels of textures
/// that have no file: of alpha, and of textures made in code.
class StoredTextures {
public:
    explicit StoredTextures(const mesh::TriangleMesh& mesh) : mesh_(mesh) {}

    void add_image(const TextureSlot& slot) {
        const mesh::Texture& texture = mesh_.textures[slot.texture];
        if (texture.file.empty() || !stored.try_emplace(slot.texture, images_.size()).second)
            return;
        images_.push_back(
            {{"bytes", texture.file.size()}, {"v_from_top", texture.origin == mesh::VOrigin::Top}});
        bytes.insert(bytes.end(), texture.file.begin(), texture.file.end());
    }
    /// Behind all images. A grey texel takes a byte.
    void add_texels(const TextureSlot& slot) {
        if (!stored.try_emplace(slot.texture, images_.size() + texels_.size()).second)
            return;
        const mesh::Texture& texture = mesh_.textures[slot.texture];
        Json json = {{"width", texture.width}, {"height", texture.height}};
        const bool is_grey =
            std::all_of(texture.texels.begin(), texture.texels.end(), [](const auto& texel) {
                return texel[0] == texel[1] && texel[0] == texel[2];
            });
        if (!is_grey)
            json.set("channels", 3);
        texels_.push_back(std::move(json));
        for (const auto& texel : texture.texels)
            for (std::size_t channel = 0; channel < (is_grey ? 1 : 3); ++channel)
                texel_bytes.push_back(std::byte{texel[channel]});
    }
    void describe(Json& json) const {
        json.set("images", images_);
        if (texels_.size() != 0)
            json.set("alphas", texels_);
    }

    Stored stored;
    std::vector<std::byte> bytes, texel_bytes;

private:
    const mesh::TriangleMesh& mesh_;
    Json images_ = Json::Array{}, texels_ = Json::Array{};
};

bool is_of_alpha(const MaterialMember& member) {
    return member.texture() == &Material::alpha_texture;
}

/// `is_kept`: with the textures of its colours.
Json json_of(const Material& material, bool is_kept, bool has_shape, const Stored& stored) {
    Json json = Json::Object{};
    for (const MaterialMember& member : mesh::MaterialMembers)
        if (member.is_of_highlight ? has_shape : member.stands(material, member.in_file))
            std::visit(
                [&]<typename Value>(Value Material::* at) {
                    const Value& value = material.*at;
                    if constexpr (std::same_as<Value, std::optional<TextureSlot>>)
                        json.set(
                            member.name_in_file(),
                            json_of(is_kept || is_of_alpha(member) ? value : std::nullopt, stored));
                    else if constexpr (std::is_enum_v<Value>)
                        json.set(member.name_in_file(), static_cast<int>(value));
                    else
                        json.set(member.name_in_file(), value);
                },
                member.at);
    if (material.transmission > 0.0f)
        json.set("attenuation_per_length", 1.0f / material.attenuation_distance);
    return json;
}

/// Tells measured materials the numbers of their tables.
void add_measured(const std::vector<Material>& materials, const BrdfTables& tables, Json& json) {
    Json result = Json::Array{};
    for (std::size_t i = 0; i < materials.size(); ++i) {
        Json own = json.values()[i];
        if (materials[i].measured)
            own.set("brdf", std::find(tables.begin(), tables.end(), materials[i].measured) -
                                tables.begin());
        result.push_back(std::move(own));
    }
    json = std::move(result);
}

/// What gives a textured mesh its colours between the vertices, and tells rays what they may pass:
/// materials, the image files as they were, materials of triangles, uvs of corners. Other meshes
/// add nothing.
void add_materials(NewSections& sections, const Scene& scene) {
    const mesh::TriangleMesh& mesh = scene.mesh;
    const bool shows = shows_textures(scene);
    if (mesh.triangle_materials.empty() || !(shows || rays_ask(scene)))
        return;
    StoredTextures textures(mesh);
    const auto is_kept = [&](const Material& material) {
        return shows || material.transmission > 0.0f;
    };
    const auto for_each = [&](bool alpha, auto add) {
        for (const Material& material : mesh.materials)
            for (const MaterialMember& member : mesh::MaterialMembers)
                if (const auto slot = member.texture();
                    slot != nullptr && material.*slot && is_of_alpha(member) == alpha &&
                    (alpha || is_kept(material)) && member.stands(material, member.in_file))
                    (textures.*add)(*(material.*slot));
    };
    for_each(false, &StoredTextures::add_image);
    for_each(false, &StoredTextures::add_texels);
    for_each(true, &StoredTextures::add_texels);
    Json materials = Json::Array{};
    for (const Material& material : mesh.materials)
        materials.push_back(json_of(material, is_kept(material), shows && mirrors(scene, material),
                                    textures.stored));
    add_measured(mesh.materials, brdf_tables(scene), materials);
    Json json = Json::Object{};
    textures.describe(json);
    json.set("materials", std::move(materials));
    sections["materials"] = bytes_of(json.text(2));
    sections["images"] = std::move(textures.bytes);
    if (!textures.texel_bytes.empty())
        sections["alphas"] = std::move(textures.texel_bytes);
    sections["t_materials"] = SectionContent::view(mesh.triangle_materials);
    if (!mesh.corner_uvs.empty())
        sections["corner_uvs"] = SectionContent::view(mesh.corner_uvs);
    if (!mesh.corner_tangents.empty())
        sections["corner_tangents"] = SectionContent::view(mesh.corner_tangents);
    if (!scene.blockers || !mesh::lets_light_pass(*scene.blockers))
        return;
    sections["block_materials"] = SectionContent::view(scene.blockers->triangle_materials);
    if (!scene.blockers->uvs.empty())
        sections["block_uvs"] = SectionContent::view(scene.blockers->uvs);
    if (!scene.blockers->second_uvs.empty())
        sections["block_second_uvs"] = SectionContent::view(scene.blockers->second_uvs);
    if (!scene.blockers->corner_uvs.empty())
        sections["block_corner_uvs"] = SectionContent::view(scene.blockers->corner_uvs);
}

/// Reads the texels of a texture without a file, from `offset` on, which goes behind them.
mesh::Texture texels_of(const Json& json, const std::vector<std::byte>& bytes,
                        std::size_t& offset) {
    mesh::Texture texture{.name = "texels",
                          .width = natural(json.at("width")),
                          .height = natural(json.at("height")),
                          .texels = {}};
    const Json* channels = json.find("channels");
    const std::size_t num_channels = channels == nullptr ? 1 : natural(*channels);
    const std::size_t size = std::size_t{texture.width} * texture.height;
    if (size == 0 || !(num_channels == 1 || num_channels == 3) ||
        size > (bytes.size() - offset) / num_channels)
        throw std::out_of_range("expected texels in the section");
    texture.texels.reserve(size);
    for (std::size_t i = 0; i < size; ++i, offset += num_channels) {
        const auto channel = [&](std::size_t k) {
            return std::to_integer<std::uint8_t>(bytes[offset + (num_channels == 1 ? 0 : k)]);
        };
        texture.texels.push_back({channel(0), channel(1), channel(2)});
    }
    return texture;
}

/// Reads the textures of a mesh, in the order of StoredTextures.
void read_textures(const SectionReader& reader, const Json& json, mesh::TriangleMesh& mesh) {
    const std::vector<std::byte> images = reader.bytes("images");
    std::size_t offset = 0;
    mesh::ImageBudget budget;
    for (const Json& texture : json.at("images").values())
        mesh.textures.push_back(texture_of(texture, images, offset, budget));
    if (offset != images.size())
        throw std::out_of_range("expected as many bytes as images have");
    const Json* alphas = json.find("alphas");
    if (alphas == nullptr)
        return;
    const std::vector<std::byte> bytes = reader.bytes("alphas");
    offset = 0;
    for (const Json& texture : alphas->values())
        mesh.textures.push_back(texels_of(texture, bytes, offset));
    if (offset != bytes.size())
        throw std::out_of_range("expected as many bytes as texels have");
}

/// Reads which of the mesh's materials each triangle has.
std::vector<std::uint32_t> triangle_materials(const SectionReader& reader, const char* section,
                                              const mesh::TriangleMesh& mesh,
                                              std::size_t num_materials) {
    std::vector<std::uint32_t> result =
        reader.elements<std::uint32_t>(section, mesh.num_triangles());
    if (std::any_of(result.begin(), result.end(), [&](auto i) { return i >= num_materials; }))
        reader.fail(section, "indices of materials");
    return result;
}

void read_materials(const SectionReader& reader, Scene& scene) {
    mesh::TriangleMesh& mesh = scene.mesh;
    if (!reader.has("materials"))
        return;
    const Json json = reader.json("materials");
    try {
        read_textures(reader, json, mesh);
        for (const Json& material : json.at("materials").values())
            mesh.materials.push_back(material_of(material, mesh.textures.size(), scene.brdfs));
    } catch (const std::exception&) {
        reader.fail("materials", "JSON with materials and their images");
    }
    using Corners = std::array<glm::vec2, 3>;
    mesh.triangle_materials =
        triangle_materials(reader, "t_materials", mesh, mesh.materials.size());
    mesh.corner_uvs = reader.elements<Corners>("corner_uvs", mesh.num_triangles(), true);
    mesh.corner_tangents =
        reader.elements<std::array<glm::vec4, 3>>("corner_tangents", mesh.num_triangles(), true);
    if (!scene.blockers || !reader.has("block_materials"))
        return;
    mesh::TriangleMesh& blockers = *scene.blockers;
    blockers.materials = mesh.materials;
    blockers.textures = mesh.textures;
    blockers.triangle_materials =
        triangle_materials(reader, "block_materials", blockers, mesh.materials.size());
    blockers.uvs = reader.elements<glm::vec2>("block_uvs", blockers.num_vertices(), true);
    blockers.second_uvs =
        reader.elements<glm::vec2>("block_second_uvs", blockers.num_vertices(), true);
    blockers.corner_uvs =
        reader.elements<Corners>("block_corner_uvs", blockers.num_triangles(), true);
}

void check_materials(const SceneCheck& check, const Scene& scene) {
    const auto check_uvs = [&](const mesh::TriangleMesh& mesh) {
        for (std::size_t corner = 0; corner < 3; ++corner)
            check.all("finite uvs of corners", mesh.corner_uvs, is_finite_uv,
                      [&](const auto& uvs) { return uvs[corner]; });
    };
    check_uvs(scene.mesh);
    const auto is_tangent = [](const glm::vec4& tangent) {
        return is_within(glm::vec3(tangent), -2.0f, 2.0f) && std::abs(tangent.w) <= 2.0f;
    };
    for (std::size_t corner = 0; corner < 3; ++corner)
        check.all("finite tangents", scene.mesh.corner_tangents, is_tangent,
                  [&](const auto& tangents) { return tangents[corner]; });
    if (!scene.blockers)
        return;
    check_uvs(*scene.blockers);
    for (const auto* uvs : {&scene.blockers->uvs, &scene.blockers->second_uvs})
        check.all("finite uvs of blockers", *uvs, is_finite_uv);
}

} // namespace

const SectionGroup MaterialSections = {
    .add = add_materials, .read = read_materials, .check = check_materials};

} // namespace relumine::prt
