#include "relight/surfaces/reflections.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "cubemap/r2_sequence.h"
#include "files/parallel.h"
#include "prt/glossy/brdf.h"
#include "prt/glossy/ggx_energy.h"
#include "prt/glossy/ggx_lobe.h"
#include "prt/glossy/sheen_lobe.h"
#include "prt/glossy/stretched_lobe.h"
#include "relight/kernels/cluster_lights.h"
#include "relight/surfaces/highlight_rays.h"
#include "relight/surfaces/ray_fan.h"

namespace relumine::relight {

namespace {

/// Sums of weights and of weighted radiance, by colour.
struct Weighted {
    glm::vec3 weight{0.0f};
    glm::vec3 sum{0.0f};
    void add(const glm::vec3& w, const glm::vec3& radiance) {
        weight += w;
        sum += w * radiance;
    }
    [[nodiscard]] glm::vec3 mean() const {
        glm::vec3 result(0.0f);
        for (int color = 0; color < 3; ++color)
            if (weight[color] > 0.0f)
                result[color] = std::max(sum[color] / weight[color], 0.0f);
        return result;
    }
};

/// Resolution of what is mirrored twice: a texel is as wide as the sun.
constexpr std::uint32_t MostTwiceMirrored = 256;

/// Returns a map at R, R / 2, .. texels along an edge.
std::vector<cubemap::CubeMap> halves(cubemap::CubeMap map) {
    std::vector<cubemap::CubeMap> levels;
    levels.push_back(std::move(map));
    while (levels.back().resolution % 2 == 0)
        levels.push_back(cubemap::halved(levels.back()));
    return levels;
}

/// Returns a number of a fan that has nothing to do with where its rays go.
std::uint32_t number_of(const glm::vec2& shift) {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(shift);
    return static_cast<std::uint32_t>((bits ^ bits >> 32) * 0x9e3779b97f4a7c15u >> 40);
}

/// Every ray asks what mirrors at least this part of the light.
constexpr float AlwaysAsked = 0.25f;

/// About which part of the light a surface mirrors.
float mirrored_part(const prt::Surface& surface) {
    constexpr float OfLayers = 0.04f;
    const auto most = [](const glm::vec3& color) {
        return std::max({color.r, color.g, color.b});
    };
    return std::max({most(surface.specular), prt::has_lobes_of_colors(surface) ? 1.0f : 0.0f,
                     prt::has_coat(surface) ? OfLayers : 0.0f,
                     prt::has_sheen(surface) ? OfLayers : 0.0f});
}

/// Every so many rays of a fan ask.
std::uint32_t every_of(const MetSurface& met, const prt::Surface& surface) {
    constexpr float Asked = 32.0f;
    const float part = mirrored_part(surface);
    // One ray that asks for several says much too much or too little where all is mirrored.
    if (part >= AlwaysAsked)
        return 1;
    const float asked = std::max(Asked * part / AlwaysAsked, 1.0f);
    const auto rays = static_cast<float>(met.num_rays);
    return static_cast<std::uint32_t>(std::clamp(std::round(rays / asked), 1.0f, rays));
}

/// Returns how much more than its share of the lobe a look sees of a lobe that is `alphas` wide
/// along two axes. Looks lie farther apart along a stretched lobe than across it, and a wider look
/// blurs it little across.
float look_stretch(const glm::vec2& alphas, std::uint32_t num_rays) {
    constexpr float MostAcross = 0.6f; // of the lobe's width
    if (alphas.x == alphas.y)          // also 0: rays that are spread evenly have none
        return 1.0f;
    const float step =
        std::sqrt(std::numbers::pi_v<float> / static_cast<float>(prt::PacketSize * num_rays));
    const float ratio = std::max(alphas.x, alphas.y) / std::min(alphas.x, alphas.y);
    return std::clamp(ratio, 1.0f, std::max(MostAcross / step, 1.0f));
}

/// A ray of the tail may be below the surface where most of its part is not. Such a ray goes where
/// its part begins.
void raise_rays(const RayFan& fan, const FanFrame& frame, std::uint32_t first, FanRays& rays) {
    for (std::uint32_t lane = 0; lane < rays.directions.num_directions; ++lane) {
        if ((rays.above >> lane & 1u) != 0)
            continue;
        const FanRays part = fan_part(fan, frame, first + lane);
        if (part.above == 0)
            continue;
        const auto look = static_cast<std::size_t>(std::countr_zero(part.above));
        rays.directions.x[lane] = part.directions.x[look];
        rays.directions.y[lane] = part.directions.y[look];
        rays.directions.z[lane] = part.directions.z[look];
        rays.densities[lane] = part.densities[look];
        rays.above |= 1u << lane;
    }
}

/// What a highlight sends, by colour.
glm::vec3 highlight_of(const prt::Surface& surface, const prt::Lobes<float>& lobes) {
    return prt::has_lobes_of_colors(surface)
               ? glm::vec3(lobes.specular, lobes.specular_grazing, lobes.diffuse_grazing)
               : glm::vec3(lobes.specular);
}

} // namespace

glm::vec2 ray_shift(std::uint64_t i) {
    return glm::vec2(cubemap::r2_place(i));
}

float lobe_alpha(const prt::Surface& surface) {
    if (surface.highlight == prt::Highlight::BlinnPhong)
        return std::max(std::sqrt(2.0f / (surface.roughness_or_exponent + 2.0f)), 1e-3f);
    return prt::ggx_alpha(surface.roughness_or_exponent);
}

cubemap::CubeMap without_lights(cubemap::CubeMap environment, std::span<const SharpLight> lights) {
    if (environment.resolution == 0 || lights.empty())
        return environment;
    const LightBinning binning(environment.resolution);
    const double r = environment.resolution;
    for (const SharpLight& light : lights) {
        const VectorIrradiance all = binning.sum(environment, light.cell);
        const auto left = [](const glm::dvec3& whole, const glm::dvec3& part) {
            const double length = glm::length(whole);
            return length > 0.0 ? std::clamp(1.0 - glm::length(part) / length, 0.0, 1.0) : 1.0;
        };
        const glm::vec3 factor(left(all.red, light.irradiance.red),
                               left(all.green, light.irradiance.green),
                               left(all.blue, light.irradiance.blue));
        const double size = light.cell.size();
        const auto begin = [&](std::uint32_t i) {
            return static_cast<std::uint32_t>(std::floor(i * size * r));
        };
        const auto end = [&](std::uint32_t i) {
            return static_cast<std::uint32_t>(std::ceil((i + 1) * size * r));
        };
        for (std::uint32_t y = begin(light.cell.y); y < end(light.cell.y); ++y)
            for (std::uint32_t x = begin(light.cell.x); x < end(light.cell.x); ++x)
                environment.at(light.cell.face, x, y) *= factor;
    }
    return environment;
}

Reflections::Reflections(const prt::RayScene& rays, float bias, std::uint32_t num_rays,
                         const cubemap::CubeMap& environment, std::span<const SharpLight> without)
    : rays_(rays), bias_(bias), num_rays_(num_rays) {
    for (const SharpLight& light : without) {
        // Half vectors turn half as far as directions; a face is pi / 2 wide.
        const double half_width = 0.25 * std::numbers::pi * light.cell.size();
        least_roughness_ = std::max(least_roughness_, static_cast<float>(std::sqrt(half_width)));
    }
    if (environment.resolution == 0)
        return;
    levels_ = halves(without_lights(environment, without));
    for (std::size_t i = 1; i < levels_.size(); ++i)
        evenness_.emplace_back(levels_[i], levels_[i - std::min<std::size_t>(i, 3)]);
    if (!without.empty()) {
        const cubemap::CubeMap* all = &environment;
        cubemap::CubeMap coarse;
        while (all->resolution > MostTwiceMirrored && all->resolution % 2 == 0) {
            coarse = cubemap::halved(*all);
            all = &coarse;
        }
        whole_ = halves(*all);
    }
}

Reflections::Evenness::Evenness(const cubemap::CubeMap& level, const cubemap::CubeMap& finer)
    : resolution(level.resolution), is_even(level.texels.size()) {
    // A look is off by as much at most, and a highlight's rays share that.
    constexpr float LargestPart = 0.2f;
    const std::uint32_t r = resolution, side = finer.resolution / r;
    const auto around = [&](cubemap::Face face, std::uint32_t x, std::uint32_t y, int i) {
        const int u = static_cast<int>(x) + i % 3 - 1, v = static_cast<int>(y) + i / 3 - 1;
        const int last = static_cast<int>(r) - 1;
        if (std::min(u, v) >= 0 && std::max(u, v) <= last)
            return level.at(face, static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v));
        return cubemap::sample(level, cubemap::direction(face, (u + 0.5) / r, (v + 0.5) / r));
    };
    files::parallel_for(std::uint32_t{0}, 6 * r, [&](std::uint32_t row) {
        const auto face = static_cast<cubemap::Face>(row / r);
        const std::uint32_t y = row % r;
        for (std::uint32_t x = 0; x < r; ++x) {
            const glm::vec3 own = level.at(face, x, y);
            glm::vec3 least = own, most = own;
            const auto count = [&](const glm::vec3& value) {
                least = glm::min(least, value);
                most = glm::max(most, value);
            };
            for (int i = 0; i < 9; ++i)
                count(around(face, x, y, i));
            for (std::uint32_t v = y * side; v < (y + 1) * side; ++v)
                for (std::uint32_t u = x * side; u < (x + 1) * side; ++u)
                    count(finer.at(face, u, v));
            const glm::vec3 rest = LargestPart * own - (most - least);
            is_even[std::size_t{row} * r + x] = std::min({rest.r, rest.g, rest.b}) >= 0.0f;
        }
    });
}

