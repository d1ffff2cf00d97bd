// The highlight of glTF 2.0 (Appendix B): metallic-roughness and specular-glossiness materials.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "prt/glossy/lobe_facts.h"

namespace relumine::prt {

/// Returns the Trowbridge-Reitz alpha of glTF's roughness: its square, but at least 1e-3 (roughness
/// 0.032). Below 1e-3 half a degree of sun is wider than the lobe, and float runs out of digits.
[[nodiscard]] inline float ggx_alpha(float roughness) {
    return std::max(roughness * roughness, 1e-3f);
}

/// Trowbridge-Reitz distribution and height-correlated Smith visibility. `specular` is F0.
struct GgxLobe {
    static constexpr Highlight Kind = Highlight::Ggx;
    static constexpr LobeFacts Facts{.name = "ggx-published",
                                     .albedo = "albedo",
                                     .specular = "f0",
                                     .shape = "roughness",
                                     .largest_shape = 1.0f,
                                     .has_fresnel = true,
                                     .has_diffuse_grazing = true,
                                     .is_roughness = true};

    static float narrowness(float roughness) { return 2.0f * ggx_alpha(roughness); }

    /// The distribution times the visibility V = G / (4 n.w n.v) times n.w: glTF 2.0, Appendix
    /// B.3.2. The order of the quotient keeps it finite for any cosine, however small.
    static float specular(float roughness, const LobeGeometry& at) {
        const float alpha = ggx_alpha(roughness);
        const float a2 = alpha * alpha;
        const float d = at.sin2 + (1.0f - at.sin2) * a2; // = cos^2 (a2 - 1) + 1
        const float distribution = a2 / (std::numbers::pi_v<float> * d * d);
        const float mask_v = std::sqrt(at.n_v * at.n_v * (1.0f - a2) + a2);
        const float mask_w = std::sqrt(at.n_w * at.n_w * (1.0f - a2) + a2);
        return distribution * 0.5f / (mask_v + at.n_v / at.n_w * mask_w);
    }

    /// alpha^2
    static std::array<float, 2> parameters(float roughness) {
        const float alpha = ggx_alpha(roughness);
        return {alpha * alpha, 0.0f};
    }
};

} // namespace relumine::prt
