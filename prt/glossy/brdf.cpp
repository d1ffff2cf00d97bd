#include "prt/glossy/brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "prt/glossy/ggx_energy.h"
#include "prt/glossy/kept_energy.h"
#include "prt/glossy/sheen_lobe.h"
#include "prt/glossy/stretched_lobe.h"

namespace relumine::prt {

namespace {

/// The squared sine between a normal and the half vector, which is not normalised.
float squared_sine(const glm::vec3& normal, const glm::vec3& half) {
    const glm::vec3 across = glm::cross(normal, half);
    return std::min(glm::dot(across, across) / std::max(glm::dot(half, half), 1e-12f), 1.0f);
}

/// The cosine between the eye and the half vector; |v + w| is 2 v.h.
float v_h_of(const glm::vec3& half) {
    return std::min(0.5f * std::sqrt(std::max(glm::dot(half, half), 1e-12f)), 1.0f);
}

/// What a clear coat mirrors, without its strength.
float coat_lobe(const Surface& surface, const glm::vec3& normal, const glm::vec3& to_eye,
                const glm::vec3& w) {
    const float n_w = glm::dot(normal, w), n_v = glm::dot(normal, to_eye);
    if (n_w <= 0.0f || n_v <= 0.0f)
        return 0.0f;
    const float c = schlick(v_h_of(to_eye + w));
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
    if (is_stretched(surface))
        lobes.specular = StretchedLobe(surface, normal).value(to_eye, w);
    if (has_sheen(surface))
        lobes.sheen = SheenLobe::value(surface.sheen_roughness, at);
    if (has_film(surface)) {
        const glm::vec3 colors =
            lobes.specular * FilmHighlight(surface, {surface, normal, to_eye}).at(v_h_of(half));
        lobes.specular = colors.r;
        lobes.specular_grazing = colors.g;
        lobes.diffuse_grazing = colors.b;
        return lobes;
    }
    if (!facts_of(surface.highlight).has_fresnel)
        return lobes;
    const float c = schlick(v_h_of(half));
    if (facts_of(surface.highlight).has_diffuse_grazing)
        lobes.diffuse_grazing = c * lobes.diffuse;
    lobes.specular_grazing = c * lobes.specular;
    return lobes;
}

namespace {

/// Light through a lobe for each colour.
glm::vec3 colors_of(const Lobes<glm::vec3>& lobes) {
    return {lobes.specular.r, lobes.specular_grazing.g, lobes.diffuse_grazing.b};
}

/// The highlight of a surface with a film. What is under it has what the film's strongest colour
/// leaves, or it would show the film's colours inverted.
glm::vec3 reflect_filmed(const Surface& surface, const Lobes<glm::vec3>& lobes,
                         const EyeCosines& n_v) {
    const glm::vec3 reflected = FilmHighlight(surface, n_v).albedo().rest;
    const float most = std::max({reflected.r, reflected.g, reflected.b});
    const glm::vec3 taken = glm::mix(reflected, glm::vec3(most), surface.film);
    return surface.albedo * glm::max(1.0f - taken, glm::vec3(0.0f)) * lobes.diffuse +
           colors_of(lobes);
}

/// Turquin's factor on the highlight, and the diffuse part in what it leaves.
glm::vec3 reflect_base(const Surface& surface, const Lobes<glm::vec3>& lobes,
                       const EyeCosines& n_v) {
    if (n_v.base <= 0.0f) // no highlight, which takes nothing
        return surface.albedo * lobes.diffuse;
    if (has_film(surface))
        return reflect_filmed(surface, lobes, n_v);
    const GgxAlbedo albedo = ggx_albedo(surface, n_v);
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
    glm::vec3 result = reflect_base(surface, lobes, n_v);
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

glm::vec3 albedo_of_colors(const Surface& surface, const EyeCosines& n_v) {
    return surface.table ? surface.table->rest_albedo(n_v.base)
                         : FilmHighlight(surface, n_v).albedo().all;
}

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
        return surface.albedo * lobes.diffuse + surface.specular * colors_of(lobes);
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
