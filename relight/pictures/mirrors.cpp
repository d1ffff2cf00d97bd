#include "relight/pictures/mirrors.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "prt/glossy/brdf.h"
#include "prt/glossy/ggx_lobe.h"
#include "prt/glossy/sheen_lobe.h"

namespace relumine::relight {

namespace {

/// Whether a lobe's roughness, or exponent, is nearly that of another.
bool are_near(float a, float b) {
    constexpr float LargestStep = 0.1f;
    return std::abs(a - b) <= LargestStep * std::max(a, LargestStep);
}

/// Whether normals differ by a fraction of what the lobe blurs.
bool are_near(const glm::vec3& a, const glm::vec3& b, float alpha) {
    constexpr float LeastTurn = 0.02f, LargestTurn = 0.1f, ShareOfLobe = 0.25f;
    const float turn = std::clamp(ShareOfLobe * alpha, LeastTurn, LargestTurn);
    return glm::dot(a - b, a - b) < turn * turn;
}

/// Whether two points of a pixel mirror nearly the same.
bool are_alike(const Mirror& a, const Mirror& b) {
    const prt::Surface &one = a.surface, &other = b.surface;
    return one.highlight == other.highlight && prt::has_coat(one) == prt::has_coat(other) &&
           prt::has_sheen(one) == prt::has_sheen(other) &&
           are_near(one.roughness_or_exponent, other.roughness_or_exponent) &&
           are_near(one.coat_roughness, other.coat_roughness) &&
           are_near(one.sheen_roughness, other.sheen_roughness) &&
           are_near(a.normal, b.normal, lobe_alpha(one)) &&
           are_near(one.coat_normal, other.coat_normal, prt::ggx_alpha(one.coat_roughness));
}

} // namespace

void Mirrors::begin_pixel(std::uint32_t x, std::uint32_t y,
                          const std::optional<prt::MeshPoint>& middle) {
    traced_.clear();
    middle_ = middle;
    // Roberts' R2 sequence: neighbouring pixels get shifts that are far apart.
    const auto i = static_cast<double>(x), j = static_cast<double>(y);
    shift_ = glm::vec2(glm::fract(glm::dvec2(0.75487766624669276 * i + 0.56984029099805327 * j,
                                             0.56984029099805327 * i + 0.75487766624669276 * j)));
}

std::optional<Mirror> Mirrors::at(const prt::MeshPoint& point) const {
    if (light_.reflections == nullptr || light_.textures == nullptr || !light_.eye ||
        !light_.textures->mirrors(point.triangle))
        return std::nullopt;
    const glm::vec3 to_eye =
        glm::normalize(*light_.eye - prt::value_at(mesh_, mesh_.positions, point));
    if (!(glm::dot(prt::shading_normal(mesh_, point), to_eye) > 0.0f))
        return std::nullopt;
    // A normal map may turn away from the eye what the eye sees.
    const auto turned = [&](const glm::vec3& normal) {
        constexpr float LeastCosine = 0.01f;
        const float cosine = glm::dot(normal, to_eye);
        return cosine < LeastCosine ? glm::normalize(normal + (LeastCosine - cosine) * to_eye)
                                    : normal;
    };
    Mirror mirror{light_.textures->mirror(point, &view_), turned(prt::mapped_normal(mesh_, point)),
                  to_eye};
    if (prt::has_coat(mirror.surface))
        mirror.surface.coat_normal = turned(prt::coat_normal(mesh_, point));
    return mirror;
}

glm::vec3 Mirrors::soft(const Mirror& mirror, const prt::MeshPoint& point,
                        const glm::vec3& diffuse) {
    const glm::vec3 factor =
        light_.albedo.empty() ? glm::vec3(1.0f) : prt::value_at(mesh_, light_.albedo, point);
    const prt::EyeCosines n_v(mirror.surface, mirror.normal, mirror.to_eye);
    prt::Lobes<glm::vec3> lobes = lobes_of(mirror.surface, light(mirror, point), n_v);
    prt::multiply(lobes, factor);
    lobes.diffuse = diffuse;
    return prt::reflect(mirror.surface, lobes, n_v);
}

MirroredLight Mirrors::light(const Mirror& mirror, const prt::MeshPoint& point) {
    if (traced_.empty() && middle_)
        if (const std::optional<Mirror> middle = at(*middle_); middle && are_alike(*middle, mirror))
            trace(*middle, *middle_);
    const auto found = std::find_if(traced_.begin(), traced_.end(), [&](const Traced& traced) {
        return are_alike(traced.mirror, mirror);
    });
    if (found != traced_.end())
        return found->light;
    trace(mirror, point);
    return traced_.back().light;
}

void Mirrors::trace(const Mirror& mirror, const prt::MeshPoint& point) {
    const auto surfaces = [this](const prt::Hit& hit, const glm::vec3& direction,
                                 const glm::vec3& sky) {
        return seen(hit, direction, sky);
    };
    // A pixel of several normals sums their rays.
    const std::uint32_t all = light_.reflections->num_rays();
    const std::uint32_t num_rays = traced_.empty() ? all : (all + 1) / 2;
    traced_.push_back(
        {mirror, light_.reflections->light(mirror.surface,
                                           {.position = prt::smooth_position(mesh_, point),
                                            .normal = mirror.normal,
                                            .to_eye = mirror.to_eye,
                                            .shift = shift_},
                                           num_rays, surfaces)});
}

/// Returns the radiance of a surface that a ray meets. A floor that catches shadows shows what is
/// behind it, as in the picture.
glm::vec3 Mirrors::seen(const prt::Hit& hit, const glm::vec3& direction,
                        const glm::vec3& sky) const {
    const prt::Hit facing = twins_.facing(hit, direction);
    const prt::MeshPoint at{.triangle = facing.triangle, .barycentric = facing.barycentric};
    const SurfaceColors& colors = *light_.textures;
    if (!floor_.has(mesh_.triangles[at.triangle])) {
        if (!colors.has(at.triangle))
            return prt::value_at(mesh_, light_.mirrored, at) +
                   (light_.emission.empty() ? glm::vec3(0.0f)
                                            : prt::value_at(mesh_, light_.emission, at));
        const prt::Surface surface = colors.surface(at);
        return colors.light(light_.mirrored, at) * surface.albedo +
               light_.emission_gain(at.triangle) * surface.emission;
    }
    const glm::vec3 position = prt::value_at(mesh_, mesh_.positions, at);
    const float opacity = floor_.opacity(position);
    const glm::vec3 radiance = prt::value_at(mesh_, light_.mirrored, at);
    if (!light_.open_floor)
        return glm::mix(sky, radiance, opacity);
    const glm::vec3 behind =
        backdrop_ != nullptr ? (*backdrop_)(glm::normalize(position - *light_.eye)) : sky;
    return caught(radiance, *light_.open_floor, opacity) * behind;
}

} // namespace relumine::relight
