#include "relight/surfaces/refractions.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "cubemap/frame.h"
#include "cubemap/split_mix64.h"
#include "mesh/opacity.h"
#include "prt/glossy/brdf.h"
#include "relight/surfaces/highlight_rays.h"
#include "relight/surfaces/visible_normals.h"

namespace relumine::relight {

namespace {

/// Spreads less than a pixel does.
constexpr float SmoothAlpha = 0.003f;

/// What metals behind smooth glass mirror is blurred over 6 degrees: a sample has one ray.
constexpr float LeastSpread = 1e-2f;

/// Surfaces that a ray meets before it is let go where it is.
constexpr int MostSurfaces = 16;

bool is_body(const mesh::Material& material) {
    return material.thickness > 0.0f;
}

/// Red, green or blue, where light of one colour goes a way of its own.
using Color = std::optional<int>;

bool parts_colors(const mesh::Material& material) {
    return is_body(material) && material.ior > 1.0f && material.dispersion > 0.0f;
}

/// glTF: 0 stands for an infinite index, which mirrors all. Green light has the material's index,
/// red and blue are half of nF - nC away from it, as renderers of KHR_materials_dispersion do.
float index_of(const mesh::Material& material, Color color) {
    const float index = std::max(material.ior, 1.0f);
    const float half_spread = 0.025f * material.dispersion * (index - 1.0f);
    return std::max(index + static_cast<float>(color.value_or(1) - 1) * half_spread, 1.0f);
}

/// Returns the part of the light that leaves a rough surface in a direction and meets no other
/// facet [Walter et al. 2007, Eq. 34].
float unmasked(float cosine, float alpha) {
    const float c2 = cosine * cosine, a2 = alpha * alpha;
    return 2.0f * cosine / (cosine + std::sqrt(a2 + (1.0f - a2) * c2));
}

/// Returns a point of the unit square for a surface that ray `number` of a pixel meets: Roberts' R4
/// sequence, so that two surfaces after each other have all pairs of facets.
glm::vec2 facet_point(const glm::vec2& shift, std::uint32_t number, int surface) {
    constexpr glm::dvec2 First(0.85667488385450287, 0.73389185661127370),
        Second(0.62870672025131850, 0.53859725722361216);
    const double turn = number * static_cast<double>(1 + surface / 2);
    return glm::fract(glm::dvec2(shift + ray_shift(static_cast<std::uint64_t>(surface))) +
                      turn * (surface % 2 != 0 ? First : Second));
}

/// A direction, the solid angle that it stands for where one ray shows the whole lobe, and whether
/// it is on the side that the ray came from.
struct Bent {
    glm::vec3 way;
    float solid_angle = 0.0f;
    bool is_back = false;
    /// The normal of the facet that bent it.
    glm::vec3 half{0.0f};
};

/// How far a ray's origin and direction move from one sample of a picture to the next
/// [Igehy 1999].
struct RayStep {
    glm::vec3 position{0.0f}, direction{0.0f};

