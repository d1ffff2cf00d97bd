// Reflection models as sums of scalar lobes with coloured factors, so that colours stay out of the
// precompute.
//
// With Schlick's F = F0 + (1 - F0) c, c = (1 - v.h)^5, and 1 - F = (1 - F0)(1 - c), the BRDF of
// glTF 2.0 (Appendix B) times the cosine is
//     albedo (1 - F0) (D - Dc)  +  F0 (S - Sc)  +  Sc
// where D = n.w / pi, Dc = c D, S = (GGX distribution) (Smith height-correlated visibility) n.w, Sc
// = c S: four scalars of n, w, v and the roughness alone. Lambert is albedo D, normalised
// Blinn-Phong is albedo D + Ks S with its own S.
#pragma once

#include <glm/vec3.hpp>

#include "prt/glossy/surface.h"

namespace relumine::prt {

/// The scalar lobes for one light: BRDF times cosine without colours, 1/sr. Or sums of radiance
/// times them.
template<typename Value>
struct Lobes {
    /// D
    Value diffuse{};
    /// Dc: what Fresnel takes from D
    Value diffuse_grazing{};
    /// S
    Value specular{};
    /// Sc: what Fresnel whitens of S
    Value specular_grazing{};
};

/// Trowbridge-Reitz alpha of glTF's roughness: its square, but at least 1e-3 (roughness 0.032),
/// below which half a degree of sun is wider than the lobe and float runs out of digits.
[[nodiscard]] float ggx_alpha(float roughness);

/// The exponent of Blinn-Phong that is evaluated: at most 1e6, as sharp as ggx_alpha() at its
/// least; at least 0, which is Lambert.
[[nodiscard]] float blinn_phong_exponent(float exponent);

/// Factor of (n.h)^exponent in normalised Blinn-Phong: reflects all that comes along the normal,
/// and less of all other light.
[[nodiscard]] float blinn_phong_norm(float exponent);

/// The lobes for unit vectors n (normal), to_eye and w (to the light). All zero where the light is
/// below the horizon; only D where the eye is, or for Highlight::None. Always finite. D and S each
/// reflect at most what arrives, so Blinn-Phong does where albedo + Ks <= 1. glTF's sum does not at
/// grazing views: its diffuse part ignores what the highlight takes (white under F0 = 0.04: up
/// to 1.85).
[[nodiscard]] Lobes<float> evaluate_lobes(const Surface& surface, const glm::vec3& normal,
                                          const glm::vec3& to_eye, const glm::vec3& w);

/// The colours put in: outgoing radiance from sums of radiance times lobes; or, for a single light,
/// BRDF times cosine.
[[nodiscard]] glm::vec3 reflect(const Surface& surface, const Lobes<glm::vec3>& lobes);

} // namespace relumine::prt