bool Reflections::Evenness::at(const glm::vec3& direction) const {
    const cubemap::FacePoint point = cubemap::face_point(glm::dvec3(direction));
    const auto texel = [&](double place) {
        return std::min(static_cast<std::uint32_t>(place * resolution), resolution - 1);
    };
    const std::size_t row = static_cast<std::size_t>(point.face) * resolution + texel(point.t);
    return is_even[row * resolution + texel(point.s)] != 0;
}

glm::vec3 Reflections::sky(const glm::vec3& direction, float solid_angle) const {
    return mean(levels_, direction, solid_angle);
}

glm::vec3 Reflections::sky(const glm::vec3& direction, glm::vec3 side, glm::vec3 other_side,
                           float solid_angle) const {
    constexpr float MostLooks = 8.0f, Longest = 0.5f;
    if (glm::dot(side, side) < glm::dot(other_side, other_side))
        std::swap(side, other_side);
    const float whole = glm::length(side);
    if (!(whole > 0.0f))
        return sky(direction, solid_angle);
    const float length = std::min(whole, Longest);
    const glm::vec3 along = side / whole;
    const float width =
        std::max(std::min(glm::length(other_side - glm::dot(other_side, along) * along), length),
                 length / MostLooks);
    const float wide = std::max(length * width, solid_angle);
    if (levels_.empty() || !has_detail(direction, std::max(length * length, solid_angle)))
        return sky(direction, wide);
    const float count = std::ceil(length / std::max(width, std::sqrt(solid_angle)));
    glm::vec3 sum(0.0f);
    for (float i = 0.5f; i < count; i += 1.0f)
        sum += sky(glm::normalize(direction + (i / count - 0.5f) * length * along),
                   std::max(length * width / count, solid_angle));
    return sum / std::max(count, 1.0f);
}