    /// Along a ray of unit direction, to the plane of a triangle.
    void transfer(const glm::vec3& along, float distance, const glm::vec3& face) {
        position += distance * direction;
        const float slope = glm::dot(along, face);
        if (std::abs(slope) > 1e-4f)
            position -= glm::dot(position, face) / slope * along;
    }
    /// At a facet of unit normal on the side where the ray comes from, which turns by `turn`.
    void refract(const glm::vec3& from, const Bent& bent, float ratio, const glm::vec3& turn) {
        const float before = glm::dot(from, bent.half), behind = glm::dot(bent.way, bent.half);
        const float change = glm::dot(direction, bent.half) + glm::dot(from, turn);
        if (bent.is_back) {
            direction -= 2.0f * (before * turn + change * bent.half);
            return;
        }
        const float of_normal = ratio * before - behind;
        const float slope = behind != 0.0f ? ratio - ratio * ratio * before / behind : 0.0f;
        direction = ratio * direction - (of_normal * turn + slope * change * bent.half);
    }
};

/// Returns how much the unit normal of a mesh changes where a point of a triangle moves.
glm::vec3 normal_change(const mesh::TriangleMesh& mesh, std::uint32_t triangle,
                        const glm::vec3& normal, const glm::vec3& move) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const glm::vec3 of_u = mesh.normals[b] - mesh.normals[a];
    const glm::vec3 of_v = mesh.normals[c] - mesh.normals[a];
    const glm::vec3 u = mesh.positions[b] - mesh.positions[a];
    const glm::vec3 v = mesh.positions[c] - mesh.positions[a];
    const glm::vec3 across = glm::cross(u, v);
    const float square = glm::dot(across, across);
    if (!(square > 0.0f))
        return glm::vec3(0.0f);
    const glm::vec3 change = (glm::dot(glm::cross(move, v), across) * of_u +
                              glm::dot(glm::cross(u, move), across) * of_v) /
                             square;
    return change - glm::dot(change, normal) * normal;
}

/// Returns where light goes on at a surface that it meets on the normal's side: as by_facet(half)
/// says. A facet that sends it to the wrong side or against another facet is passed over: that
/// light comes out elsewhere, as wide as the rest.
template<typename ByFacet>
Bent spread(const glm::vec3& direction, const glm::vec3& normal, float alpha, glm::vec2 u,
            const ByFacet& by_facet) {
    constexpr int MostFacets = 16;
    const glm::mat3 frame = cubemap::frame_of(normal);
    const glm::vec3 to_origin = -direction * frame;
    // Where the point lies says nothing of which facets give way, nor of which take their place.
    cubemap::SplitMix64 random(std::bit_cast<std::uint64_t>(u));
    const auto chance = [&] {
        return static_cast<float>(cubemap::unit_interval(random.next()));
    };
    for (int i = 0; i < MostFacets && alpha > SmoothAlpha; ++i) {
        const glm::vec3 half = visible_half(to_origin, alpha, u);
        Bent bent = by_facet(frame * half);
        const float height = glm::dot(bent.way, bent.is_back ? normal : -normal);
        if (height > 0.0f && chance() < unmasked(height, alpha)) {
            bent.solid_angle /= mirrored_density(half, std::max(to_origin.z, 0.01f), alpha);
            return bent;
        }
        u.x = chance();
        u.y = chance();
    }
    Bent straight = by_facet(normal);
    straight.solid_angle = 0.0f;
    return straight;
}

/// A sheet: a mirrored direction, flipped to the other side.
Bent through_sheet(const glm::vec3& direction, const glm::vec3& normal, float alpha,
                   const glm::vec2& u) {
    return spread(direction, normal, alpha, u, [&](const glm::vec3& half) {
        const glm::vec3 mirrored = glm::reflect(direction, half);
        return Bent{mirrored - 2.0f * glm::dot(mirrored, normal) * normal, 1.0f};
    });
}

/// The surface of a body of glass: `ratio` is the index of the side where the ray is over the
/// other's.
Bent into_body(const glm::vec3& direction, const glm::vec3& normal, float alpha, float ratio,
               const glm::vec2& u) {
    return spread(direction, normal, alpha, u, [&](const glm::vec3& half) {
        const glm::vec3 bent = glm::refract(direction, half, ratio);
        if (bent == glm::vec3(0.0f))
            return Bent{glm::reflect(direction, half), 1.0f, true, half};
        // Of facets over that of mirrored directions [Walter et al. 2007, Eq. 14 and 17].
        const float before = -glm::dot(direction, half), behind = -glm::dot(bent, half);
        const float turn = ratio * before - behind;
        return Bent{bent, turn * turn / (4.0f * before * behind), false, half};
    });
}

/// Returns what the highlight of a surface leaves of a white sky.
glm::vec3 passed_part(const Mirror& mirror) {
    prt::Surface surface = mirror.surface;
    surface.albedo = glm::vec3(1.0f);
    return prt::reflect(surface, {.diffuse = glm::vec3(1.0f)},
                        {surface, mirror.normal, mirror.to_eye});
}

} // namespace

