// Sheen: the light that fibres of cloth send on towards the horizon.
//
// Based on: Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", 2017, the lobe of
// glTF's KHR_materials_sheen.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "prt/glossy/lobe_facts.h"
#include "prt/receivers/surface.h"

namespace relumine::prt {

/// Whether a surface has sheen, or a coat. GGX as published has neither.
[[nodiscard]] inline bool has_sheen(const Surface& surface) {
    return surface.highlight == Highlight::GgxWhole && surface.sheen != glm::vec3(0.0f);
}
[[nodiscard]] inline bool has_coat(const Surface& surface) {
    return surface.highlight == Highlight::GgxWhole && surface.coat > 0.0f;
}

/// The distribution of fibres and their shadowing. The lobe never reflects more than arrives.
struct SheenLobe {
    /// glTF's roughness, squared. Fibres of less than 0.005 all stand upright.
    static float alpha(float roughness) { return std::max(roughness * roughness, 5e-3f); }

    /// The five numbers of the shadowing at an alpha [Estevez and Kulla, Table 1].
    static std::array<float, 5> fit(float alpha) {
        const float t = (1.0f - alpha) * (1.0f - alpha);
        const auto between = [t](float rough, float smooth) {
            return (1.0f - t) * rough + t * smooth;
        };
        return {between(21.5473f, 25.3245f), between(3.82987f, 3.32435f),
                between(0.19823f, 0.16801f), between(-1.97760f, -1.27393f),
                between(-4.32054f, -4.85967f)};
    }

    /// Lambda of a cosine.
    static float lambda(const std::array<float, 5>& fit, float cosine) {
        const auto l = [&](float x) {
            return fit[0] / (1.0f + fit[1] * std::pow(x, fit[2])) + fit[3] * x + fit[4];
        };
        const float x = std::clamp(cosine, LeastCosine, 1.0f);
        return std::exp(x < 0.5f ? l(x) : 2.0f * l(0.5f) - l(std::max(1.0f - x, LeastCosine)));
    }

    /// The distribution times the shadowing and n.w, without the limit of albedo().
    static float unlimited(float roughness, const LobeGeometry& at) {
        const float sharpness = 1.0f / alpha(roughness);
        const std::array<float, 5> of = fit(alpha(roughness));
        const float distribution = (2.0f + sharpness) * 0.5f * std::numbers::inv_pi_v<float> *
                                   std::pow(std::max(at.sin2, 1e-12f), 0.5f * sharpness);
        return distribution / ((1.0f + lambda(of, at.n_v) + lambda(of, at.n_w)) * 4.0f * at.n_v);
    }

    /// The lobe.
    static float value(float roughness, const LobeGeometry& at);

    static constexpr float LeastCosine = 1e-4f;
};

/// Returns what the lobe reflects of a white sky, 0 to 1, for a cosine between normal and eye above
/// 0.
///
/// Error:   below 0.005, of a table of 32 x 32.
/// Cost:    some nanoseconds; the first call makes the table.
/// Threads: any.
[[nodiscard]] float sheen_albedo(float roughness, float n_v);

/// Returns the factor on the lobe that keeps its albedo within 1.
[[nodiscard]] float sheen_limit(float roughness, float n_v);

} // namespace relumine::prt
