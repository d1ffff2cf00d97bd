#include "mesh/formats/glb_materials.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "mesh/materials/image_decoder.h"

namespace relumine::mesh {

using files::Json;

namespace {

/// The name of an image's type; empty for one that glTF does not have.
std::string_view type_of(std::span<const std::byte> file) {
    switch (image_format(file)) {
    case ImageFormat::Png:
        return "image/png";
    case ImageFormat::Jpeg:
        return "image/jpeg";
    case ImageFormat::WebP:
        return "image/webp";
    default:
        return "";
    }
}

/// The brightest channel of an emission.
float strength_of(const glm::vec3& emission) {
    return std::max({emission.r, emission.g, emission.b});
}

} // namespace

GlbMaterials::GlbMaterials(const TriangleMesh& mesh) : mesh_(mesh) {
    // Uvs without an image are not of glTF, of which only what a texture uses is read.
    turns_v_ = mesh.textures.empty() ||
               std::any_of(mesh.textures.begin(), mesh.textures.end(),
                           [](const Texture& own) { return own.origin == VOrigin::Bottom; });
    if (mesh.triangle_materials.empty())
        materials_.push_back(material(Material{.name = "surface"}));
    else
        for (const Material& own : mesh.materials)
            materials_.push_back(material(own));
}

void GlbMaterials::describe(Json& document, std::size_t first_view) const {
    document.set("materials", materials_);
    if (!textures_.empty()) {
        document.set("textures", textures_);
        document.set("samplers", samplers_);
        Json::Array images;
        for (std::size_t i = 0; i < images_.size(); ++i)
            images.push_back({{"bufferView", first_view + i}, {"mimeType", types_[i]}});
        document.set("images", std::move(images));
    }
    if (!used_.empty())
        document.set("extensionsUsed", std::vector<std::string>(used_.begin(), used_.end()));
}

/// Returns the image of a texture, or of the texture whose alpha it is: that has no file of its
/// own.
std::optional<std::size_t> GlbMaterials::image(std::uint32_t texture) {
    if (const auto found = image_of_.find(texture); found != image_of_.end())
        return found->second;
    constexpr std::string_view OfAlpha = " (alpha)";
    const Texture* whole = &mesh_.textures[texture];
    if (whole->name.ends_with(OfAlpha)) {
        const std::string name = whole->name.substr(0, whole->name.size() - OfAlpha.size());
        const auto is_whole = [&](const Texture& other) {
            return other.name == name;
        };
        const auto found = std::find_if(mesh_.textures.begin(), mesh_.textures.end(), is_whole);
        if (std::count_if(mesh_.textures.begin(), mesh_.textures.end(), is_whole) == 1)
            whole = &*found;
    }
    std::optional<std::size_t> result;
    if (const std::string_view type = type_of(whole->file); !type.empty()) {
        const auto same = std::find_if(images_.begin(), images_.end(), [&](const auto& own) {
            return own.data() == whole->file.data();
        });
        result = same - images_.begin();
        if (same == images_.end()) {
            images_.emplace_back(whole->file);
            types_.push_back(type);
        }
    }
    image_of_.emplace(texture, result);
    return result;
}

/// Returns the number of a texture with its sampler.
std::size_t GlbMaterials::texture(std::size_t image, const TextureSlot& slot) {
    const auto number_in = [](Json::Array& all, const Json& own) {
        const auto found = std::find_if(
            all.begin(), all.end(), [&](const Json& other) { return other.text() == own.text(); });
        const auto number = static_cast<std::size_t>(found - all.begin());
        if (found == all.end())
            all.push_back(own);
        return number;
    };
    const auto wrap = [](Wrap mode) {
        return mode == Wrap::Clamp ? 33071 : mode == Wrap::Mirror ? 33648 : 10497;
    };
    const std::size_t sampler =
        number_in(samplers_, {{"wrapS", wrap(slot.wrap[0])}, {"wrapT", wrap(slot.wrap[1])}});
    Json result = {{"sampler", sampler}};
    if (types_[image] == "image/webp") {
        result.set("extensions", {{"EXT_texture_webp", {{"source", image}}}});
        used_.insert("EXT_texture_webp");
    } else {
        result.set("source", image);
    }
    return number_in(textures_, result);
}

/// Returns KHR_texture_transform of a slot: offset + rotation * scale * uv. Null: it is none.
Json GlbMaterials::transform(const TextureSlot& slot) const {
    glm::mat2 matrix = slot.uv_from_mesh_uv;
    glm::vec2 offset = slot.uv_offset;
    if (turns_v_) {
        const glm::mat2 turn(1.0f, 0.0f, 0.0f, -1.0f);
        const glm::vec2 end(0.0f, 1.0f);
        matrix = turn * matrix * turn;
        offset = turn * offset + end - matrix * end;
    }
    if (matrix == glm::mat2(1.0f) && offset == glm::vec2(0.0f))
        return {};
    const double rotation = std::atan2(-matrix[0][1], matrix[0][0]);
    const double length = std::hypot(matrix[1][0], matrix[1][1]);
    const bool mirrors = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0] < 0.0f;
    return {
        {"offset", Json::Array{offset.x, offset.y}},
        {"rotation", rotation},
        {"scale", Json::Array{std::hypot(matrix[0][0], matrix[0][1]), mirrors ? -length : length}}};
}

