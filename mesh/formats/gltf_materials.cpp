#include "mesh/formats/gltf_materials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "mesh/formats/clamped.h"
#include "mesh/materials/material_members.h"
#include "mesh/text_reader.h"

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
    [[nodiscard]] std::optional<std::uint32_t> source(const Json& texture);
    [[nodiscard]] std::optional<std::uint32_t> image(std::uint64_t index);
    template<class Decode>
    [[nodiscard]] std::optional<Texture> decoded(std::uint64_t index, const Decode& decode);
    void join_uv_sets(Material& material);
    double alpha_of_both(const Json& description, double of_extension);
    void read_specular_glossiness(const Json& description, Material& material);
    void read_emission(const Json& description, Material& material);
    void read_glass(const Json& extensions, Material& material);
    void read_alpha(const Json& description, double alpha, Material& material);
    [[nodiscard]] std::optional<std::uint32_t> alpha_of(std::uint32_t texture);
    [[nodiscard]] std::optional<TextureSlot> alpha_slot(const Json& parent, const char* key);
    [[nodiscard]] std::optional<TextureSlot> normal_map(const Json& parent, const char* key,
                                                        float& scale);
    void read_specular(const Json& extensions, Material& material);
    void read_coat(const Json& extension, Material& material);
    void read_sheen(const Json& extension, Material& material);
    void read_film(const Json& extension, Material& material);
    void read_anisotropy(const Json& extension, Material& material);
    void read_diffuse_transmission(const Json& extension, Material& material);
    void read_milk(const Json& extensions, Material& material);
    double in_range(const char* key, double value, double low, double high);
    float fraction(const Json& object, const char* key, float fallback);
    std::vector<double> factors(const Json& object, const char* key, std::vector<double> fallback,
                                double most = 1.0);

    Document& document_;
    /// The material that is being read
    std::string name_;
    Materials result_;
    /// Texture of each image. Empty: the image is missing.
    std::map<std::uint64_t, std::optional<std::uint32_t>> textures_;
    /// Image of each texture.
    std::map<std::uint32_t, std::uint64_t> images_;
    /// Texture of the alpha of each texture. Empty: its image has none.
    std::map<std::uint32_t, std::optional<std::uint32_t>> alphas_;
    ImageBudget budget_;
};

/// Decodes an image. Returns nothing if its file does not exist, or, with a warning, if it cannot
/// be read.
template<class Decode>
std::optional<Texture> MaterialReader::decoded(std::uint64_t index, const Decode& decode) {
    const Json& description = document_.element("images", index);
    const std::string uri = text(description, "uri");
    const std::string name = !uri.empty() && !uri.starts_with("data:")
                                 ? uri
                                 : text(description, "name", fmt::format("image {}", index));
    try {
        std::optional<std::vector<std::byte>> fetched;
        if (!uri.empty() && !(fetched = document_.fetch(uri))) {
            result_.missing.push_back(uri);
            return std::nullopt;
        }
        Texture texture = decode(fetched ? std::span<const std::byte>(*fetched)
                                         : document_.view(whole(description, "bufferView")),
                                 VOrigin::Top, budget_);
        texture.name = name;
        return texture;
    } catch (const std::runtime_error& error) {
        result_.warnings.push_back(fmt::format("the image {} is left out: {}", name, error.what()));
        return std::nullopt;
    }
}

/// Returns the texture of an image. Each image is decoded once, and only if a material uses it.
std::optional<std::uint32_t> MaterialReader::image(std::uint64_t index) {
    if (const auto found = textures_.find(index); found != textures_.end())
        return found->second;
    std::optional<std::uint32_t> place;
    if (std::optional<Texture> texture = decoded(index, decode_texture)) {
        place = static_cast<std::uint32_t>(result_.textures.size());
        result_.textures.push_back(std::move(*texture));
        images_.emplace(*place, index);
    }
    textures_.emplace(index, place);
    return place;
}

