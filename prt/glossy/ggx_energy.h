// How much of the light around it a GGX surface sends to an eye.
//
// Based on: Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 2018 (the integral);
// Turquin, "Practical multiple scattering compensation for microfacet models", 2019 (its use).
#pragma once

#include <array>

#include "prt/receivers/surface.h"

namespace relumine::prt {

/// Integrals of the lobes S and Sc (prt/glossy/brdf.h) over all lights: a furnace of radiance 1.
struct GgxAlbedo {
    /// The integral of S, in (0, 1]. What is missing to 1 is the light that meets a second facet.
    float all = 1.0f;
    /// The integral of Sc, at most `all`.
    float grazing = 0.0f;
};

/// Returns the integrals for a cosine between normal and eye, above 0.
///
/// Error:   below 0.003, of a table of 32 x 32.
/// Cost:    some nanoseconds; the first call makes the table, some 50 ms of processor time.
/// Threads: any.
[[nodiscard]] GgxAlbedo ggx_albedo(float roughness, float n_v);

/// Returns the integrals of a surface's lobe, which may be stretched (StretchedLobe).
///
/// Error:   as above; below 0.01 of a stretched lobe, whose table takes some 400 ms.
[[nodiscard]] GgxAlbedo ggx_albedo(const Surface& surface, const EyeCosines& n_v);

/// Facets with about the same normal: the cosine between the eye and that normal, and their part of
/// the integral of S.
struct LobeFacet {
    float v_h, share;
};

/// Returns facets that stand for the lobe S that is not stretched. Their shares sum to 1.
[[nodiscard]] std::array<LobeFacet, 12> lobe_facets(float roughness, float n_v);

} // namespace relumine::prt
