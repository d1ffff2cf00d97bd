// What every lobe, the highlight of a surface, says of itself.
#pragma once

#include <string_view>

#include "prt/receivers/surface.h"

namespace relumine::prt {

/// How a lobe is called, and what its numbers may be.
struct LobeFacts {
    /// In --material.
    std::string_view name;
    /// Names of Surface::albedo, specular and roughness_or_exponent; empty: not used.
    std::string_view albedo;
    std::string_view specular = {};
    std::string_view shape = {};
    float largest_shape = 1e6f;
    /// The specular colour must be given, and with the albedo it is at most 1.
    bool needs_specular = false;
    /// The specular colour is F0. Fresnel makes the highlight white at grazing angles.
    bool has_fresnel = false;
    /// Fresnel takes from the diffuse part light by light: the lobe Dc.
    bool has_diffuse_grazing = false;
    /// The shape is a roughness: cells of the quadtree cannot hold the smallest.
    bool is_roughness = false;
    /// The surface has a table. Its red, green and blue take the places of S, Sc and Dc.
    bool is_table = false;
};

/// F0 of glass and plastic: glTF 2.0, Appendix B.
inline constexpr float DielectricF0 = 0.04f;

/// Cosines of the directions to the light and to the eye, both above 0, and the squared sine of the
/// angle between normal and half vector; 1 - cos^2 would lose it to cancellation in sharp lobes.
struct LobeGeometry {
    float n_w, n_v, sin2;
};

} // namespace relumine::prt