/// Returns the texture that a "texture" of the file shows. The images of extensions come before
/// their twin in another format.
std::optional<std::uint32_t> MaterialReader::source(const Json& texture) {
    const Json& extensions = child(texture, "extensions");
    const Json& avif = child(extensions, "EXT_texture_avif");
    const Json& webp = child(extensions, "EXT_texture_webp");
    for (const Json* holder : {&avif, &webp, &texture})
        if (holder->find("source"))
            if (const auto place = image(whole(*holder, "source")))
                return place;
    return std::nullopt;
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
    if (info.size() == 0)
        return std::nullopt;
    const Json& texture = document_.element("textures", whole(info, "index"));
    const std::optional<std::uint32_t> index = source(texture);
    if (!index)
        return std::nullopt;
    TextureSlot slot{.texture = *index, .is_srgb = is_srgb};
    if (texture.find("sampler")) {
        const Json& sampler = document_.element("samplers", whole(texture, "sampler"));
        slot.wrap = {wrap_mode(sampler, "wrapS"), wrap_mode(sampler, "wrapT")};
    }
    std::uint64_t uv_set = whole(info, "texCoord", 0);
    if (const Json& transform = child(child(info, "extensions"), "KHR_texture_transform");
        transform.size() != 0) {
        // The extension defines uv' = translation * rotation * scale * uv, with a rotation from
        // v to u.
        const std::vector<double> scale = numbers(transform, "scale", {1.0, 1.0});
        const std::vector<double> offset = numbers(transform, "offset", {0.0, 0.0});
        const double angle = number(transform, "rotation", 0.0);
        const double c = std::cos(angle), s = std::sin(angle);
        slot.uv_from_mesh_uv = glm::mat2(c * scale[0], -s * scale[0], s * scale[1], c * scale[1]);
        slot.uv_offset = glm::vec2(offset[0], offset[1]);
        uv_set = whole(transform, "texCoord", uv_set);
    }
    if (uv_set > std::numeric_limits<std::uint32_t>::max())
        throw std::runtime_error(fmt::format("expected a number of a TEXCOORD, got {}", uv_set));
    slot.uv_set = static_cast<std::uint32_t>(uv_set);
    return slot;
}

/// A mesh has two uvs for each vertex. A texture of a third set is left out.
void MaterialReader::join_uv_sets(Material& material) {
    auto& sets = result_.uv_sets.back();
    for (const MaterialMember& member : MaterialMembers) {
        const auto place_of_slot = member.texture();
        if (place_of_slot == nullptr || !(material.*place_of_slot))
            continue;
        std::optional<TextureSlot>& slot = material.*place_of_slot;
        const std::uint32_t own = slot->uv_set;
        const auto place = std::find_if(sets.begin(), sets.end(),
                                        [&](const auto& set) { return !set || *set == own; });
        if (place != sets.end()) {
            *place = own;
            slot->uv_set = static_cast<std::uint32_t>(place - sets.begin());
            continue;
        }
        result_.warnings.push_back(
            fmt::format("the material {} has textures in TEXCOORD_{}, TEXCOORD_{} and TEXCOORD_{}; "
                        "two sets are read: its {} is left out",
                        material.name, *sets[0], *sets[1], own, member.name_in_file()));
        slot.reset();
    }
}

double MaterialReader::in_range(const char* key, double value, double low, double high) {
    return clamped("material " + name_, key, value, low, high, result_.warnings);
}

float MaterialReader::fraction(const Json& object, const char* key, float fallback) {
    return static_cast<float>(in_range(key, number(object, key, double{fallback}), 0.0, 1.0));
}

/// Returns the factors of a colour.
std::vector<double> MaterialReader::factors(const Json& object, const char* key,
                                            std::vector<double> fallback, double most) {
    std::vector<double> values = numbers(object, key, std::move(fallback));
    for (double& value : values)
        value = in_range(key, value, 0.0, most);
    return values;
}

/// Returns the alpha of a material that says it twice. That of KHR_materials_pbrSpecularGlossiness
/// counts. But where that is 1, a surface that is to be blended would be opaque: then it is the
/// other one. Assimp writes opacity there alone.
double MaterialReader::alpha_of_both(const Json& description, double of_extension) {
    const double other =
        factors(child(description, "pbrMetallicRoughness"), "baseColorFactor", {1.0, 1.0, 1.0, 1.0})
            .at(3);
    if (of_extension < 1.0 || other == 1.0 || text(description, "alphaMode", "OPAQUE") != "BLEND")
        return of_extension;
    result_.warnings.push_back(fmt::format(
        "the material {} is to be blended, with an alpha of 1 in "
        "KHR_materials_pbrSpecularGlossiness and {:.3g} in baseColorFactor: it has {:.3g}",
        name_, other, other));
    return other;
}

