#include "relight/pictures/mirrors.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "prt/glossy/brdf.h"

namespace relumine::relight {

namespace {

/// Whether two points of a pixel mirror nearly the same: normals that differ by a fraction of what
/// the lobe blurs.
bool are_alike(const Mirror& a, const Mirror& b) {
    constexpr float LargestStep = 0.1f, LeastTurn = 0.02f, LargestTurn = 0.1f, ShareOfLobe = 0.25f;
    if (a.surface.highlight != b.surface.highlight ||
        std::abs(a.surface.roughness_or_exponent - b.surface.roughness_or_exponent) >
            LargestStep * std::max(a.surface.roughness_or_exponent, LargestStep))
        return false;
    const float turn = std::clamp(ShareOfLobe * lobe_alpha(a.surface), LeastTurn, LargestTurn);
    const glm::vec3 difference = a.normal - b.normal;
    return glm::dot(difference, difference) < turn * turn;
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
    glm::vec3 normal = prt::mapped_normal(mesh_, point);
    // A normal map may turn away from the eye what the eye sees.
    constexpr float LeastCosine = 0.01f;
    if (const float cosine = glm::dot(normal, to_eye); cosine < LeastCosine)
        normal = glm::normalize(normal + (LeastCosine - cosine) * to_eye);
    return Mirror{light_.textures->mirror(point, &view_), normal, to_eye};
}

glm::vec3 Mirrors::soft(const Mirror& mirror, const prt::MeshPoint& point,
                        const glm::vec3& diffuse) {
    const glm::vec3 factor =
        light_.albedo.empty() ? glm::vec3(1.0f) : prt::value_at(mesh_, light_.albedo, point);
    const float n_v = glm::dot(mirror.normal, mirror.to_eye);
    const prt::Lobes<glm::vec3> own = lobes_of(mirror.surface, light(mirror, point), n_v);
    return prt::reflect(mirror.surface,
                        {.diffuse = diffuse,
                         .diffuse_grazing = glm::vec3(0.0f),
                         .specular = factor * own.specular,
                         .specular_grazing = factor * own.specular_grazing},
                        n_v);
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