std::size_t Reflections::level_of(const Levels& levels, float solid_angle) {
    const auto r = static_cast<float>(levels[0].resolution);
    // Bilinear values between means spread as far as squares of three times the area.
    constexpr float Spread = 3.0f;
    const float texels = solid_angle * 6.0f * r * r / (4.0f * std::numbers::pi_v<float>);
    // The nearest whole number to half the logarithm
    const auto half_level =
        std::bit_width(static_cast<std::uint32_t>(std::max(2.0f * texels / Spread, 2.0f))) - 1;
    return std::min(static_cast<std::size_t>(half_level / 2), levels.size() - 1);
}

glm::vec3 Reflections::mean(const Levels& levels, const glm::vec3& direction, float solid_angle) {
    if (levels.empty())
        return glm::vec3(0.0f);
    return cubemap::sample(levels[level_of(levels, solid_angle)], direction);
}

bool Reflections::has_detail(const glm::vec3& direction, float solid_angle) const {
    // Some coarser, since a ray's part of the lobe is long; none is less than a texel.
    const std::size_t level = level_of(levels_, 8.0f * solid_angle);
    return level > 0 && !evenness_[level - 1].at(direction);
}

template<typename Add>
void Reflections::send(const glm::vec3& origin, const RayFan& fan, const Surfaces& surfaces,
                       const Behind& behind, const Add& add) const {
    const FanFrame frame(fan);
    const float of_lobe = SeenShare / static_cast<float>(fan.num_rays);
    // The outermost parts have the lobe's whole tail.
    const bool has_parts =
        fan.num_rays > 1 && std::has_single_bit(fan.num_rays) && !levels_.empty();
    const std::uint32_t outermost = fan.num_rays - fan.num_rays / fan_columns(fan.num_rays);
    const float of_look = of_lobe * look_stretch(frame.alphas, fan.num_rays);
    const std::uint32_t begin = fan.only.value_or(0), end = fan.only ? begin + 1 : fan.num_rays;
    for (std::uint32_t first = begin; first < end; first += prt::PacketSize) {
        FanRays rays = fan_rays(fan, frame, first);
        if (has_parts)
            raise_rays(fan, frame, first, rays);
        if (rays.above == 0)
            continue;
        std::array<prt::Hit, prt::PacketSize> hits;
        const std::uint32_t met = rays_.closest_hits(origin, rays.directions, rays.above, hits);
        for (std::uint32_t bits = rays.above; bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
            const glm::vec3 w = rays.directions.direction(lane);
            const float dense = rays.densities[lane];
            const float part = of_lobe / dense;
            const float seen = std::max(part, behind.least_solid_angle);
            const std::uint32_t ray = first + static_cast<std::uint32_t>(lane);
            // Not where all is blurred more. What lights add to a map is known to no evenness.
            const bool is_parted =
                has_parts && part > behind.least_solid_angle &&
                (ray >= outermost || &behind.levels != &levels_ || has_detail(w, seen));
            if ((met >> lane & 1u) == 0 && is_parted) {
                const FanRays looks = fan_part(fan, frame, ray);
                for (std::uint32_t left = looks.above; left != 0; left &= left - 1) {
                    const auto look = static_cast<std::size_t>(std::countr_zero(left));
                    const glm::vec3 way = looks.directions.direction(look);
                    const float of_all = prt::PacketSize * looks.densities[look];
                    add(way, of_all,
                        mean(behind.levels, way,
                             std::max(of_look / of_all, behind.least_solid_angle)));
                }
            } else if ((met >> lane & 1u) == 0)
                add(w, dense, mean(behind.levels, w, seen));
            else
                add(w, dense,
                    surfaces({.hit = hits[lane],
                              .direction = w,
                              .solid_angle = seen,
                              .half_lobe = std::max(SeenShare / dense, behind.least_solid_angle),
                              .ray = ray,
                              .num_rays = fan.num_rays,
                              .fan_shift = fan.shift,
                              .num_mirrors = behind.num_mirrors}));
        }
    }
}