/// Reads KHR_materials_pbrSpecularGlossiness. Glossiness times the texture's alpha becomes a
/// texture of roughness.
void MaterialReader::read_specular_glossiness(const Json& description, Material& material) {
    const Json& extension =
        child(child(description, "extensions"), "KHR_materials_pbrSpecularGlossiness");
    const std::vector<double> diffuse = factors(extension, "diffuseFactor", {1.0, 1.0, 1.0, 1.0});
    const std::vector<double> specular = factors(extension, "specularFactor", {1.0, 1.0, 1.0});
    const float glossiness = fraction(extension, "glossinessFactor", 1.0f);
    material.model = MaterialModel::SpecularGlossiness;
    material.base_color = glm::vec3(diffuse[0], diffuse[1], diffuse[2]);
    material.base_color_texture = slot(extension, "diffuseTexture", true);
    read_alpha(description, alpha_of_both(description, diffuse[3]), material);
    material.specular = glm::vec3(specular[0], specular[1], specular[2]);
    material.specular_texture = slot(extension, "specularGlossinessTexture", true);
    material.roughness = 1.0f - glossiness;
    if (!material.specular_texture)
        return;
    std::optional<Texture> texture =
        decoded(images_.at(material.specular_texture->texture), decode_alpha_texture);
    if (!texture) // gone since its colours were read
        return;
    for (auto& texel : texture->texels)
        texel.fill(static_cast<std::uint8_t>(
            std::lround(255.0f - glossiness * static_cast<float>(texel[0]))));
    texture->name += " (roughness)";
    material.roughness = 1.0f;
    material.metallic_roughness_texture = material.specular_texture;
    material.metallic_roughness_texture->is_srgb = false;
    material.metallic_roughness_texture->texture =
        static_cast<std::uint32_t>(result_.textures.size());
    result_.textures.push_back(std::move(*texture));
}

/// Reads what the surface gives of its own.
void MaterialReader::read_emission(const Json& description, Material& material) {
    // Pictures of such lamps, with room for exposure, stay within what a float holds.
    constexpr double Strongest = 1e9;
    // Beyond 1 is beyond glTF, and what tools write that have no strength.
    const std::vector<double> factor =
        factors(description, "emissiveFactor", {0.0, 0.0, 0.0}, Strongest);
    const double brightest = std::max({factor[0], factor[1], factor[2], 1.0});
    const double strength =
        in_range("emissiveStrength",
                 number(child(child(description, "extensions"), "KHR_materials_emissive_strength"),
                        "emissiveStrength", 1.0),
                 0.0, Strongest / brightest);
    material.emission = glm::vec3(strength * factor[0], strength * factor[1], strength * factor[2]);
    if (material.emission != glm::vec3(0.0f))
        material.emission_texture = slot(description, "emissiveTexture", true);
}

/// Returns the texture of another texture's alpha. None where that is 1 everywhere.
std::optional<std::uint32_t> MaterialReader::alpha_of(std::uint32_t texture) {
    if (const auto found = alphas_.find(texture); found != alphas_.end())
        return found->second;
    std::optional<std::uint32_t> place;
    std::optional<Texture> alpha = decoded(images_.at(texture), decode_alpha_texture);
    if (alpha && std::any_of(alpha->texels.begin(), alpha->texels.end(),
                             [](const auto& texel) { return texel[0] != 255; })) {
        place = static_cast<std::uint32_t>(result_.textures.size());
        alpha->name += " (alpha)";
        result_.textures.push_back(std::move(*alpha));
    }
    alphas_.emplace(texture, place);
    return place;
}