struct Refractions::Ray {
    glm::vec3 origin{0.0f}, direction{0.0f};
    glm::vec3 throughput{1.0f};
    /// None: all colours go this way.
    Color color = std::nullopt;
    /// The body that the ray is in; null outside of all.
    const mesh::Material* body = nullptr;
    /// The ray's number among those of its pixel, and how these are shifted
    std::uint32_t number = 0;
    glm::vec2 shift{0.0f};
    int num_surfaces = 0;
    /// Solid angle that the ray stands for beside its steps, and its part of a lobe.
    float spread = 0.0f, share = 0.0f;
    /// To the samples beside it and below. Those of rough glass part little beside its facets.
    std::array<RayStep, 2> steps = {};
    bool has_steps = false;

    /// Returns what is seen by a ray that meets a body: the sum of its colours where the body parts
    /// them.
    template<typename Follow>
    static glm::vec3 parted(const Ray& ray, const mesh::Material& body, const Follow& follow) {
        if (ray.color || !parts_colors(body))
            return follow(ray);
        glm::vec3 sum(0.0f);
        for (const int color : {0, 1, 2}) {
            Ray own = ray;
            own.color = color;
            own.throughput = glm::vec3(0.0f);
            own.throughput[color] = ray.throughput[color];
            sum += follow(own);
        }
        return sum;
    }
    /// What chooses the facet of the surface that it meets
    [[nodiscard]] glm::vec2 point() const { return facet_point(shift, number, num_surfaces); }
    /// Follows the steps through a surface of a body that the ray met. `normal` is on its side.
    void step(const mesh::TriangleMesh& mesh, std::uint32_t triangle, const glm::vec3& normal,
              const Bent& bent, float ratio) {
        if (!has_steps)
            return;
        const float side =
            glm::dot(normal, mesh.normals[mesh.triangles[triangle][0]]) < 0.0f ? -1.0f : 1.0f;
        for (RayStep& each : steps)
            each.refract(direction, bent, ratio,
                         side * normal_change(mesh, triangle, normal, each.position));
    }
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
    return material.transmission > 0.0f && ((is_body(material) && index_of(material, {}) > 1.0f) ||
                                            mirror.facet_alpha > SmoothAlpha);
}

glm::vec3 Refractions::light(const Mirror& mirror, const prt::MeshPoint& at, std::uint32_t sample,
                             const glm::vec2& shift) const {
    const mesh::Material& material = mesh_.materials[mesh_.triangle_materials[at.triangle]];
    const float alpha = mirror.facet_alpha;
    const std::uint32_t count =
        alpha > SmoothAlpha ? rays_through_glass(light_.reflections->num_rays()) : 1;
    const glm::vec3 through =
        passed_part(mirror) * mesh::glass_tint(mesh_, at.triangle, at.barycentric);
    const glm::vec3 position = prt::value_at(mesh_, mesh_.positions, at);
    const glm::vec3 face = prt::face_normal(mesh_, at.triangle);
    const auto entered = [&](Ray ray) {
        const float ratio = 1.0f / index_of(material, ray.color);
        const glm::vec2 u = ray.point();
        const Bent bent = is_body(material)
                              ? into_body(-mirror.to_eye, mirror.normal, alpha, ratio, u)
                              : through_sheet(-mirror.to_eye, mirror.normal, alpha, u);
        ray.direction = -mirror.to_eye;
        if (alpha <= SmoothAlpha)
            begin_steps(ray, position, face);
        if (is_body(material)) {
            ray.body = &material;
            ray.step(mesh_, at.triangle, mirror.normal, bent, ratio);
        }
        ray.spread = ray.share * bent.solid_angle;
        ray.go_on(position, bent.way, face, light_.bias);
        return followed(ray);
    };
    glm::vec3 sum(0.0f);
    for (std::uint32_t i = 0; i < count; ++i)
        sum += Ray::parted({.throughput = through,
                            .number = sample * count + i,
                            .shift = shift,
                            .num_surfaces = 1,
                            .share = SeenShare / static_cast<float>(count)},
                           material, entered);
    return sum / static_cast<float>(count);
}

