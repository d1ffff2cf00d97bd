#include "prt/glossy/brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace relumine::prt {

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
    lobes.specular = with_lobe(surface.highlight, [&](auto lobe) {
        return lobe.specular(surface.roughness_or_exponent, {n_w, n_v, sin2});
    });
    if (!facts_of(surface.highlight).has_fresnel)
        return lobes;
    const float v_h = std::min(0.5f * std::sqrt(length2), 1.0f);
    const float squared = (1.0f - v_h) * (1.0f - v_h);
    const float c = squared * squared * (1.0f - v_h);
    lobes.diffuse_grazing = c * lobes.diffuse;
    lobes.specular_grazing = c * lobes.specular;
    return lobes;
}

glm::vec3 reflect(const Surface& surface, const Lobes<glm::vec3>& lobes) {
    if (surface.highlight == Highlight::None)
        return surface.albedo * lobes.diffuse;
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
