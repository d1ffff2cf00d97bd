// Reflection models as sums of scalar lobes with coloured factors. So colours stay out of the
// precompute.
//
// With Schlick's F = F0 + (1 - F0) c, c = (1 - v.h)^5, and 1 - F = (1 - F0)(1 - c), the BRDF of
// glTF 2.0 (Appendix B) times the cosine is
//
//     albedo (1 - F0) (D - Dc)  +  F0 (S - Sc)  +  Sc
//
// where D = n.w / pi, Dc = c D, S = (GGX distribution) (Smith height-correlated visibility) n.w and
// Sc = c S. The four scalars depend on n, w, v and the roughness alone. Lambert is albedo D.
// Normalised Blinn-Phong is albedo D + Ks S with its own S.
//
// GGX that keeps its energy has S, Sc and D, with factors that depend on n.v:
//
//     albedo (1 - R) D  +  m (F0 (S - Sc) + Sc),   m = 1 + F0 (1 - E) / E,
//     R = m (F0 (E - Ec) + Ec)
//
// A clear coat is one more GGX lobe of F0 = 0.04 over all of this, with a normal of its own, and
// sheen a lobe between both (prt/glossy/sheen_lobe.h). Each leaves to what is under it what it does
// not reflect of a white sky.
//
// A measured BRDF is albedo D plus three lobes, for red, green and blue, in the places of S, Sc and
// Dc: prt/glossy/measured_lobe.h.
//
// A thin film gives each colour a Fresnel of its own (prt/glossy/thin_film.h). So three lobes, for
// red, green and blue, are in the same places: what Fresnel leaves of S, with its factor m.
//
// Above, E and Ec are the integrals of S and Sc over all lights (prt/glossy/ggx_energy.h): R is
// what the highlight reflects of a white sky.
#pragma once

#include <glm/vec3.hpp>

#include "prt/glossy/lobe_list.h"
#include "prt/glossy/lobes.h"
#include "prt/glossy/thin_film.h"

namespace relumine::prt {

/// Returns the lobes for unit vectors n (normal), to_eye and w (to the light). Always finite.
///
/// All lobes are zero where the light is below the horizon. Only D is set where the eye is below
/// it, and for Highlight::None.
///
/// D and S each reflect at most the light that arrives. So Blinn-Phong reflects at most that light
/// where albedo + Ks <= 1, and Highlight::GgxWhole reflects what arrives, and never more. The sum
/// of glTF exceeds it at grazing views, up to 1.85 for white under F0 = 0.04: its diffuse part
/// ignores what the highlight takes.
[[nodiscard]] Lobes<float> evaluate_lobes(const Surface& surface, const glm::vec3& normal,
                                          const glm::vec3& to_eye, const glm::vec3& w);

/// Whether the lobes S, Sc and Dc of a surface are those of red, green and blue: of a measured
/// BRDF, or under a thin film.
[[nodiscard]] inline bool has_lobes_of_colors(const Surface& surface) {
    return surface.table != nullptr || has_film(surface);
}

/// Returns the integral of such lobes over all lights.
[[nodiscard]] glm::vec3 albedo_of_colors(const Surface& surface, const EyeCosines& n_v);

/// Puts the colours in. Returns outgoing radiance for sums of radiance times lobe, or BRDF times
/// cosine for the lobes of a single light. `n_v` are the cosines between normals and eye; only
/// Highlight::GgxWhole asks for them.
[[nodiscard]] glm::vec3 reflect(const Surface& surface, const Lobes<glm::vec3>& lobes,
                                const EyeCosines& n_v);

/// Returns the factor on diffuse light from other surfaces: the albedo, less what the highlight of
/// a GgxWhole takes.
[[nodiscard]] glm::vec3 diffuse_albedo(const Surface& surface, const EyeCosines& n_v);

/// Returns what the lobe of a clear coat reflects of a white sky, without the factor that keeps its
/// energy, for a cosine between its normal and the eye above 0.
[[nodiscard]] float coat_albedo(float roughness, float n_v);

} // namespace relumine::prt
