// GGX that is rougher along one direction than across it: brushed metal.
//
// Based on: Burley, "Physically-based shading at Disney", 2012 (the distribution); Heitz,
// "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 2014. The
// roughnesses are those of glTF's KHR_materials_anisotropy.
#pragma once

#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "prt/glossy/ggx_lobe.h"
#include "prt/receivers/surface.h"

namespace relumine::prt {

/// Returns alpha along the tangent. Across it, alpha is ggx_alpha().
[[nodiscard]] inline float alpha_along(float roughness, float anisotropy) {
    return glm::mix(ggx_alpha(roughness), 1.0f, anisotropy * anisotropy);
}

/// The lobe of a surface that is stretched.
struct StretchedLobe {
    StretchedLobe(const Surface& surface, const glm::vec3& normal)
        : axes(tangent_frame(surface.tangent, normal)),
          along(alpha_along(surface.roughness_or_exponent, surface.anisotropy)),
          across(ggx_alpha(surface.roughness_or_exponent)) {}

    /// Returns the distribution times the height-correlated visibility and n.w, for unit vectors
    /// above the horizon.
    [[nodiscard]] float value(const glm::vec3& to_eye, const glm::vec3& w) const {
        const glm::vec3 v = to_eye * axes, l = w * axes;
        const glm::vec3 h = glm::normalize(v + l);
        const glm::vec3 wide(along, across, 1.0f);
        const glm::vec3 spread = h / wide;
        const float d = glm::dot(spread, spread);
        const float distribution = 1.0f / (std::numbers::pi_v<float> * along * across * d * d);
        return distribution * 0.5f / (glm::length(wide * v) + v.z / l.z * glm::length(wide * l));
    }

    /// Tangent, bitangent and normal.
    glm::mat3 axes;
    float along, across;
};

} // namespace relumine::prt
