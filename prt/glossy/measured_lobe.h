// Any BRDF: a table of mesh/materials/brdf_table.h, of a surface's own.
#pragma once

#include <array>

#include "prt/glossy/ggx_lobe.h"

namespace relumine::prt {

/// What a table has beyond its Lambertian part. Its red, green and blue take the places of the
/// lobes S, Sc and Dc, each for its own colour of light. The shape says how wide it is, as of a
/// GGX.
struct MeasuredLobe {
    static constexpr Highlight Kind = Highlight::Measured;
    static constexpr LobeFacts Facts{.name = "brdf", .albedo = "", .is_table = true};

    static float narrowness(float roughness) { return GgxLobe::narrowness(roughness); }
    /// Red, green and blue, times n.w.
    static glm::vec3 colors(const mesh::BrdfTable& table, const LobeGeometry& at) {
        return at.n_w * table.rest(at.n_w, at.n_v, at.sin2);
    }
    static std::array<float, 2> parameters(float) { return {}; }
};

} // namespace relumine::prt
