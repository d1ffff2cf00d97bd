// Normalised Blinn-Phong, from OBJ materials.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "prt/glossy/lobe_facts.h"

namespace relumine::prt {

/// Returns the Blinn-Phong exponent that is evaluated, in 0..1e6. 0 is Lambert; 1e6 is as sharp as
/// the smallest ggx_alpha().
[[nodiscard]] inline float blinn_phong_exponent(float exponent) {
    return std::clamp(exponent, 0.0f, 1e6f);
}

/// Returns the factor of (n.h)^exponent in normalised Blinn-Phong: (e + 2)(e + 4) / (8 pi
/// (2^(-e/2) + e)). The lobe then reflects all light that comes along the normal, and less of any
/// other light.
[[nodiscard]] inline float blinn_phong_norm(float exponent) {
    const float e = blinn_phong_exponent(exponent);
    return (e + 2.0f) * (e + 4.0f) /
           (8.0f * std::numbers::pi_v<float> * (std::exp2(-0.5f * e) + e));
}

/// `specular` is Ks.
struct BlinnPhongLobe {
    static constexpr Highlight Kind = Highlight::BlinnPhong;
    static constexpr LobeFacts Facts{.name = "blinn",
                                     .albedo = "kd",
                                     .specular = "ks",
                                     .shape = "exponent",
                                     .largest_shape = 1e6f,
                                     .needs_specular = true};

    static float narrowness(float exponent) { return 2.0f * std::sqrt(2.0f / (exponent + 2.0f)); }

    static float specular(float exponent, const LobeGeometry& at) {
        return blinn_phong_norm(exponent) * cosine_power(at.sin2, blinn_phong_exponent(exponent)) *
               at.n_w;
    }

    /// The exponent and the norm.
    static std::array<float, 2> parameters(float exponent) {
        return {blinn_phong_exponent(exponent), blinn_phong_norm(exponent)};
    }

private:
    /// Returns cos^exponent of the angle whose squared sine is sin2. Where sin2 is small, log1p
    /// keeps digits that 1 - sin2 would round away.
    static float cosine_power(float sin2, float exponent) {
        if (exponent == 0.0f)
            return 1.0f;
        return std::exp(0.5f * exponent *
                        (sin2 < 0.5f ? std::log1p(-sin2) : std::log(1.0f - sin2)));
    }
};

} // namespace relumine::prt
