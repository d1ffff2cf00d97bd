// The parts of a BRDF.
#pragma once

namespace relumine::prt {

/// The scalar lobes for one light: BRDF times cosine without colours. Also used for sums of
/// radiance times lobe.
///
/// Unit:    1/sr.
template<typename Value>
struct Lobes {
    /// D
    Value diffuse{};
    /// Dc: the part that Fresnel takes from D.
    Value diffuse_grazing{};
    /// S
    Value specular{};
    /// Sc: the part of S that Fresnel makes white.
    Value specular_grazing{};
};

} // namespace relumine::prt