/// Reads what alpha does. Its texture is that of the base colour.
void MaterialReader::read_alpha(const Json& description, double alpha, Material& material) {
    material.is_double_sided = flag(description, "doubleSided");
    const std::string mode = text(description, "alphaMode", "OPAQUE");
    if (mode == "OPAQUE")
        return;
    if (mode != "MASK" && mode != "BLEND")
        throw std::runtime_error(
            fmt::format("expected OPAQUE, MASK or BLEND as \"alphaMode\", got {}", excerpt(mode)));
    material.alpha_mode = mode == "MASK" ? AlphaMode::Mask : AlphaMode::Blend;
    material.alpha = static_cast<float>(alpha);
    const double cutoff = number(description, "alphaCutoff", 0.5);
    if (!(cutoff >= 0.0 && cutoff <= std::numeric_limits<float>::max()))
        throw std::runtime_error(
            fmt::format("expected a number of 0 or more as \"alphaCutoff\", got {:g}", cutoff));
    material.alpha_cutoff = static_cast<float>(cutoff);
    if (!material.base_color_texture)
        return;
    if (const auto texture = alpha_of(material.base_color_texture->texture)) {
        material.alpha_texture = material.base_color_texture;
        material.alpha_texture->texture = *texture;
        material.alpha_texture->is_srgb = false;
    }
}

/// Reads KHR_materials_transmission, KHR_materials_volume and KHR_materials_dispersion.
void MaterialReader::read_glass(const Json& extensions, Material& material) {
    const Json& transmission = child(extensions, "KHR_materials_transmission");
    material.transmission = fraction(transmission, "transmissionFactor", 0.0f);
    if (material.transmission == 0.0f)
        return;
    material.transmission_texture = slot(transmission, "transmissionTexture", false);
    const Json& volume = child(extensions, "KHR_materials_volume");
    const auto length = [&](const char* key, double fallback) {
        const double value = number(volume, key, fallback);
        if (!(value >= 0.0))
            throw std::runtime_error(
                fmt::format("expected a number of 0 or more as \"{}\", got {:g}", key, value));
        return static_cast<float>(value);
    };
    constexpr double Endless = std::numeric_limits<double>::infinity();
    material.thickness = length("thicknessFactor", 0.0);
    material.attenuation_distance =
        std::max(length("attenuationDistance", Endless), std::numeric_limits<float>::min());
    const std::vector<double> color = factors(volume, "attenuationColor", {1.0, 1.0, 1.0});
    material.attenuation_color = glm::vec3(color[0], color[1], color[2]);
    if (material.thickness > 0.0f)
        material.dispersion = static_cast<float>(in_range(
            "dispersion", number(child(extensions, "KHR_materials_dispersion"), "dispersion", 0.0),
            0.0, std::numeric_limits<float>::max()));
}

/// Returns the alpha of a texture as grey.
std::optional<TextureSlot> MaterialReader::alpha_slot(const Json& parent, const char* key) {
    std::optional<TextureSlot> result = slot(parent, key, false);
    if (!result)
        return std::nullopt;
    std::optional<Texture> texture = decoded(images_.at(result->texture), decode_alpha_texture);
    if (!texture) // gone since its colours were read
        return std::nullopt;
    texture->name += " (alpha)";
    result->texture = static_cast<std::uint32_t>(result_.textures.size());
    result_.textures.push_back(std::move(*texture));
    return result;
}

/// Returns a normal map, unless its scale makes it flat.
std::optional<TextureSlot> MaterialReader::normal_map(const Json& parent, const char* key,
                                                      float& scale) {
    scale = static_cast<float>(number(child(parent, key), "scale", 1.0));
    if (!std::isfinite(scale))
        throw std::runtime_error(
            fmt::format("expected a finite \"scale\" of \"{}\", got {}", key, scale));
    return scale == 0.0f ? std::nullopt : slot(parent, key, false);
}

/// Reads KHR_materials_ior and KHR_materials_specular.
void MaterialReader::read_specular(const Json& extensions, Material& material) {
    const double ior = number(child(extensions, "KHR_materials_ior"), "ior", 1.5);
    if (ior != 0.0 && !(ior >= 1.0 && ior <= 1e6))
        throw std::runtime_error(fmt::format("expected 0, or 1 to 1e6, as \"ior\", got {}", ior));
    material.ior = static_cast<float>(ior);
    const Json& specular = child(extensions, "KHR_materials_specular");
    material.specular_strength = fraction(specular, "specularFactor", 1.0f);
    material.specular_strength_texture = alpha_slot(specular, "specularTexture");
    const std::vector<double> tint = factors(specular, "specularColorFactor", {1.0, 1.0, 1.0}, 1e6);
    material.specular_tint = glm::vec3(tint[0], tint[1], tint[2]);
    material.specular_tint_texture = slot(specular, "specularColorTexture", true);
}

