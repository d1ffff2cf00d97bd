#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "prt/glossy/surface_sampling.h"
#include "prt/scene/json_members.h"
#include "prt/scene/section_group.h"

namespace relumine::prt {

namespace {

using files::Json;
using mesh::Material;
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

/// The textures of a material that its picture depends on.
std::vector<std::optional<TextureSlot> Material::*> color_slots(const Material& material) {
    std::vector<std::optional<TextureSlot> Material::*> slots = {&Material::base_color_texture};
    if (material.model == mesh::MaterialModel::MetallicRoughness)
        slots.push_back(&Material::metallic_roughness_texture);
    if (material.model == mesh::MaterialModel::SpecularGlossiness)
        slots.push_back(&Material::specular_texture);
    if (material.emission != glm::vec3(0.0f))
        slots.push_back(&Material::emission_texture);
    if (material.normal_texture)
        slots.push_back(&Material::normal_texture);
    return slots;
}

/// Whether the images of its colours can be stored; textures that were made in code have no file.
bool has_files(const Material& material, const std::vector<mesh::Texture>& textures) {
    for (const auto slot : color_slots(material))
        if (const auto& used = material.*slot; used && textures[used->texture].file.empty())
            return false;
    return true;
}

const char* name_of(std::optional<TextureSlot> Material::*slot) {
    return std::find_if(mesh::TextureSlots.begin(), mesh::TextureSlots.end(),
                        [&](const mesh::SlotName& entry) { return entry.slot == slot; })
        ->name;
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

/// Returns a number from 0 to the most.
float within(const Json& json, float most) {
    const float number = real(json);
    if (!(number >= 0.0f && number <= most))
        throw std::out_of_range("expected a number within its limits");
    return number;
}

/// Returns a number in [0, 1].
float fraction(const Json& json) {
    return within(json, 1.0f);
}

/// Numbers that F0 depends on, where they are not the usual ones.
constexpr std::array<std::pair<const char*, float Material::*>, 2> Scalars = {
    {{"ior", &Material::ior}, {"specular_strength", &Material::specular_strength}}};

glm::vec3 color(const Json& json) {
    return {fraction(json.values().at(0)), fraction(json.values().at(1)),
            fraction(json.values().at(2))};
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

Material material_of(const Json& json, std::size_t num_textures) {
    Material material;
    material.model = static_cast<mesh::MaterialModel>(below(json.at("model"), 4));
    material.base_color = color(json.at("base"));
    material.metallic = fraction(json.at("metallic"));
    material.specular = color(json.at("specular"));
    material.times_vertex_color = json.at("times_vertex_color").boolean();
    if (const Json* roughness = json.find("roughness")) {
        material.roughness = fraction(*roughness);
        material.exponent = finite(json.at("exponent"));
        if (material.exponent < 0.0f)
            throw std::out_of_range("expected an exponent of 0 or more");
    }
    if (const Json* emission = json.find("emission"))
        for (int channel = 0; channel < 3; ++channel) {
            material.emission[channel] =
                finite(emission->values().at(static_cast<std::size_t>(channel)));
            if (material.emission[channel] < 0.0f)
                throw std::out_of_range("expected an emission of 0 or more");
        }
    for (const auto& [name, member] : Scalars)
        if (const Json* value = json.find(name))
            material.*member = within(*value, 1e6f);
    if (const Json* tint = json.find("specular_tint"))
        for (int channel = 0; channel < 3; ++channel)
            material.specular_tint[channel] =
                within(tint->values().at(static_cast<std::size_t>(channel)), 1e6f);
    for (const auto slot : color_slots(material))
        material.*slot = slot_of(json.at(name_of(slot)), num_textures);
    if (const Json* normals = json.find(name_of(&Material::normal_texture))) {
        material.normal_texture = slot_of(*normals, num_textures);
        material.normal_scale = finite(json.at("normal_scale"));
    }
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

/// What gives a textured mesh its colours between the vertices: materials, the image files as they
/// were, materials of triangles, uvs of corners. A mesh without textures adds nothing.
void add_materials(NewSections& sections, const Scene& scene) {
    if (!on_vertices(scene.layout) || scene.receivers.surfaces.empty())
        return;
    const mesh::TriangleMesh& mesh = scene.mesh;
    const auto has_texture = [&](const Material& material) {
        return (material.base_color_texture || material.emission_texture ||
                material.normal_texture) &&
               has_files(material, mesh.textures);
    };
    // Without an eye pictures find the highlights by rays.
    const auto mirrors = [&](const Material& material) {
        return scene.receivers.to_eye.empty() && has_highlight(material);
    };
    const auto is_needed = [&](const Material& material) {
        return has_texture(material) || mirrors(material);
    };
    if (mesh.triangle_materials.empty() ||
        std::none_of(mesh.materials.begin(), mesh.materials.end(), is_needed))
        return;
    Json textures = Json::Array{}, materials = Json::Array{};
    std::vector<std::byte> images;
    Stored stored;
    for (const Material& material : mesh.materials) {
        Json json = {
            {"model", static_cast<int>(material.model)},
            {"base", {material.base_color.r, material.base_color.g, material.base_color.b}},
            {"metallic", material.metallic},
            {"specular", {material.specular.r, material.specular.g, material.specular.b}},
            {"times_vertex_color", material.times_vertex_color}};
        if (mirrors(material)) {
            json.set("roughness", material.roughness);
            json.set("exponent", material.exponent);
        }
        // A picture takes a material without its textures from the vertices.
        const bool is_kept = has_files(material, mesh.textures);
        if (const glm::vec3& emission = material.emission; emission != glm::vec3(0.0f))
            json.set("emission", {emission.r, emission.g, emission.b});
        if (material.normal_texture)
            json.set("normal_scale", material.normal_scale);
        for (const auto& [name, member] : Scalars)
            if (material.*member != Material().*member)
                json.set(name, material.*member);
        if (const glm::vec3& tint = material.specular_tint; tint != glm::vec3(1.0f))
            json.set("specular_tint", {tint.r, tint.g, tint.b});
        for (const auto slot : color_slots(material)) {
            const auto& used = is_kept ? material.*slot : std::nullopt;
            if (used && !stored.contains(used->texture)) {
                const mesh::Texture& texture = mesh.textures[used->texture];
                stored.emplace(used->texture, textures.size());
                textures.push_back({{"bytes", texture.file.size()},
                                    {"v_from_top", texture.origin == mesh::VOrigin::Top}});
                images.insert(images.end(), texture.file.begin(), texture.file.end());
            }
            json.set(name_of(slot), json_of(used, stored));
        }
        materials.push_back(json);
    }
    const std::string text = Json({{"images", textures}, {"materials", materials}}).text(2);
    sections["materials"] = bytes_of(text);
    sections["images"] = std::move(images);
    sections["t_materials"] = SectionContent::view(mesh.triangle_materials);
    if (!mesh.corner_uvs.empty())
        sections["corner_uvs"] = SectionContent::view(mesh.corner_uvs);
    if (!mesh.corner_tangents.empty())
        sections["corner_tangents"] = SectionContent::view(mesh.corner_tangents);
}

void read_materials(const SectionReader& reader, Scene& scene) {
    mesh::TriangleMesh& mesh = scene.mesh;
    if (!reader.has("materials"))
        return;
    const Json json = reader.json("materials");
    const std::vector<std::byte> images = reader.bytes("images");
    try {
        std::size_t offset = 0;
        mesh::ImageBudget budget;
        for (const Json& texture : json.at("images").values())
            mesh.textures.push_back(texture_of(texture, images, offset, budget));
        if (offset != images.size())
            throw std::out_of_range("expected as many bytes as images have");
        for (const Json& material : json.at("materials").values())
            mesh.materials.push_back(material_of(material, mesh.textures.size()));
    } catch (const std::exception&) {
        reader.fail("materials", "JSON with materials and their images");
    }
    mesh.triangle_materials = reader.elements<std::uint32_t>("t_materials", mesh.num_triangles());
    if (std::any_of(mesh.triangle_materials.begin(), mesh.triangle_materials.end(),
                    [&](auto i) { return i >= mesh.materials.size(); }))
        reader.fail("t_materials", "indices of materials");
    mesh.corner_uvs =
        reader.elements<std::array<glm::vec2, 3>>("corner_uvs", mesh.num_triangles(), true);
    mesh.corner_tangents =
        reader.elements<std::array<glm::vec4, 3>>("corner_tangents", mesh.num_triangles(), true);
}

void check_materials(const SceneCheck& check, const Scene& scene) {
    const auto is_tangent = [](const glm::vec4& tangent) {
        return is_within(glm::vec3(tangent), -2.0f, 2.0f) && std::abs(tangent.w) <= 2.0f;
    };
    for (std::size_t corner = 0; corner < 3; ++corner) {
        check.all("finite tangents", scene.mesh.corner_tangents, is_tangent,
                  [&](const auto& tangents) { return tangents[corner]; });
        check.all("finite uvs of corners", scene.mesh.corner_uvs, is_finite_uv,
                  [&](const auto& uvs) { return uvs[corner]; });
    }
}

} // namespace

const SectionGroup MaterialSections = {
    .add = add_materials, .read = read_materials, .check = check_materials};

} // namespace relumine::prt