/// Sets a texture of an object, if there is one.
void GlbMaterials::set_texture(Json& object, const char* key,
                               const std::optional<TextureSlot>& slot) {
    if (!slot)
        return;
    const std::optional<std::size_t> own = image(slot->texture);
    if (!own) {
        left_out_.push_back(fmt::format("the image {}, which is no PNG, JPEG or WebP",
                                        mesh_.textures[slot->texture].name));
        return;
    }
    Json result = {{"index", texture(*own, *slot)}};
    if (slot->uv_set != 0)
        result.set("texCoord", slot->uv_set);
    if (Json moved = transform(*slot); moved.size() != 0) {
        result.set("extensions", {{"KHR_texture_transform", std::move(moved)}});
        used_.insert("KHR_texture_transform");
    }
    object.set(key, std::move(result));
}

void GlbMaterials::leave_out(const Material& material, const char* what) {
    left_out_.push_back(fmt::format("{} of the material {}", what, material.name));
}

/// Returns pbrMetallicRoughness. Phong's exponent becomes a roughness of about the same highlight.
Json GlbMaterials::base(const Material& material) {
    const bool is_phong = material.model == MaterialModel::Phong;
    const double roughness = !is_phong ? double{material.roughness}
                             : material.specular == glm::vec3(0.0f)
                                 ? 1.0
                                 : std::pow(2.0 / (double{material.exponent} + 2.0), 0.25);
    const glm::vec3& color = material.base_color;
    Json result = {{"baseColorFactor",
                    Json::Array{double{color.r}, double{color.g}, double{color.b},
                                material.alpha_mode == AlphaMode::Opaque ? 1.0 : material.alpha}},
                   {"metallicFactor", is_phong ? 0.0 : double{material.metallic}},
                   {"roughnessFactor", roughness}};
    set_texture(result, "baseColorTexture", material.base_color_texture);
    if (material.model == MaterialModel::MetallicRoughness)
        set_texture(result, "metallicRoughnessTexture", material.metallic_roughness_texture);
    return result;
}

Json GlbMaterials::material(const Material& material) {
    Json result = {{"name", material.name}, {"pbrMetallicRoughness", base(material)}};
    if (material.is_double_sided)
        result.set("doubleSided", true);
    if (material.alpha_mode != AlphaMode::Opaque) {
        result.set("alphaMode", material.alpha_mode == AlphaMode::Mask ? "MASK" : "BLEND");
        if (material.alpha_mode == AlphaMode::Mask)
            result.set("alphaCutoff", double{material.alpha_cutoff});
        if (material.alpha_texture &&
            (!material.base_color_texture ||
             image(material.alpha_texture->texture) != image(material.base_color_texture->texture)))
            leave_out(material, "an image of alpha alone");
    }
    set_texture(result, "normalTexture", material.normal_texture);
    if (material.normal_texture && result.find("normalTexture") && material.normal_scale != 1.0f) {
        Json normals = *result.find("normalTexture");
        normals.set("scale", double{material.normal_scale});
        result.set("normalTexture", std::move(normals));
    }
    // Factors are at most 1; the extension has the rest.
    if (const float strength = strength_of(material.emission); strength > 0.0f) {
        result.set("emissiveFactor", material.emission / std::max(strength, 1.0f));
        set_texture(result, "emissiveTexture", material.emission_texture);
    }
    if (material.model != MaterialModel::MetallicRoughness &&
        (material.specular_texture || material.metallic_roughness_texture))
        leave_out(material, "images of what it mirrors");
    if (material.roughness_texture || material.metallic_texture)
        leave_out(material, "images of roughness or metal alone");
    Json more = extensions(material);
    for (const auto& [name, value] : more.members())
        used_.insert(name);
    if (more.size() != 0)
        result.set("extensions", std::move(more));
    return result;
}

