// The parts of a GGX surface that keeps its energy.
//
// Based on: Turquin, "Practical multiple scattering compensation for microfacet models", 2019.
#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "prt/glossy/ggx_energy.h"
#include "prt/receivers/surface.h"

namespace relumine::prt {

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

/// Schlick's (1 - v.h)^5.
[[nodiscard]] inline float schlick(float v_h) {
    const float less = 1.0f - v_h, squared = less * less;
    return squared * squared * less;
}

} // namespace relumine::prt
