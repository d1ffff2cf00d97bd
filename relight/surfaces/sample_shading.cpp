#include "relight/surfaces/sample_shading.h"

#include <algorithm>
#include <array>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "prt/glossy/brdf.h"
#include "relight/harmonics/harmonics.h"

namespace relumine::relight {

namespace {

/// Returns the part of the diffuse light that the highlight of a surface leaves.
glm::vec3 under_highlight(const std::optional<Mirror>& mirror) {
    if (!mirror)
        return glm::vec3(1.0f);
    prt::Surface white = mirror->surface;
    white.albedo = glm::vec3(1.0f);
    return prt::diffuse_albedo(white, {mirror->surface, mirror->normal, mirror->to_eye});
}

} // namespace

glm::vec3 SampleShading::soft(const prt::MeshPoint& at, const std::optional<Mirror>& mirror,
                              Mirrors& mirrors, const glm::vec3& given) const {
    const glm::vec3 own = given == glm::vec3(0.0f) || light_.albedo.empty()
                              ? given
                              : given * prt::value_at(mesh_, light_.albedo, at);
    if (mirror)
        return mirrors.soft(*mirror, at,
                            light_.textures->light(light_.radiance, at, tilted(at) + own));
    if (!has_texture(at.triangle)) {
        const glm::vec3 radiance = prt::value_at(mesh_, light_.radiance, at);
        if (own == glm::vec3(0.0f))
            return radiance;
        return glm::max(
            radiance + own * (light_.surfaces.empty() ? glm::vec3(1.0f) : surface_at(at).albedo),
            0.0f);
    }
    const glm::vec3 change = tilted(at) + own;
    if (light_.lobes.empty())
        return light_.textures->radiance(light_.radiance, at, change, &view_);
    const mesh::Triangle& triangle = mesh_.triangles[at.triangle];
    const glm::vec2& w = at.barycentric;
    prt::Lobes<glm::vec3> between;
    prt::add_scaled(between, light_.lobes[triangle[0]], 1.0f - w.x - w.y);
    prt::add_scaled(between, light_.lobes[triangle[1]], w.x);
    prt::add_scaled(between, light_.lobes[triangle[2]], w.y);
    between.diffuse = glm::max(between.diffuse + change, 0.0f);
    return prt::reflect(surface_at(at), between, eye_cosine(at));
}

glm::vec3 SampleShading::soft(const OtherSide& other, const std::optional<Mirror>& mirror) const {
    return other.part * under_highlight(mirror) *
           light_.textures->light(light_.radiance, other.at, tilted(other.at));
}

glm::vec3 SampleShading::traced(const OtherSide& other, const std::optional<Mirror>& mirror,
                                std::span<const std::uint16_t> lights) {
    const glm::vec3 factor =
        light_.albedo.empty() ? glm::vec3(1.0f) : prt::value_at(mesh_, light_.albedo, other.at);
    return factor * other.part * under_highlight(mirror) *
           white(prt::seen_normal(mesh_, other.at, &view_).direction, lights);
}

/// Returns what a normal map adds to the diffuse radiance of albedo 1: the light of its normal
/// less that of the mesh's normal, so that a flat map adds nothing.
glm::vec3 SampleShading::tilted(const prt::MeshPoint& at) const {
    if (light_.harmonics.empty())
        return glm::vec3(0.0f);
    const glm::vec3 normal = prt::shading_normal(mesh_, at);
    const glm::vec3 mapped = prt::seen_normal(mesh_, at, &view_).direction;
    if (mapped == normal)
        return glm::vec3(0.0f);
    const std::size_t count = light_.harmonics.size() / mesh_.num_vertices();
    const glm::vec2& w = at.barycentric;
    const std::array<float, 3> weights = {1.0f - w.x - w.y, w.x, w.y};
    std::array<glm::vec3, MaxHarmonics> between{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::size_t first = mesh_.triangles[at.triangle][corner] * count;
        for (std::size_t i = 0; i < count; ++i)
            between[i] += weights[corner] * light_.harmonics[first + i];
    }
    const auto light = std::span(between).first(count);
    return glm::vec3((irradiance(light, mapped) - irradiance(light, normal)) / std::numbers::pi);
}

/// Returns the cosine between normal and eye, 0 without an eye.
float SampleShading::eye_cosine(const prt::MeshPoint& at) const {
    if (!light_.eye)
        return 0.0f;
    return glm::dot(prt::shading_normal(mesh_, at),
                    glm::normalize(*light_.eye - prt::value_at(mesh_, mesh_.positions, at)));
}

glm::vec3 SampleShading::emitted(const prt::MeshPoint& at,
                                 const std::optional<Mirror>& mirror) const {
    if (light_.emission.empty())
        return glm::vec3(0.0f);
    const glm::vec3 gain = light_.emission_gain(at.triangle);
    if (mirror)
        return gain * mirror->surface.emission;
    return has_texture(at.triangle) ? gain * light_.textures->surface(at, &view_).emission
                                    : prt::value_at(mesh_, light_.emission, at);
}

/// Samples beside each other mostly see the same lights.
glm::vec3 SampleShading::white(const glm::vec3& normal, std::span<const std::uint16_t> lights) {
    if (!std::equal(lights.begin(), lights.end(), summed_.begin(), summed_.end())) {
        summed_.assign(lights.begin(), lights.end());
        sum_ = packets_.irradiance(lights);
    }
    return glm::vec3(sum_.on(normal) / std::numbers::pi);
}

glm::vec3 SampleShading::traced(const prt::MeshPoint& at, const std::optional<Mirror>& mirror,
                                std::span<const std::uint16_t> lights) {
    if (std::all_of(lights.begin(), lights.end(), [](std::uint16_t word) { return word == 0; }))
        return glm::vec3(0.0f);
    const glm::vec3 albedo =
        light_.albedo.empty() ? glm::vec3(1.0f) : prt::value_at(mesh_, light_.albedo, at);
    if (mirror && !light_.surfaces.empty()) {
        prt::Surface surface = mirror->surface;
        const float least = light_.reflections->least_roughness();
        if (prt::facts_of(surface.highlight).is_roughness)
            surface.roughness_or_exponent = std::max(surface.roughness_or_exponent, least);
        surface.coat_roughness = std::max(surface.coat_roughness, least);
        return albedo * reflected(surface, mirror->normal, mirror->to_eye, lights);
    }
    const glm::vec3 normal = prt::seen_normal(mesh_, at, &view_).direction;
    if (light_.surfaces.empty())
        return albedo * white(normal, lights);
    const prt::Surface surface = surface_at(at);
    if (surface.highlight == prt::Highlight::None || !light_.eye)
        return albedo * prt::reflect(surface, {.diffuse = white(normal, lights)}, 0.0f);
    return albedo *
           reflected(surface, normal,
                     glm::normalize(*light_.eye - prt::value_at(mesh_, mesh_.positions, at)),
                     lights);
}

/// Returns what a surface sends to the eye of lights.
glm::vec3 SampleShading::reflected(const prt::Surface& surface, const glm::vec3& normal,
                                   const glm::vec3& to_eye,
                                   std::span<const std::uint16_t> lights) const {
    prt::BlockSurfaces block;
    block.set(0, surface, normal, to_eye);
    prt::Lobes<glm::dvec3> lobes;
    packets_.light_block(block, {&normal, 1}, lights, {&lobes, 1});
    return prt::reflect(surface, prt::converted<glm::vec3>(lobes), {surface, normal, to_eye});
}

/// Returns the surface between the vertices', with the highlight of the nearest and the colours
/// of the textures.
prt::Surface SampleShading::surface_at(const prt::MeshPoint& at) const {
    const mesh::Triangle& triangle = mesh_.triangles[at.triangle];
    const std::array<float, 3> weights = {1.0f - at.barycentric.x - at.barycentric.y,
                                          at.barycentric.x, at.barycentric.y};
    const auto nearest = static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) -
                                                  weights.begin());
    prt::Surface surface = light_.surfaces[triangle[nearest]];
    surface.albedo = surface.specular = surface.sheen = glm::vec3(0.0f);
    surface.coat = 0.0f;
    float shape = 0.0f, metallic = 0.0f;
    bool is_same = true;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const prt::Surface& own = light_.surfaces[triangle[corner]];
        surface.albedo += weights[corner] * own.albedo;
        surface.specular += weights[corner] * own.specular;
        surface.coat += weights[corner] * own.coat;
        surface.sheen += weights[corner] * own.sheen;
        metallic += weights[corner] * own.metallic;
        shape += weights[corner] * own.roughness_or_exponent;
        is_same = is_same && own.highlight == surface.highlight;
    }
    if (is_same)
        surface.roughness_or_exponent = shape;
    surface.metallic = metallic;
    if (has_texture(at.triangle)) {
        const prt::Surface own = light_.textures->surface(at, &view_);
        surface.albedo = own.albedo;
        surface.specular = own.specular;
        surface.metallic = own.metallic;
    }
    return surface;
}

} // namespace relumine::relight