MirroredLight Reflections::light(const prt::Surface& surface, const MirrorPoint& point,
                                 std::uint32_t num_rays, const Surfaces& surfaces) const {
    return sum(surface, point, LobeRays(surface, num_rays), surfaces, {levels_});
}

std::uint32_t asked_for(const MetSurface& met, const prt::Surface& surface) {
    if (met.num_mirrors >= MostMirrors ||
        (met.num_mirrors > 1 && mirrored_part(surface) < AlwaysAsked))
        return 0;
    const std::uint32_t every = every_of(met, surface);
    return (met.ray + number_of(met.fan_shift)) % every == 0 ? every : 0;
}

glm::vec3 Reflections::in_mirror(const MetSurface& met, const prt::Surface& surface,
                                 const glm::vec3& position, const glm::vec3& normal,
                                 const glm::vec3& diffuse, const Surfaces& surfaces) const {
    // Rays of one fan look into nearly the same lobe: each asks for one ray of a fan of as many.
    // Which one has nothing to do with where it comes from.
    const std::uint32_t every = every_of(met, surface);
    const std::uint32_t num_asked = std::max(met.num_rays / every, std::uint32_t{1});
    const std::uint32_t ray = (5 * (met.ray / every) + number_of(met.fan_shift)) % num_asked;
    const MirrorPoint point{.position = position,
                            .normal = normal,
                            .to_eye = -met.direction,
                            .shift = glm::fract(met.fan_shift + ray_shift(met.num_mirrors))};
    const prt::EyeCosines n_v(surface, point.normal, point.to_eye);
    prt::Lobes<glm::vec3> lobes =
        lobes_of(surface,
                 sum(surface, point, LobeRays::one_of(num_asked, ray), surfaces,
                     {whole_.empty() ? levels_ : whole_, met.half_lobe, met.num_mirrors + 1}),
                 n_v);
    lobes.diffuse = diffuse;
    return prt::reflect(surface, lobes, n_v);
}

