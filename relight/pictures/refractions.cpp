#include "relight/pictures/refractions.h"

#include <algorithm>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "cubemap/frame.h"
#include "mesh/opacity.h"
#include "prt/glossy/brdf.h"
#include "relight/pictures/highlight_rays.h"
#include "relight/pictures/visible_normals.h"

namespace relumine::relight {

namespace {

/// Spreads less than a pixel does.
constexpr float SmoothAlpha = 0.003f;

/// What metals behind smooth glass mirror is blurred over 6 degrees: a sample has one ray.
constexpr float LeastSpread = 1e-2f;

/// Surfaces that a ray meets before it is let go where it is.
constexpr int MostSurfaces = 16;

/// glTF: 0 stands for an infinite index, which mirrors all.
float index_of(const mesh::Material& material) {
    return std::max(material.ior, 1.0f);
}

bool is_body(const mesh::Material& material) {
    return material.thickness > 0.0f;
}

/// Returns the half vector of a facet that a ray meets, which comes from the normal's side.
glm::vec3 facet(const glm::vec3& normal, const glm::vec3& to_origin, float alpha,
                const glm::vec2& u) {
    if (alpha <= SmoothAlpha)
        return normal;
    const glm::mat3 frame = cubemap::frame_of(normal);
    return glm::normalize(frame * visible_half(to_origin * frame, alpha, u));
}

/// Returns a direction behind a sheet: a mirrored one, flipped to the other side.
glm::vec3 through_sheet(const glm::vec3& direction, const glm::vec3& normal, float alpha,
                        const glm::vec2& u) {
    const glm::vec3 half = facet(normal, -direction, alpha, u);
    const glm::vec3 mirrored = direction - 2.0f * glm::dot(direction, half) * half;
    const float height = glm::dot(mirrored, normal);
    // A facet that throws the light back onto the sheet's own side is taken to let it pass
    // straight.
    return height > 0.0f ? mirrored - 2.0f * height * normal : direction;
}

/// Returns what the highlight of a surface leaves of a white sky.
glm::vec3 passed_part(const Mirror& mirror) {
    prt::Surface surface = mirror.surface;
    surface.albedo = glm::vec3(1.0f);
    return prt::reflect(surface, {.diffuse = glm::vec3(1.0f)},
                        {surface, mirror.normal, mirror.to_eye});
}

glm::vec2 turned(const glm::vec2& u, int surface) {
    // Of Roberts' R2 sequence: each surface has other facets.
    const auto i = static_cast<float>(surface);
    return glm::fract(u + i * glm::vec2(0.7548777f, 0.5698403f));
}

} // namespace

struct Refractions::Ray {
    glm::vec3 origin{0.0f}, direction{0.0f};
    glm::vec3 throughput{1.0f};
    /// The body that the ray is in; null outside of all.
    const mesh::Material* body = nullptr;
    int num_surfaces = 0;
    /// Solid angle that the ray stands for.
    float spread = 0.0f;

    /// `face` is the normal of the triangle that the ray leaves, of either side.
    void go_on(const glm::vec3& position, const glm::vec3& way, const glm::vec3& face, float bias) {
        direction = glm::normalize(way);
        origin = position + (glm::dot(face, direction) < 0.0f ? -bias : bias) * face;
    }
};

bool Refractions::bends(const Mirror& mirror, const prt::MeshPoint& at) const {
    if (mesh_.triangle_materials.empty())
        return false;
    const mesh::Material& material = mesh_.materials[mesh_.triangle_materials[at.triangle]];
    return material.transmission > 0.0f && ((is_body(material) && index_of(material) > 1.0f) ||
                                            lobe_alpha(mirror.surface) > SmoothAlpha);
}

glm::vec3 Refractions::light(const Mirror& mirror, const prt::MeshPoint& at, std::uint32_t sample,
                             const glm::vec2& shift) const {
    const mesh::Material& material = mesh_.materials[mesh_.triangle_materials[at.triangle]];
    const float alpha = lobe_alpha(mirror.surface);
    const bool is_rough = alpha > SmoothAlpha;
    const std::uint32_t count = is_rough ? rays_through_glass(light_.reflections->num_rays()) : 1;
    const glm::vec3 through =
        passed_part(mirror) * mesh::glass_tint(mesh_, at.triangle, at.barycentric);
    const glm::vec3 position = prt::value_at(mesh_, mesh_.positions, at);
    const glm::vec3 face = prt::face_normal(mesh_, at.triangle);
    glm::vec3 sum(0.0f);
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::vec2 u =
            turned(hammersley(i, count, shift), static_cast<int>(3 * sample % 1024));
        const glm::vec3 half = facet(mirror.normal, mirror.to_eye, alpha, u);
        Ray ray{.throughput = through, .num_surfaces = 1};
        if (is_rough) {
            const glm::vec3 local = half * cubemap::frame_of(mirror.normal);
            const float dense = mirrored_density(
                local, std::max(glm::dot(mirror.normal, mirror.to_eye), 0.01f), alpha);
            ray.spread = 1.0f / (static_cast<float>(count) * dense);
        }
        if (!is_body(material)) {
            ray.go_on(position, through_sheet(-mirror.to_eye, mirror.normal, alpha, u), face,
                      light_.bias);
        } else {
            ray.body = &material;
            ray.go_on(position, glm::refract(-mirror.to_eye, half, 1.0f / index_of(material)), face,
                      light_.bias);
        }
        sum += followed(ray, u);
    }
    return sum / static_cast<float>(count);
}

