#include "relight/surfaces/mirrors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "prt/glossy/brdf.h"
#include "prt/glossy/ggx_lobe.h"
#include "prt/glossy/sheen_lobe.h"
#include "prt/glossy/stretched_lobe.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/lit_position.h"
#include "prt/receivers/reflecting_normal.h"
#include "prt/receivers/texture_view.h"
#include "relight/surfaces/highlight_rays.h"
#include "relight/surfaces/other_side.h"

namespace relumine::relight {

namespace {

/// Whether a lobe's roughness, or exponent, is nearly that of another.
bool are_near(float a, float b) {
    constexpr float LargestStep = 0.1f;
    return std::abs(a - b) <= LargestStep * std::max(a, LargestStep);
}

/// Returns by how much normals may differ: a fraction of what the lobe blurs.
float turn_of(float alpha) {
    constexpr float LeastTurn = 0.02f, LargestTurn = 0.1f, ShareOfLobe = 0.25f;
    return std::clamp(ShareOfLobe * alpha, LeastTurn, LargestTurn);
}

bool are_near(const glm::vec3& a, const glm::vec3& b, float alpha) {
    const float turn = turn_of(alpha);
    return glm::dot(a - b, a - b) < turn * turn;
}

/// Alpha of a stretched lobe along its tangent; of others, alpha.
float longest_alpha(const prt::Surface& surface) {
    return prt::is_stretched(surface)
               ? prt::alpha_along(surface.roughness_or_exponent, surface.anisotropy)
               : lobe_alpha(surface);
}

/// Whether normals are near. A stretched lobe blurs more along its tangent.
bool face_alike(const Mirror& a, const Mirror& b) {
    const float alpha = lobe_alpha(a.surface);
    if (!prt::is_stretched(a.surface))
        return are_near(a.normal, b.normal, alpha);
    const glm::vec3 difference = a.normal - b.normal;
    const float along = glm::dot(difference, a.surface.tangent);
    const float rest = glm::dot(difference, difference) - along * along;
    const float turn = turn_of(alpha), turn_along = turn_of(longest_alpha(a.surface));
    return along * along / (turn_along * turn_along) + rest / (turn * turn) < 1.0f;
}

/// Whether two points of a pixel mirror nearly the same.
bool are_alike(const Mirror& a, const Mirror& b) {
    const prt::Surface &one = a.surface, &other = b.surface;
    return one.highlight == other.highlight && one.table == other.table &&
           prt::has_coat(one) == prt::has_coat(other) &&
           prt::has_sheen(one) == prt::has_sheen(other) &&
           prt::has_film(one) == prt::has_film(other) &&
           prt::is_stretched(one) == prt::is_stretched(other) &&
           are_near(one.anisotropy, other.anisotropy) &&
           are_near(one.tangent, other.tangent, lobe_alpha(one)) &&
           are_near(one.roughness_or_exponent, other.roughness_or_exponent) &&
           are_near(one.coat_roughness, other.coat_roughness) &&
           are_near(one.sheen_roughness, other.sheen_roughness) && face_alike(a, b) &&
           are_near(one.coat_normal, other.coat_normal, prt::ggx_alpha(one.coat_roughness));
}

/// Returns over how many pixels around a lobe may be averaged: it blurs more than these.
std::uint32_t reach_of(float alpha) {
    constexpr std::array<float, Mirrors::Reach> Widest = {0.03f, 0.1f, 0.25f};
    return static_cast<std::uint32_t>(std::upper_bound(Widest.begin(), Widest.end(), alpha) -
                                      Widest.begin());
}

/// Shifts along Morton's curve: pixels of a square, which share their rays, have ones far apart.
glm::vec2 shift_of(std::uint32_t x, std::uint32_t y) {
    std::uint64_t number = 0;
    for (unsigned bit = 0; bit < 16; ++bit)
        number |= std::uint64_t{x >> bit & 1u} << (2 * bit) | std::uint64_t{y >> bit & 1u}
                                                                  << (2 * bit + 1);
    return ray_shift(number);
}

/// Returns a normal that the eye sees: a normal map may turn one away from it.
glm::vec3 facing(const glm::vec3& normal, const glm::vec3& to_eye) {
    constexpr float LeastCosine = 0.01f;
    const float cosine = glm::dot(normal, to_eye);
    return cosine < LeastCosine ? glm::normalize(normal + (LeastCosine - cosine) * to_eye) : normal;
}

} // namespace

std::optional<Mirror> mirror_of(const mesh::TriangleMesh& mesh, const prt::MeshPoint& point,
                                const prt::Surface& surface, const glm::vec3& to_eye,
                                const prt::TextureView* view) {
    if (!(glm::dot(prt::shading_normal(mesh, point), to_eye) > 0.0f))
        return std::nullopt;
    const prt::MappedNormal normal = prt::seen_normal(mesh, point, view);
    const auto turned = [&](const glm::vec3& mapped) {
        const glm::vec3 own = prt::shading_normal(mesh, point);
        return facing(glm::normalize(prt::reflecting_outwards(mapped, own, to_eye)), to_eye);
    };
    Mirror mirror{surface, turned(normal.direction), to_eye};
    float of_coat = 0.0f;
    if (prt::has_coat(mirror.surface)) {
        const prt::MappedNormal coat = prt::seen_coat_normal(mesh, point, view);
        mirror.surface.coat_normal = turned(coat.direction);
        of_coat = coat.spread;
    }
    prt::widen(mirror.surface, normal.spread, of_coat);
    mirror.facet_alpha = lobe_alpha(mirror.surface);
    if (view != nullptr) {
        const float of_mesh = view->normal_spread(mesh, point);
        prt::widen(mirror.surface, of_mesh, of_mesh);
    }
    return mirror;
}

glm::vec3 seen_in_mirror(const Reflections& reflections, const MetSurface& met,
                         const LitMirror& lit, const Reflections::Surfaces& surfaces) {
    const glm::vec3 as_matte = lit.light * prt::without_highlight(lit.surface).albedo;
    const std::uint32_t count = asked_for(met, lit.surface);
    if (count == 0)
        return as_matte;
    const std::optional<Mirror> mirror = mirror_of(lit.mesh, lit.at, lit.surface, -met.direction);
    if (!mirror)
        return as_matte;
    const glm::vec3 whole = reflections.in_mirror(
        met, mirror->surface, prt::value_at(lit.mesh, lit.mesh.positions, lit.at), mirror->normal,
        lit.light, surfaces);
    // What one ray says for several may be below 0: their mean is not.
    return as_matte + static_cast<float>(count) * (whole - as_matte);
}

void Mirrors::begin_tile(std::uint32_t left, std::uint32_t top, std::uint32_t width,
                         std::span<const std::optional<prt::MeshPoint>> middles) {
    left_ = left;
    top_ = top;
    width_ = width;
    middles_.assign(middles.size(), std::nullopt);
    for (std::size_t i = 0; i < middles.size(); ++i)
        if (middles[i])
            if (const std::optional<Mirror> mirror = at(*middles[i])) {
                shift_ = shift_of(left + static_cast<std::uint32_t>(i % width),
                                  top + static_cast<std::uint32_t>(i / width));
                middles_[i] = {
                    {*mirror, trace(*mirror, *middles[i], light_.reflections->num_rays())},
                    prt::value_at(mesh_, mesh_.positions, *middles[i])};
            }
}

void Mirrors::begin_pixel(std::uint32_t x, std::uint32_t y) {
    traced_.clear();
    x_ = x - left_;
    y_ = y - top_;
    shift_ = shift_of(x, y);
}

Mirrors::Shared Mirrors::shared(const Mirror& mirror, const glm::vec3& position) const {
    // A stretched lobe blurs as much as a round one of the same area.
    const std::uint32_t reach =
        reach_of(std::sqrt(lobe_alpha(mirror.surface) * longest_alpha(mirror.surface)));
    const std::uint32_t of_coat = reach_of(prt::ggx_alpha(mirror.surface.coat_roughness));
    const auto height = static_cast<std::uint32_t>(middles_.size() / width_);
    Shared sum;
    for (std::uint32_t y = y_ - std::min(y_, reach); y < std::min(y_ + reach + 1, height); ++y)
        for (std::uint32_t x = x_ - std::min(x_, reach); x < std::min(x_ + reach + 1, width_);
             ++x) {
            const std::optional<Middle>& middle = middles_[std::size_t{y} * width_ + x];
            if (!middle || !are_alike(middle->traced.mirror, mirror))
                continue;
            // Of the same stretch of surface, which is nearly flat.
            constexpr float LargestSlope = 0.25f;
            const glm::vec3 way = middle->position - position;
            if (std::abs(glm::dot(way, mirror.normal)) > LargestSlope * glm::length(way))
                continue;
            sum.add(middle->traced.light, std::max(x, x_) - std::min(x, x_) <= of_coat &&
                                              std::max(y, y_) - std::min(y, y_) <= of_coat);
            sum.has_own = sum.has_own || (x == x_ && y == y_);
        }
    return sum;
}

void Mirrors::Shared::add(const MirroredLight& light, bool has_coat) {
    count += 1.0f;
    sum.all += light.all;
    sum.grazing += light.grazing;
    sum.whole += light.whole;
    sum.sheen += light.sheen;
    if (has_coat) {
        num_coats += 1.0f;
        sum.coat += light.coat;
    }
}

MirroredLight Mirrors::Shared::mean() const {
    return {.all = sum.all / count,
            .grazing = sum.grazing / count,
            .whole = sum.whole / count,
            .coat = sum.coat / std::max(num_coats, 1.0f),
            .sheen = sum.sheen / count};
}

std::optional<Mirror> Mirrors::at(const prt::MeshPoint& point) const {
    if (light_.reflections == nullptr || light_.textures == nullptr || !light_.eye ||
        !light_.textures->mirrors(point.triangle))
        return std::nullopt;
    return mirror_of(mesh_, point, light_.textures->mirror(point, &view_),
                     glm::normalize(*light_.eye - prt::value_at(mesh_, mesh_.positions, point)),
                     &view_);
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
    const auto found = std::find_if(traced_.begin(), traced_.end(), [&](const Traced& traced) {
        return are_alike(traced.mirror, mirror);
    });
    if (found != traced_.end())
        return found->light;
    Shared near = shared(mirror, prt::value_at(mesh_, mesh_.positions, point));
    // Few have less noise than rays of one's own, but not their place: only stretched lobes, whose
    // noise is largest, take them beside these.
    constexpr float Enough = 4.0f;
    const std::optional<Middle>& middle = middles_[std::size_t{y_} * width_ + x_];
    const bool is_enough =
        near.count >= Enough && (!prt::has_coat(mirror.surface) || near.num_coats > 0.0f);
    if (!is_enough && !prt::is_stretched(mirror.surface))
        near = {};
    if (!is_enough && traced_.empty() && middle && are_alike(middle->traced.mirror, mirror)) {
        if (!near.has_own)
            near.add(middle->traced.light, true);
    } else if (!is_enough) {
        // A pixel of several normals sums their rays.
        near.add(
            trace(mirror, point, rays_of_pixel(light_.reflections->num_rays(), traced_.empty())),
            true);
    }
    traced_.push_back({mirror, near.mean()});
    return traced_.back().light;
}

MirroredLight Mirrors::trace(const Mirror& mirror, const prt::MeshPoint& point,
                             std::uint32_t num_rays) const {
    const auto surfaces = [this](const MetSurface& met) {
        return seen(met);
    };
    return light_.reflections->light(
        mirror.surface,
        {.position = prt::lit_position(mesh_, rays_, point, mirror.normal, light_.bias),
         .normal = mirror.normal,
         .to_eye = mirror.to_eye,
         .shift = shift_},
        num_rays, surfaces);
}

prt::MeshPoint Mirrors::point_of(const MetSurface& met) const {
    const prt::Hit facing = twins_.facing(met.hit, met.direction);
    return {.triangle = facing.triangle, .barycentric = facing.barycentric};
}

glm::vec3 Mirrors::seen(const MetSurface& met) const {
    const prt::MeshPoint at = point_of(met);
    const SurfaceColors& colors = *light_.textures;
    if (floor_.has(mesh_.triangles[at.triangle]) || !colors.mirrors(at.triangle))
        return matte(at, met);
    const prt::Surface surface = colors.mirror(at);
    return seen_in_mirror(*light_.reflections, met,
                          {mesh_, at, surface, colors.light(light_.mirrored, at)},
                          [this](const MetSurface& behind) { return seen(behind); }) +
           passed_on(at) + light_.emission_gain(at.triangle) * surface.emission;
}

glm::vec3 Mirrors::matte(const prt::MeshPoint& at, const MetSurface& met) const {
    if (floor_.has(mesh_.triangles[at.triangle]))
        return floor(at, met);
    const SurfaceColors& colors = *light_.textures;
    if (!colors.has(at.triangle))
        return prt::value_at(mesh_, light_.mirrored, at) +
               (light_.emission.empty() ? glm::vec3(0.0f)
                                        : prt::value_at(mesh_, light_.emission, at));
    const prt::Surface surface = colors.surface(at);
    return colors.light(light_.mirrored, at) * surface.albedo + passed_on(at) +
           light_.emission_gain(at.triangle) * surface.emission;
}

glm::vec3 Mirrors::passed_on(const prt::MeshPoint& at) const {
    const auto other = other_side(mesh_, at, light_, twins_);
    return other ? other->part * light_.textures->light(light_.mirrored, other->at)
                 : glm::vec3(0.0f);
}

glm::vec3 Mirrors::floor(const prt::MeshPoint& at, const MetSurface& met) const {
    const auto sky = [&] {
        return light_.reflections->sky(met.direction, met.solid_angle);
    };
    const glm::vec3 position = prt::value_at(mesh_, mesh_.positions, at);
    const float opacity = floor_.opacity(position);
    const glm::vec3 radiance = prt::value_at(mesh_, light_.mirrored, at);
    if (!light_.open_floor)
        return glm::mix(sky(), radiance, opacity);
    const glm::vec3 behind = behind_ ? behind_(glm::normalize(position - *light_.eye)) : sky();
    return caught(radiance, *light_.open_floor, opacity) * behind;
}

} // namespace relumine::relight