/// Returns the extensions that the material needs.
Json GlbMaterials::extensions(const Material& material) {
    Json result = Json::Object{};
    const auto set =
        [&](const char* name, Json extension,
            std::initializer_list<std::pair<const char*, const std::optional<TextureSlot>*>>
                textures = {}) {
            for (const auto& [key, slot] : textures)
                set_texture(extension, key, *slot);
            result.set(name, std::move(extension));
        };
    if (const float strength = strength_of(material.emission); strength > 1.0f)
        set("KHR_materials_emissive_strength", {{"emissiveStrength", double{strength}}});
    if (material.transmission > 0.0f)
        set("KHR_materials_transmission", {{"transmissionFactor", double{material.transmission}}},
            {{"transmissionTexture", &material.transmission_texture}});
    if (material.thickness > 0.0f) {
        Json volume = {{"thicknessFactor", double{material.thickness}},
                       {"attenuationColor", material.attenuation_color}};
        if (std::isfinite(material.attenuation_distance)) // its default is infinite
            volume.set("attenuationDistance", double{material.attenuation_distance});
        set("KHR_materials_volume", std::move(volume));
    }
    if (material.dispersion > 0.0f)
        set("KHR_materials_dispersion", {{"dispersion", double{material.dispersion}}});
    if (material.diffuse_transmission > 0.0f)
        set("KHR_materials_diffuse_transmission",
            {{"diffuseTransmissionFactor", double{material.diffuse_transmission}},
             {"diffuseTransmissionColorFactor", material.diffuse_transmission_color}},
            {{"diffuseTransmissionTexture", &material.diffuse_transmission_texture},
             {"diffuseTransmissionColorTexture", &material.diffuse_transmission_color_texture}});
    if (material.coat > 0.0f)
        set("KHR_materials_clearcoat",
            {{"clearcoatFactor", double{material.coat}},
             {"clearcoatRoughnessFactor", double{material.coat_roughness}}},
            {{"clearcoatTexture", &material.coat_texture},
             {"clearcoatRoughnessTexture", &material.coat_roughness_texture},
             {"clearcoatNormalTexture", &material.coat_normal_texture}});
    if (material.sheen != glm::vec3(0.0f))
        set("KHR_materials_sheen",
            {{"sheenColorFactor", material.sheen},
             {"sheenRoughnessFactor", double{material.sheen_roughness}}},
            {{"sheenColorTexture", &material.sheen_texture},
             {"sheenRoughnessTexture", &material.sheen_roughness_texture}});
    if (material.film > 0.0f)
        set("KHR_materials_iridescence",
            {{"iridescenceFactor", double{material.film}},
             {"iridescenceIor", double{material.film_ior}},
             {"iridescenceThicknessMinimum", double{material.film_thickness_at_0}},
             {"iridescenceThicknessMaximum", double{material.film_thickness_at_1}}},
            {{"iridescenceTexture", &material.film_texture},
             {"iridescenceThicknessTexture", &material.film_thickness_texture}});
    if (material.anisotropy > 0.0f)
        set("KHR_materials_anisotropy",
            {{"anisotropyStrength", double{material.anisotropy}},
             {"anisotropyRotation", double{material.anisotropy_rotation}}},
            {{"anisotropyTexture", &material.anisotropy_texture}});
    if (material.ior != 1.5f)
        set("KHR_materials_ior", {{"ior", double{material.ior}}});
    if (material.specular_strength != 1.0f || material.specular_tint != glm::vec3(1.0f) ||
        material.specular_strength_texture || material.specular_tint_texture)
        set("KHR_materials_specular",
            {{"specularFactor", double{material.specular_strength}},
             {"specularColorFactor", material.specular_tint}},
            {{"specularTexture", &material.specular_strength_texture},
             {"specularColorTexture", &material.specular_tint_texture}});
    if (material.model == MaterialModel::Unlit)
        set("KHR_materials_unlit", Json::Object{});
    return result;
}

} // namespace relumine::mesh