/// Lets the steps of a ray from the eye arrive at the first surface.
void Refractions::begin_steps(Ray& ray, const glm::vec3& position, const glm::vec3& face) const {
    if (view_.right == glm::vec3(0.0f))
        return;
    ray.has_steps = true;
    const glm::vec3 to_point = position - view_.eye;
    const float depth = glm::dot(to_point, view_.forward), distance = glm::length(to_point);
    for (std::size_t i = 0; i < ray.steps.size(); ++i) {
        const glm::vec3 aside = depth * (i == 0 ? view_.right : view_.down);
        ray.steps[i].direction =
            (aside - glm::dot(aside, ray.direction) * ray.direction) / distance;
        ray.steps[i].position = glm::vec3(0.0f);
        ray.steps[i].transfer(ray.direction, distance, face);
    }
}

/// Returns what a ray that leaves sees: the mean over what lies between it and the next ones.
glm::vec3 Refractions::sky(const Ray& ray) const {
    return ray.throughput * light_.reflections->sky(ray.direction, ray.steps[0].direction,
                                                    ray.steps[1].direction, ray.spread);
}

glm::vec3 Refractions::followed(Ray ray) const {
    while (true) {
        const auto hit =
            rays_.closest_hit(ray.origin, ray.direction,
                              ray.body != nullptr ? prt::RayOf::EyeInGlass : prt::RayOf::Eye);
        const auto seen = [&] {
            return ray.throughput * mirrors_.seen({.hit = *hit,
                                                   .direction = ray.direction,
                                                   .solid_angle = std::max(ray.spread, LeastSpread),
                                                   .half_lobe = std::max(ray.spread, LeastSpread),
                                                   .fan_shift = ray.point()});
        };
        if (!hit)
            return sky(ray);
        if (!ray.color && rays_.is_thin(hit->triangle)) {
            const mesh::Material& met = mesh_.materials[mesh_.triangle_materials[hit->triangle]];
            if (parts_colors(met))
                return Ray::parted(ray, met, [&](const Ray& own) { return followed(own); });
        }
        if (ray.has_steps)
            for (RayStep& step : ray.steps)
                step.transfer(ray.direction, hit->distance, prt::face_normal(mesh_, hit->triangle));
        if (ray.body != nullptr)
            ray.throughput *= glm::pow(ray.body->attenuation_color,
                                       glm::vec3(hit->distance / ray.body->attenuation_distance));
        const bool is_last = ray.num_surfaces >= MostSurfaces;
        if (!rays_.is_thin(hit->triangle))
            return seen();
        if (is_last)
            return sky(ray);
        if (!meet(ray, *hit))
            return seen();
    }
}

/// Lets a ray go on at a surface that is seen through. False: it is seen itself.
bool Refractions::meet(Ray& ray, const prt::Hit& hit) const {
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
    const glm::vec2 own = ray.point();
    if (!is_body(material)) {
        const Bent bent = through_sheet(ray.direction, normal, roughness, own);
        ray.go_on(position, bent.way, face, light_.bias);
        ray.spread += ray.share * bent.solid_angle;
        ray.throughput *= tint;
        return true;
    }
    // A body within another one does not bend.
    if (ray.body != (leaves ? &material : nullptr)) {
        ray.go_on(position, ray.direction, face, light_.bias);
        ray.throughput *= tint;
        return true;
    }
    const float index = index_of(material, ray.color);
    const float ratio = leaves ? index : 1.0f / index;
    const Bent bent = into_body(ray.direction, normal, roughness, ratio, own);
    ray.step(mesh_, at.triangle, normal, bent, ratio);
    ray.go_on(position, bent.way, face, light_.bias);
    if (!bent.is_back) {
        ray.spread *= ratio * ratio;
        ray.throughput *= tint;
        ray.body = leaves ? nullptr : &material;
    }
    ray.spread += ray.share * bent.solid_angle;
    return true;
}

} // namespace relumine::relight
