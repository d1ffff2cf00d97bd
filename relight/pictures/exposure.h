// Exposures that show lit scenes well.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// What is lit is metered as if it reflected at least this part of the light: a dark asset stays
/// dark, and does not make day of a night.
inline constexpr float LeastMeteredAlbedo = 0.25f;

/// What a picture shows of a floor that lies under what is lit.
struct MeteredFloor {
    std::span<const glm::vec3> colors = {};
    /// The part of the picture that each of them is.
    double share = 0.0;
};

/// Returns the exposure in stops that suits what is lit: its bright parts (the 95th percentile of
/// the largest channel) come out a little below white. Where most of it would stay dark, it is
/// brightened by up to a stop and a half more. Hundredths of a stop, from -100 to 100; 0 where
/// nothing is lit.
///
/// `behind` is what the picture shows of a photograph behind and under it. A dark photograph under
/// a bright mesh is brightened by up to 0.6 stops, which the tone curves bear. The photograph must
/// not burn out: three quarters of it stay within half a stop above white, unless what is lit is so
/// dark that its bright parts would fall below a tenth of white. Where nothing is lit, the
/// photograph itself is exposed.
///
/// Nor may a floor under lamps burn out: all of it but a fiftieth of the picture stays within half
/// a stop above white, with the same bound on how dark what is lit may be.
///
/// Shape:   weights is [colors.size()], or empty where all count alike.
/// Cost:    O(n log n).
[[nodiscard]] float suitable_exposure_ev(std::span<const glm::vec3> colors,
                                         std::span<const float> weights = {},
                                         std::span<const glm::vec3> behind = {},
                                         const MeteredFloor& floor = {});

} // namespace relumine::relight
