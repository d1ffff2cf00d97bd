#include "prt/glossy/surface_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <glm/common.hpp>

#include "mesh/subject.h"
#include "prt/glossy/lobe_list.h"
#include "prt/glossy/sheen_lobe.h"
#include "prt/glossy/thin_film.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/texture_view.h"

namespace relumine::prt {

namespace {

/// A point of a mesh, and the material there.
struct MaterialPoint {
    const mesh::TriangleMesh& mesh;
    const mesh::Material& material;
    MeshPoint at;
    const TextureView* view;

    [[nodiscard]] glm::vec3 texel(const mesh::TextureSlot& slot) const {
        if (view != nullptr)
            return view->maps->sample(slot, uv_at(mesh, at, slot.uv_set),
                                      view->footprint(mesh, at, slot.uv_set));
        return mesh::sample(mesh.textures[slot.texture], slot, uv_at(mesh, at, slot.uv_set));
    }
    /// Returns a value times its texture, if there is one.
    [[nodiscard]] glm::vec3 textured(const glm::vec3& value,
                                     const std::optional<mesh::TextureSlot>& slot) const {
        return slot ? value * texel(*slot) : value;
    }
    [[nodiscard]] glm::vec3 textured(float value,
                                     const std::optional<mesh::TextureSlot>& slot) const {
        return textured(glm::vec3(value), slot);
    }
    /// Returns how much of the surface is bare metal.
    [[nodiscard]] float metallic() const {
        float result = material.metallic;
        if (material.metallic_roughness_texture)
            result *= texel(*material.metallic_roughness_texture).b;
        return textured(result, material.metallic_texture).r;
    }
    /// Returns the part of the diffuse light that goes to the other side.
    [[nodiscard]] float diffuse_transmission() const {
        return material.diffuse_transmission == 0.0f
                   ? 0.0f
                   : textured(material.diffuse_transmission, material.diffuse_transmission_texture)
                         .r;
    }
    /// Returns what of the light that meets the surface is neither metal's nor glass's.
    [[nodiscard]] float diffuse_part() const {
        return (1.0f - metallic()) *
               (1.0f - textured(material.transmission, material.transmission_texture).r);
    }
    /// Returns the base colour, not limited where vertices are brighter than 1.
    [[nodiscard]] glm::vec3 base() const {
        const glm::vec3 base = textured(material.base_color, material.base_color_texture);
        return material.times_vertex_color && !mesh.colors.empty()
                   ? base * value_at(mesh, mesh.colors, at)
                   : base;
    }
};

/// F0 of glass of an index of refraction; 0 stands for an infinite one.
float f0_of(float ior) {
    if (ior == mesh::Material().ior)
        return DielectricF0;
    const float root = (ior - 1.0f) / (ior + 1.0f);
    return root * root;
}

void add_layers(const MaterialPoint& point, Surface& surface) {
    const mesh::Material& material = point.material;
    if (material.coat > 0.0f) {
        surface.coat = point.textured(material.coat, material.coat_texture).r;
        surface.coat_roughness =
            point.textured(material.coat_roughness, material.coat_roughness_texture).g;
    }
    if (material.sheen != glm::vec3(0.0f)) {
        surface.sheen = point.textured(material.sheen, material.sheen_texture);
        surface.sheen_roughness =
            point.textured(material.sheen_roughness, material.sheen_roughness_texture).r;
    }
    if (material.film > 0.0f) {
        surface.film = point.textured(material.film, material.film_texture).r;
        surface.film_ior = material.film_ior;
        const auto& thickness = material.film_thickness_texture;
        surface.film_thickness =
            glm::mix(material.film_thickness_at_0, material.film_thickness_at_1,
                     thickness ? point.texel(*thickness).g : 1.0f);
    }
}

/// Stretches a highlight along the tangent, as the material turns it.
void add_anisotropy(const MaterialPoint& point, Surface& surface) {
    const mesh::Material& material = point.material;
    const glm::vec4 tangent = tangent_at(point.mesh, point.at);
    if (material.anisotropy == 0.0f || glm::vec3(tangent) == glm::vec3(0.0f))
        return;
    surface.anisotropy = material.anisotropy;
    glm::vec2 way(1.0f, 0.0f);
    if (material.anisotropy_texture) {
        const glm::vec3 texel = point.texel(*material.anisotropy_texture);
        surface.anisotropy *= texel.b;
        const glm::vec2 own(2.0f * texel.r - 1.0f, 2.0f * texel.g - 1.0f);
        if (own != glm::vec2(0.0f))
            way = glm::normalize(own);
    }
    const float c = std::cos(material.anisotropy_rotation),
                s = std::sin(material.anisotropy_rotation);
    const glm::vec3 along(tangent);
    const glm::vec3 bitangent = tangent.w * glm::cross(shading_normal(point.mesh, point.at), along);
    surface.tangent = (c * way.x - s * way.y) * along + (s * way.x + c * way.y) * bitangent;
}

/// A surface without its emission.
Surface reflecting(const MaterialPoint& point, GgxForm form) {
    const mesh::Material& material = point.material;
    glm::vec3 base = point.base();
    if (material.times_vertex_color)
        base = glm::clamp(base, 0.0f, 1.0f);
    if (material.model == mesh::MaterialModel::Phong) {
        if (material.specular == glm::vec3(0.0f))
            return {.albedo = base};
        return {.albedo = base,
                .specular = point.textured(material.specular, material.specular_texture),
                .highlight = Highlight::BlinnPhong,
                .roughness_or_exponent = material.exponent};
    }
    if (material.model == mesh::MaterialModel::Measured) {
        Surface surface = measured_surface(material.measured);
        surface.albedo = base;
        surface.specular = material.specular;
        return surface;
    }
    const Highlight highlight = form == GgxForm::Whole ? Highlight::GgxWhole : Highlight::Ggx;
    float roughness = material.roughness;
    if (const auto& slot = material.metallic_roughness_texture)
        roughness *= point.texel(*slot).g;
    roughness = point.textured(roughness, material.roughness_texture).r;
    if (material.model == mesh::MaterialModel::SpecularGlossiness) {
        const glm::vec3 specular = point.textured(material.specular, material.specular_texture);
        const float left = 1.0f - std::max({specular.r, specular.g, specular.b});
        return {.albedo = form == GgxForm::Whole ? base : base * left,
                .specular = specular,
                .highlight = highlight,
                .roughness_or_exponent = roughness};
    }
    const float metallic = point.metallic();
    const float strength =
        point.textured(material.specular_strength, material.specular_strength_texture).r;
    const glm::vec3 dielectric =
        dielectric_f0(material.ior, strength,
                      point.textured(material.specular_tint, material.specular_tint_texture));
    Surface result{.albedo = base * point.diffuse_part() * (1.0f - point.diffuse_transmission()),
                   .specular = glm::mix(dielectric, base, metallic),
                   .highlight = highlight,
                   .roughness_or_exponent = roughness,
                   .metallic = form == GgxForm::Whole ? metallic : 0.0f,
                   .dielectric_f0 = std::max({dielectric.r, dielectric.g, dielectric.b}),
                   .dielectric_f90 = strength};
    if (material.diffuse_transmission > 0.0f) {
        // The light of a vertex is its radiance over its albedo, and its other side asks for it.
        constexpr float LeastAlbedo = 1e-4f;
        result.albedo = glm::max(result.albedo, LeastAlbedo);
    }
    add_layers(point, result);
    add_anisotropy(point, result);
    if (!has_highlight(material))
        result.highlight = Highlight::None;
    return result;
}

} // namespace

glm::vec3 dielectric_f0(float ior, float strength, const glm::vec3& tint) {
    return strength * glm::min(f0_of(ior) * tint, 1.0f);
}

Surface surface_at(const mesh::TriangleMesh& mesh, std::uint32_t triangle,
                   const glm::vec2& barycentric, GgxForm form, const TextureView* view) {
    if (mesh.triangle_materials.empty())
        return {};
    const mesh::Material& material = mesh.materials[mesh.triangle_materials[triangle]];
    const MaterialPoint point{
        .mesh = mesh, .material = material, .at = {triangle, barycentric}, .view = view};
    if (material.model == mesh::MaterialModel::Unlit)
        return {.albedo = glm::vec3(0.0f), .emission = glm::max(point.base(), 0.0f)};
    Surface surface = reflecting(point, form);
    if (material.emission != glm::vec3(0.0f))
        surface.emission = point.textured(material.emission, material.emission_texture);
    return surface;
}

glm::vec3 emission_at(const mesh::TriangleMesh& mesh, std::uint32_t triangle,
                      const glm::vec2& barycentric) {
    if (mesh.triangle_materials.empty())
        return glm::vec3(0.0f);
    const mesh::Material& material = mesh.materials[mesh.triangle_materials[triangle]];
    if (material.model == mesh::MaterialModel::Unlit || material.emission == glm::vec3(0.0f))
        return glm::vec3(0.0f);
    const MaterialPoint point{
        .mesh = mesh, .material = material, .at = {triangle, barycentric}, .view = nullptr};
    return point.textured(material.emission, material.emission_texture);
}

glm::vec3 passed_on_at(const mesh::TriangleMesh& mesh, const MeshPoint& at,
                       const TextureView* view) {
    if (!passes_light_on(mesh, at.triangle))
        return glm::vec3(0.0f);
    const mesh::Material& material = mesh.materials[mesh.triangle_materials[at.triangle]];
    const MaterialPoint point{.mesh = mesh, .material = material, .at = at, .view = view};
    return point.diffuse_part() * point.diffuse_transmission() *
           point.textured(material.diffuse_transmission_color,
                          material.diffuse_transmission_color_texture);
}

bool passes_light_on(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    return !mesh.triangle_materials.empty() &&
           mesh.materials[mesh.triangle_materials[triangle]].diffuse_transmission > 0.0f;
}

bool passes_light_on(const mesh::TriangleMesh& mesh) {
    return std::any_of(mesh.materials.begin(), mesh.materials.end(),
                       [](const mesh::Material& own) { return own.diffuse_transmission > 0.0f; });
}

Surface measured_surface(std::shared_ptr<const mesh::BrdfTable> table) {
    Surface surface{.albedo = glm::min(table->lambert(), 1.0f),
                    .specular = glm::vec3(1.0f),
                    .highlight = Highlight::Measured,
                    .roughness_or_exponent = table->roughness()};
    surface.table = std::move(table);
    return surface;
}

bool shows_light(const mesh::TriangleMesh& mesh, std::size_t triangle) {
    if (mesh.triangle_materials.empty())
        return true;
    const mesh::Material& material = mesh.materials[mesh.triangle_materials[triangle]];
    return material.model != mesh::MaterialModel::Unlit && !mesh::is_unseen(material);
}

bool has_highlight(const mesh::Material& material) {
    if (material.model == mesh::MaterialModel::Phong)
        return material.specular != glm::vec3(0.0f);
    if (material.model == mesh::MaterialModel::MetallicRoughness && material.metallic == 0.0f &&
        material.specular_strength == 0.0f && material.transmission == 0.0f)
        return material.coat > 0.0f || material.sheen != glm::vec3(0.0f) || material.film > 0.0f;
    return material.model != mesh::MaterialModel::Unlit;
}

mesh::Material material_of(const Surface& surface) {
    mesh::Material material{.name = "option"};
    if (surface.highlight == Highlight::None)
        return material;
    material.base_color = surface.albedo;
    material.specular = surface.specular;
    if (surface.highlight == Highlight::Measured) {
        material.model = mesh::MaterialModel::Measured;
        material.measured = surface.table;
    } else if (facts_of(surface.highlight).is_roughness) {
        material.model = mesh::MaterialModel::SpecularGlossiness;
        material.roughness = surface.roughness_or_exponent;
    } else {
        material.exponent = surface.roughness_or_exponent;
    }
    return material;
}

/// The mean cosine of the directions from which a surface is seen.
constexpr float MeanCosine = 0.5f;

Surface without_highlight(Surface surface) {
    if (surface.sheen != glm::vec3(0.0f)) {
        const float albedo = sheen_albedo(surface.sheen_roughness, MeanCosine);
        const glm::vec3& color = surface.sheen;
        surface.albedo *= 1.0f - albedo * std::max({color.r, color.g, color.b});
        surface.albedo += albedo * color;
    }
    surface.coat = 0.0f;
    surface.sheen = glm::vec3(0.0f);
    const glm::vec3 f0 =
        has_film(surface) ? FilmHighlight(surface, MeanCosine).at(MeanCosine) : surface.specular;
    if (facts_of(surface.highlight).has_fresnel)
        surface.albedo = glm::min(surface.albedo + glm::max(f0 - DielectricF0, 0.0f), 1.0f);
    surface.film = surface.anisotropy = 0.0f;
    surface.tangent = glm::vec3(0.0f);
    if (surface.highlight == Highlight::Measured)
        surface.albedo = glm::min(
            surface.albedo + surface.specular * surface.table->rest_albedo(MeanCosine), 1.0f);
    surface.table.reset();
    surface.highlight = Highlight::None;
    surface.metallic = 0.0f;
    return surface;
}

void widen(Surface& surface, float normal_spread, float of_coat) {
    if (surface.highlight == Highlight::None || surface.highlight == Highlight::Measured)
        return;
    // Of facets evenly in a disc nine tenths are within 1.8 of their variance, of GGX's within
    // 9 alpha^2: its tails are long, and of as much variance they would be far too wide.
    constexpr float OfSpread = 1.8f / 9.0f;
    const auto widened = [](float roughness, float spread) {
        const float alpha = ggx_alpha(roughness);
        return std::min(std::sqrt(std::sqrt(alpha * alpha + OfSpread * spread)), 1.0f);
    };
    if (surface.coat > 0.0f && of_coat > 0.0f)
        surface.coat_roughness = widened(surface.coat_roughness, of_coat);
    if (!(normal_spread > 0.0f))
        return;
    if (facts_of(surface.highlight).is_roughness) {
        surface.roughness_or_exponent = widened(surface.roughness_or_exponent, normal_spread);
    } else { // a lobe as wide as GGX of alpha^2 = 2 / (exponent + 2)
        const float square = 2.0f / (surface.roughness_or_exponent + 2.0f) + normal_spread;
        surface.roughness_or_exponent = std::max(2.0f / square - 2.0f, 0.0f);
    }
}

std::vector<Surface> vertex_surfaces(const mesh::TriangleMesh& mesh,
                                     const SurfaceOverride& override_surface, GgxForm form) {
    constexpr std::array<glm::vec2, 3> Corners = {glm::vec2(0.0f, 0.0f), glm::vec2(1.0f, 0.0f),
                                                  glm::vec2(0.0f, 1.0f)};
    std::vector<Surface> surfaces(mesh.num_vertices());
    std::vector<bool> has_surface(mesh.num_vertices(), false);
    for (std::uint32_t triangle = 0; triangle < mesh.num_triangles(); ++triangle)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = mesh.triangles[triangle][corner];
            if (has_surface[vertex])
                continue;
            has_surface[vertex] = true;
            surfaces[vertex] = surface_at(mesh, triangle, Corners[corner], form);
            if (override_surface)
                surfaces[vertex] = override_surface(mesh, triangle, surfaces[vertex]);
        }
    return surfaces;
}

} // namespace relumine::prt