void MaterialReader::read_coat(const Json& extension, Material& material) {
    material.coat = fraction(extension, "clearcoatFactor", 0.0f);
    if (material.coat == 0.0f)
        return;
    material.coat_texture = slot(extension, "clearcoatTexture", false);
    material.coat_roughness = fraction(extension, "clearcoatRoughnessFactor", 0.0f);
    material.coat_roughness_texture = slot(extension, "clearcoatRoughnessTexture", false);
    material.coat_normal_texture =
        normal_map(extension, "clearcoatNormalTexture", material.coat_normal_scale);
}

void MaterialReader::read_sheen(const Json& extension, Material& material) {
    const std::vector<double> color = factors(extension, "sheenColorFactor", {0.0, 0.0, 0.0});
    material.sheen = glm::vec3(color[0], color[1], color[2]);
    if (material.sheen == glm::vec3(0.0f))
        return;
    material.sheen_texture = slot(extension, "sheenColorTexture", true);
    material.sheen_roughness = fraction(extension, "sheenRoughnessFactor", 0.0f);
    material.sheen_roughness_texture = alpha_slot(extension, "sheenRoughnessTexture");
}

/// Reads KHR_materials_iridescence.
void MaterialReader::read_film(const Json& extension, Material& material) {
    material.film = fraction(extension, "iridescenceFactor", 0.0f);
    if (material.film == 0.0f)
        return;
    constexpr double Any = std::numeric_limits<float>::max();
    const auto limited = [&](const char* key, double fallback, double least, double most) {
        return static_cast<float>(in_range(key, number(extension, key, fallback), least, most));
    };
    material.film_texture = slot(extension, "iridescenceTexture", false);
    material.film_ior = limited("iridescenceIor", 1.3, 1.0, 1e6);
    material.film_thickness_at_0 = limited("iridescenceThicknessMinimum", 100.0, 0.0, Any);
    material.film_thickness_at_1 = limited("iridescenceThicknessMaximum", 400.0, 0.0, Any);
    material.film_thickness_texture = slot(extension, "iridescenceThicknessTexture", false);
}

/// Reads KHR_materials_anisotropy.
void MaterialReader::read_anisotropy(const Json& extension, Material& material) {
    material.anisotropy = fraction(extension, "anisotropyStrength", 0.0f);
    if (material.anisotropy == 0.0f)
        return;
    const double rotation = number(extension, "anisotropyRotation", 0.0);
    if (!std::isfinite(rotation))
        throw std::runtime_error(
            fmt::format("expected a finite \"anisotropyRotation\", got {}", rotation));
    material.anisotropy_rotation =
        static_cast<float>(std::remainder(rotation, 2.0 * std::numbers::pi));
    material.anisotropy_texture = slot(extension, "anisotropyTexture", false);
}

/// Reads KHR_materials_volume_scatter of what is_milky(): the light that goes in comes out where it
/// went in, in the colour of a body without end.
void MaterialReader::read_milk(const Json& extensions, Material& material) {
    const Json& scattering = child(extensions, "KHR_materials_volume_scatter");
    const char* const name =
        scattering.find("multiscatterColor") ? "multiscatterColor" : "multiscatterColorFactor";
    const std::vector<double> color = factors(scattering, name, {0.0, 0.0, 0.0});
    const float part = glm::mix(material.diffuse_transmission, 1.0f, material.transmission);
    material.base_color =
        glm::mix(material.base_color, glm::vec3(color[0], color[1], color[2]), part);
    if (part == 1.0f)
        material.base_color_texture = slot(scattering, "multiscatterColorTexture", false);
    material.transmission = material.diffuse_transmission = material.thickness = 0.0f;
    material.dispersion = 0.0f;
}

/// Reads KHR_materials_diffuse_transmission.
void MaterialReader::read_diffuse_transmission(const Json& extension, Material& material) {
    material.diffuse_transmission = fraction(extension, "diffuseTransmissionFactor", 0.0f);
    if (material.diffuse_transmission == 0.0f)
        return;
    material.diffuse_transmission_texture = alpha_slot(extension, "diffuseTransmissionTexture");
    const std::vector<double> color =
        factors(extension, "diffuseTransmissionColorFactor", {1.0, 1.0, 1.0});
    material.diffuse_transmission_color = glm::vec3(color[0], color[1], color[2]);
    material.diffuse_transmission_color_texture =
        slot(extension, "diffuseTransmissionColorTexture", true);
}

