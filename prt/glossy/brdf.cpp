#include "prt/glossy/brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace relumine::prt {

namespace {

/// Returns the Trowbridge-Reitz distribution times the height-correlated Smith visibility V = G /
/// (4 n.w n.v) times n.w: glTF 2.0, Appendix B.3.2. sin2 is the squared sine of the angle between
/// normal and half vector; 1 - cos^2 would lose it to cancellation where alpha is small. The order
/// of the quotient keeps it finite for any cosine, however small.
float ggx(float alpha, float sin2, float n_w, float n_v) {
    const float a2 = alpha * alpha;
    const float d = sin2 + (1.0f - sin2) * a2; // = cos^2 (a2 - 1) + 1
    const float distribution = a2 / (std::numbers::pi_v<float> * d * d);
    const float mask_v = std::sqrt(n_v * n_v * (1.0f - a2) + a2);
    const float mask_w = std::sqrt(n_w * n_w * (1.0f - a2) + a2);
    return distribution * 0.5f / (mask_v + n_v / n_w * mask_w);
}

/// Returns cos^exponent of the angle whose squared sine is sin2. Where sin2 is small, log1p keeps
/// digits that 1 - sin2 would round away.
float cosine_power(float sin2, float exponent) {
    if (exponent == 0.0f)
        return 1.0f;
    return std::exp(0.5f * exponent * (sin2 < 0.5f ? std::log1p(-sin2) : std::log(1.0f - sin2)));
}

} // namespace

float ggx_alpha(float roughness) {
    return std::max(roughness * roughness, 1e-3f);
}

float blinn_phong_exponent(float exponent) {
    return std::clamp(exponent, 0.0f, 1e6f);
}

/// (e + 2)(e + 4) / (8 pi (2^(-e/2) + e)).
float blinn_phong_norm(float exponent) {
    const float e = blinn_phong_exponent(exponent);
    return (e + 2.0f) * (e + 4.0f) /
           (8.0f * std::numbers::pi_v<float> * (std::exp2(-0.5f * e) + e));
}

Lobes<float> evaluate_lobes(const Surface& surface, const glm::vec3& normal,
                            const glm::vec3& to_eye, const glm::vec3& w) {
    Lobes<float> lobes;
    const float n_w = glm::dot(normal, w);
    if (n_w <= 0.0f)
        return lobes;
    const float n_v = glm::dot(normal, to_eye);
    lobes.diffuse = n_w * std::numbers::inv_pi_v<float>;
    if (surface.highlight == Highlight::None || n_v <= 0.0f)
        return lobes;
    // The half vector is not normalised: |v + w| is 2 v.h.
    const glm::vec3 half = to_eye + w;
    const float length2 = std::max(glm::dot(half, half), 1e-12f);
    const glm::vec3 across = glm::cross(normal, half);
    const float sin2 = std::min(glm::dot(across, across) / length2, 1.0f);
    if (surface.highlight == Highlight::BlinnPhong) {
        lobes.specular = blinn_phong_norm(surface.roughness_or_exponent) *
                         cosine_power(sin2, blinn_phong_exponent(surface.roughness_or_exponent)) *
                         n_w;
        return lobes;
    }
    const float v_h = std::min(0.5f * std::sqrt(length2), 1.0f);
    const float squared = (1.0f - v_h) * (1.0f - v_h);
    const float c = squared * squared * (1.0f - v_h);
    lobes.specular = ggx(ggx_alpha(surface.roughness_or_exponent), sin2, n_w, n_v);
    lobes.diffuse_grazing = c * lobes.diffuse;
    lobes.specular_grazing = c * lobes.specular;
    return lobes;
}

glm::vec3 reflect(const Surface& surface, const Lobes<glm::vec3>& lobes) {
    const glm::vec3 one(1.0f);
    switch (surface.highlight) {
    case Highlight::None:
        return surface.albedo * lobes.diffuse;
    case Highlight::BlinnPhong:
        return surface.albedo * lobes.diffuse + surface.specular * lobes.specular;
    case Highlight::Ggx:
        break;
    }
    // The grazing part of a lobe is no more than the lobe. Each is summed over cells of its own, so
    // sums may say otherwise by their errors.
    const glm::vec3 none(0.0f);
    const glm::vec3 diffuse = glm::max(lobes.diffuse - lobes.diffuse_grazing, none);
    const glm::vec3 specular = glm::max(lobes.specular - lobes.specular_grazing, none);
    // Colours may exceed 1 by what they were rounded.
    return surface.albedo * glm::max(one - surface.specular, none) * diffuse +
           surface.specular * specular + lobes.specular_grazing;
}

} // namespace relumine::prt