glm::vec3 Refractions::followed(Ray ray, const glm::vec2& u) const {
    while (true) {
        const auto hit =
            rays_.closest_hit(ray.origin, ray.direction,
                              ray.body != nullptr ? prt::RayOf::EyeInGlass : prt::RayOf::Eye);
        const auto sky = [&] {
            return ray.throughput * light_.reflections->sky(ray.direction, ray.spread);
        };
        const auto seen = [&] {
            return ray.throughput * mirrors_.seen({.hit = *hit,
                                                   .direction = ray.direction,
                                                   .solid_angle = std::max(ray.spread, LeastSpread),
                                                   .fan_shift = turned(u, ray.num_surfaces)});
        };
        if (!hit)
            return sky();
        if (ray.body != nullptr)
            ray.throughput *= glm::pow(ray.body->attenuation_color,
                                       glm::vec3(hit->distance / ray.body->attenuation_distance));
        const bool is_last = ray.num_surfaces >= MostSurfaces;
        if (!rays_.is_thin(hit->triangle))
            return seen();
        if (is_last)
            return sky();
        if (!meet(ray, *hit, u))
            return seen();
    }
}

/// Lets a ray go on at a surface that is seen through. False: it is seen itself.
bool Refractions::meet(Ray& ray, const prt::Hit& hit, const glm::vec2& u) const {
    const mesh::Material& material = mesh_.materials[mesh_.triangle_materials[hit.triangle]];
    const prt::MeshPoint at{.triangle = hit.triangle, .barycentric = hit.barycentric};
    const glm::vec3 position = prt::value_at(mesh_, mesh_.positions, at);
    const glm::vec3 face = prt::face_normal(mesh_, at.triangle);
    ++ray.num_surfaces;
    if (material.transmission == 0.0f) {
        // Blended: its own light and what is behind, of which the larger part is followed.
        const mesh::Veil veil = mesh::veil(mesh_, at.triangle, at.barycentric);
        if (veil.weight > 0.5f)
            return false;
        ray.go_on(position, ray.direction, face, light_.bias);
        return true;
    }
    const glm::vec3 tint = mesh::glass_tint(mesh_, at.triangle, at.barycentric);
    glm::vec3 normal = prt::mapped_normal(mesh_, at);
    const bool leaves = !prt::meets_front(mesh_, at, ray.direction);
    if (glm::dot(normal, ray.direction) > 0.0f)
        normal = -normal;
    const float roughness =
        light_.textures->mirrors(at.triangle) ? lobe_alpha(light_.textures->mirror(at)) : 0.0f;
    const glm::vec2 own = turned(u, ray.num_surfaces);
    if (!is_body(material)) {
        ray.go_on(position, through_sheet(ray.direction, normal, roughness, own), face,
                  light_.bias);
        ray.throughput *= tint;
        return true;
    }
    // A body within another one does not bend.
    if (ray.body != (leaves ? &material : nullptr)) {
        ray.go_on(position, ray.direction, face, light_.bias);
        ray.throughput *= tint;
        return true;
    }
    const float index = index_of(material);
    const glm::vec3 half = facet(normal, -ray.direction, roughness, own);
    const glm::vec3 bent = glm::refract(ray.direction, half, leaves ? index : 1.0f / index);
    if (bent == glm::vec3(0.0f)) {
        ray.go_on(position, glm::reflect(ray.direction, half), face, light_.bias);
        return true;
    }
    ray.throughput *= tint;
    ray.go_on(position, bent, face, light_.bias);
    ray.body = leaves ? nullptr : &material;
    return true;
}

} // namespace relumine::relight