Material MaterialReader::material(const Json& description, std::size_t index) {
    const Json& pbr = child(description, "pbrMetallicRoughness");
    const Json& extensions = child(description, "extensions");
    Material material;
    material.name = text(description, "name", fmt::format("material {}", index));
    material.times_vertex_color = true;
    const bool is_unlit = extensions.find("KHR_materials_unlit") != nullptr;
    if (!is_unlit) {
        read_emission(description, material);
        material.normal_texture = normal_map(description, "normalTexture", material.normal_scale);
    }
    if (extensions.find("KHR_materials_pbrSpecularGlossiness") && !is_unlit) {
        read_specular_glossiness(description, material);
        return material;
    }
    const std::vector<double> base = factors(pbr, "baseColorFactor", {1.0, 1.0, 1.0, 1.0});
    material.base_color = glm::vec3(base[0], base[1], base[2]);
    material.base_color_texture = slot(pbr, "baseColorTexture", true);
    read_alpha(description, base[3], material);
    if (is_unlit) {
        material.model = MaterialModel::Unlit;
        return material;
    }
    material.model = MaterialModel::MetallicRoughness;
    material.metallic = fraction(pbr, "metallicFactor", 1.0f);
    material.roughness = fraction(pbr, "roughnessFactor", 1.0f);
    material.metallic_roughness_texture = slot(pbr, "metallicRoughnessTexture", false);
    read_specular(extensions, material);
    read_coat(child(extensions, "KHR_materials_clearcoat"), material);
    read_sheen(child(extensions, "KHR_materials_sheen"), material);
    read_film(child(extensions, "KHR_materials_iridescence"), material);
    read_anisotropy(child(extensions, "KHR_materials_anisotropy"), material);
    read_diffuse_transmission(child(extensions, "KHR_materials_diffuse_transmission"), material);
    read_glass(extensions, material);
    if (is_milky(description))
        read_milk(extensions, material);
    return material;
}

Materials MaterialReader::read() {
    for (std::size_t i = 0; i < document_.count("materials"); ++i) {
        result_.uv_sets.emplace_back();
        std::string name = fmt::format("material {}", i);
        try {
            const Json& description = document_.element("materials", i);
            name = name_ = text(description, "name", name);
            Material read = material(description, i);
            join_uv_sets(read);
            result_.materials.push_back(std::move(read));
        } catch (const std::runtime_error& error) {
            result_.materials.resize(i);
            result_.materials.push_back(unreadable_material(name));
            result_.warnings.push_back(fmt::format("the material {} is grey, since it cannot be "
                                                   "read: material {}: {}",
                                                   name, i, error.what()));
        }
    }
    return std::move(result_);
}

} // namespace

bool is_milky(const Json& material) {
    const Json& extensions = child(material, "extensions");
    const Json& volume = child(extensions, "KHR_materials_volume");
    const Json& glass = child(extensions, "KHR_materials_transmission");
    const Json& leaf = child(extensions, "KHR_materials_diffuse_transmission");
    if (extensions.find("KHR_materials_volume_scatter") == nullptr ||
        glass.find("transmissionTexture") || leaf.find("diffuseTransmissionTexture"))
        return false;
    const double most_through = std::max(number(glass, "transmissionFactor", 0.0),
                                         number(leaf, "diffuseTransmissionFactor", 0.0));
    if (most_through < 1.0 &&
        (most_through == 0.0 || child(material, "pbrMetallicRoughness").find("baseColorTexture")))
        return false;
    const std::vector<double> color = numbers(volume, "attenuationColor", {1.0, 1.0, 1.0});
    const double brightest = *std::max_element(color.begin(), color.end());
    const double lengths =
        number(volume, "thicknessFactor", 0.0) / number(volume, "attenuationDistance", 1e30);
    constexpr double MostPassed = 0.05;
    return std::pow(std::max(brightest, 0.0), lengths) < MostPassed;
}

Materials read_materials(Document& document) {
    return MaterialReader(document).read();
}

} // namespace relumine::mesh::gltf