MirroredLight Reflections::sum(const prt::Surface& surface, const MirrorPoint& point,
                               const LobeRays& rays, const Surfaces& surfaces,
                               const Behind& behind) const {
    const prt::EyeCosines n_v(surface, point.normal, point.to_eye);
    if (surface.highlight == prt::Highlight::None || n_v.base <= 0.0f)
        return {};
    const auto lobes = [&](const glm::vec3& w) {
        return prt::evaluate_lobes(surface, point.normal, point.to_eye, w);
    };
    const glm::vec3 origin = point.position + bias_ * point.normal;
    RayFan fan{.normal = point.normal,
               .to_eye = point.to_eye,
               .alpha = lobe_alpha(surface),
               .num_rays = rays.all,
               .shift = point.shift,
               .only = rays.only};
    if (prt::is_stretched(surface)) {
        fan.alpha_along = prt::alpha_along(surface.roughness_or_exponent, surface.anisotropy);
        fan.tangent = surface.tangent;
    }
    Weighted all, grazing, coat, sheen;
    send(origin, fan, surfaces, behind,
         [&](const glm::vec3& w, float dense, const glm::vec3& radiance) {
             const prt::Lobes<float> lobe = lobes(w);
             all.add(highlight_of(surface, lobe) / dense, radiance);
             grazing.add(glm::vec3(lobe.specular_grazing / dense), radiance);
         });
    fan.num_rays = rays.coat;
    fan.alpha_along = 0.0f;
    if (prt::has_coat(surface) && n_v.coat > 0.0f) {
        fan.alpha = prt::ggx_alpha(surface.coat_roughness);
        if (surface.coat_normal != glm::vec3(0.0f))
            fan.normal = surface.coat_normal;
        send(origin, fan, surfaces, behind,
             [&](const glm::vec3& w, float dense, const glm::vec3& radiance) {
                 coat.add(glm::vec3(lobes(w).coat / dense), radiance);
             });
    }
    if (prt::has_sheen(surface)) {
        fan.num_rays = rays.sheen;
        fan.alpha = 0.0f;
        fan.normal = point.normal;
        send(origin, fan, surfaces, behind,
             [&](const glm::vec3& w, float dense, const glm::vec3& radiance) {
                 sheen.add(glm::vec3(lobes(w).sheen / dense), radiance);
             });
    }
    return {.all = all.mean(),
            .grazing = grazing.mean(),
            .whole = all.weight.r / static_cast<float>(rays.only ? 1 : rays.all),
            .coat = coat.mean(),
            .sheen = sheen.mean()};
}

prt::Lobes<glm::vec3> lobes_of(const prt::Surface& surface, const MirroredLight& light,
                               const prt::EyeCosines& n_v) {
    if (n_v.base <= 0.0f)
        return {};
    prt::Lobes<glm::vec3> lobes;
    if (prt::has_lobes_of_colors(surface)) {
        const glm::vec3 colors = prt::albedo_of_colors(surface, n_v) * light.all;
        lobes.specular = lobes.specular_grazing = lobes.diffuse_grazing = colors;
    } else {
        const bool is_known = prt::facts_of(surface.highlight).is_roughness;
        const prt::GgxAlbedo albedo =
            is_known ? prt::ggx_albedo(surface, n_v) : prt::GgxAlbedo{.all = light.whole};
        lobes.specular = albedo.all * light.all;
        lobes.specular_grazing = albedo.grazing * light.grazing;
    }
    if (prt::has_coat(surface) && n_v.coat > 0.0f)
        lobes.coat = prt::coat_albedo(surface.coat_roughness, n_v.coat) * light.coat;
    if (prt::has_sheen(surface))
        lobes.sheen = prt::sheen_albedo(surface.sheen_roughness, n_v.base) * light.sheen;
    return lobes;
}

} // namespace relumine::relight
