#include "prt/glossy/brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "prt/glossy/ggx_energy.h"
#include "prt/glossy/sheen_lobe.h"

namespace relumine::prt {

namespace {

/// The squared sine between a normal and the half vector, which is not normalised.
float squared_sine(const glm::vec3& normal, const glm::vec3& half) {
    const glm::vec3 across = glm::cross(normal, half);
    return std::min(glm::dot(across, across) / std::max(glm::dot(half, half), 1e-12f), 1.0f);
}

/// Schlick's (1 - v.h)^5; |v + w| is 2 v.h.
float schlick(const glm::vec3& half) {
    const float v_h = std::min(0.5f * std::sqrt(std::max(glm::dot(half, half), 1e-12f)), 1.0f);
    const float squared = (1.0f - v_h) * (1.0f - v_h);
    return squared * squared * (1.0f - v_h);
}

/// What a clear coat mirrors, without its strength.
float coat_lobe(const Surface& surface, const glm::vec3& normal, const glm::vec3& to_eye,
                const glm::vec3& w) {
    const float n_w = glm::dot(normal, w), n_v = glm::dot(normal, to_eye);
    if (n_w <= 0.0f || n_v <= 0.0f)
        return 0.0f;
    const float c = schlick(to_eye + w);
    return (DielectricF0 + (1.0f - DielectricF0) * c) *
           GgxLobe::specular(surface.coat_roughness, {n_w, n_v, squared_sine(normal, to_eye + w)});
}

} // namespace

Lobes<float> evaluate_lobes(const Surface& surface, const glm::vec3& normal,
                            const glm::vec3& to_eye, const glm::vec3& w) {
    Lobes<float> lobes;
    if (has_coat(surface))
        lobes.coat = coat_lobe(
            surface, surface.coat_normal == glm::vec3(0.0f) ? normal : surface.coat_normal, to_eye,
            w);
    const float n_w = glm::dot(normal, w);
    if (n_w <= 0.0f)
        return lobes;
    const float n_v = glm::dot(normal, to_eye);
    lobes.diffuse = n_w * std::numbers::inv_pi_v<float>;
    if (surface.highlight == Highlight::None || n_v <= 0.0f)
        return lobes;
    const glm::vec3 half = to_eye + w;
    const LobeGeometry at{n_w, n_v, squared_sine(normal, half)};
    if (surface.highlight == Highlight::Measured) {
        const glm::vec3 colors = MeasuredLobe::colors(*surface.table, at);
        lobes.specular = colors.r;
        lobes.specular_grazing = colors.g;
        lobes.diffuse_grazing = colors.b;
        return lobes;
    }
    lobes.specular = with_lobe(surface.highlight, [&]<typename Lobe>(Lobe) {
        if constexpr (Lobe::Facts.is_table)
            return 0.0f;
        else
            return Lobe::specular(surface.roughness_or_exponent, at);
    });
    if (has_sheen(surface))
        lobes.sheen = SheenLobe::value(surface.sheen_roughness, at);
    if (!facts_of(surface.highlight).has_fresnel)
        return lobes;
    const float c = schlick(half);
    if (facts_of(surface.highlight).has_diffuse_grazing)
        lobes.diffuse_grazing = c * lobes.diffuse;
    lobes.specular_grazing = c * lobes.specular;
    return lobes;
}

namespace {

/// A highlight of one F0 whose energy is kept: the factor on its lobe, and its albedo.
struct KeptEnergy {
    KeptEnergy(const GgxAlbedo& albedo, const glm::vec3& f0, float f90 = 1.0f)
        : factor(1.0f + f0 * ((1.0f - albedo.all) / albedo.all)),
          reflected(factor * (f0 * (albedo.all - albedo.grazing) + f90 * albedo.grazing)) {}
    glm::vec3 factor, reflected;
};

/// The two surfaces that a partly metallic one is a mean of. Their F0 have its F0 as mean; the
/// other one has its own, where that is possible.
struct MetalAndRest {
    explicit MetalAndRest(const Surface& surface)
        : metal(surface.specular), rest(surface.specular), share(surface.metallic) {
        if (!(share > 0.0f && share < 1.0f))
            return;
        metal = glm::clamp((surface.specular - (1.0f - share) * surface.dielectric_f0) / share,
                           0.0f, 1.0f);
        rest = glm::clamp((surface.specular - share * metal) / (1.0f - share), 0.0f, 1.0f);
    }
    glm::vec3 metal, rest;
    float share;
};

/// Turquin's factor on the highlight, and the diffuse part in what it leaves.
glm::vec3 reflect_base(const Surface& surface, const Lobes<glm::vec3>& lobes, float n_v) {
    if (n_v <= 0.0f) // no highlight, which takes nothing
        return surface.albedo * lobes.diffuse;
    const GgxAlbedo albedo = ggx_albedo(surface.roughness_or_exponent, n_v);
    const MetalAndRest f0(surface);
    const float f90 = surface.dielectric_f90;
    const KeptEnergy metal(albedo, f0.metal), rest(albedo, f0.rest, f90);
    const glm::vec3 rising = glm::max(lobes.specular - lobes.specular_grazing, glm::vec3(0.0f));
    const auto highlight = [&](const KeptEnergy& kept, const glm::vec3& color, float grazing) {
        return kept.factor * (color * rising + grazing * lobes.specular_grazing);
    };
    return surface.albedo * glm::max(1.0f - rest.reflected, glm::vec3(0.0f)) * lobes.diffuse +
           f0.share * highlight(metal, f0.metal, 1.0f) +
           (1.0f - f0.share) * highlight(rest, f0.rest, f90);
}

/// The layers over the base: sheen, then the clear coat.
glm::vec3 reflect_whole(const Surface& surface, const Lobes<glm::vec3>& lobes,
                        const EyeCosines& n_v) {
    glm::vec3 result = reflect_base(surface, lobes, n_v.base);
    if (has_sheen(surface) && n_v.base > 0.0f) {
        const float albedo = sheen_albedo(surface.sheen_roughness, n_v.base);
        const glm::vec3& color = surface.sheen;
        result *= 1.0f - albedo * std::max({color.r, color.g, color.b});
        result += color * lobes.sheen;
    }
    if (has_coat(surface) && n_v.coat > 0.0f) {
        const KeptEnergy coat(ggx_albedo(surface.coat_roughness, n_v.coat),
                              glm::vec3(DielectricF0));
        result *= 1.0f - surface.coat * coat.reflected;
        result += surface.coat * coat.factor * lobes.coat;
    }
    return result;
}

} // namespace

float coat_albedo(float roughness, float n_v) {
    const GgxAlbedo albedo = ggx_albedo(roughness, n_v);
    return DielectricF0 * (albedo.all - albedo.grazing) + albedo.grazing;
}

glm::vec3 diffuse_albedo(const Surface& surface, const EyeCosines& n_v) {
    if (surface.highlight != Highlight::GgxWhole)
        return surface.albedo;
    return reflect_whole(surface, {.diffuse = glm::vec3(1.0f)}, n_v);
}

glm::vec3 reflect(const Surface& surface, const Lobes<glm::vec3>& lobes, const EyeCosines& n_v) {
    if (surface.highlight == Highlight::GgxWhole)
        return reflect_whole(surface, lobes, n_v);
    if (surface.highlight == Highlight::None)
        return surface.albedo * lobes.diffuse;
    if (surface.highlight == Highlight::Measured)
        return surface.albedo * lobes.diffuse +
               surface.specular *
                   glm::vec3(lobes.specular.r, lobes.specular_grazing.g, lobes.diffuse_grazing.b);
    if (!facts_of(surface.highlight).has_fresnel)
        return surface.albedo * lobes.diffuse + surface.specular * lobes.specular;
    // The grazing part of a lobe is no more than the lobe. Each is summed over cells of its own, so
    // sums may say otherwise by their errors.
    const glm::vec3 one(1.0f), none(0.0f);
    const glm::vec3 diffuse = glm::max(lobes.diffuse - lobes.diffuse_grazing, none);
    const glm::vec3 specular = glm::max(lobes.specular - lobes.specular_grazing, none);
    // Colours may exceed 1 by what they were rounded.
    return surface.albedo * glm::max(one - surface.specular, none) * diffuse +
           surface.specular * specular + lobes.specular_grazing;
}

} // namespace relumine::prt
