// The highlight of ggx_lobe.h with the energy that one scattering loses: prt/glossy/ggx_energy.h.
#pragma once

#include "prt/glossy/ggx_lobe.h"

namespace relumine::prt {

/// The lobe is that of GgxLobe. reflect() scales it, and the diffuse part under it.
struct GgxWholeLobe : GgxLobe {
    static constexpr Highlight Kind = Highlight::GgxWhole;
    static constexpr LobeFacts Facts{.name = "ggx",
                                     .albedo = "albedo",
                                     .specular = "f0",
                                     .shape = "roughness",
                                     .largest_shape = 1.0f,
                                     .has_fresnel = true,
                                     .is_roughness = true};
};

} // namespace relumine::prt
