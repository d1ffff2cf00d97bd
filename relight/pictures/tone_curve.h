// Tone curves: from the radiance of a scene to the colours of a screen.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// How radiance beyond white comes to the screen.
enum class ToneCurve {
    /// Khronos PBR Neutral: colours of up to 0.8 stay what they are, brighter ones approach white.
    /// (github.com/KhronosGroup/ToneMapping, PBR_Neutral/README.md)
    Neutral,
    /// AgX by T. Sobotka, as in Blender 4: soft contrast, bright colours fade to white. The
    /// contrast curve is the polynomial of B. Wrensch, "Minimal AgX Implementation", 2023; the
    /// matrices are those of Blender's Rec. 2020 form.
    Agx,
    /// Reference rendering and output transform of the Academy, as fitted by S. Hill (BakingLab,
    /// ACES.hlsl), brightened by 1 / 0.6 so that middle grey stays about where it is.
    Aces,
    /// Clipped at 1.
    None,
};

/// Returns the curve of a name: neutral, agx, aces or none; empty for any other word.
[[nodiscard]] std::optional<ToneCurve> tone_curve(std::string_view name);

/// The names of all curves, in the order of the enumerators.
inline constexpr std::array<std::string_view, 4> ToneCurveNames = {"neutral", "agx", "aces",
                                                                   "none"};

/// Returns the linear Rec. 709 colour in [0, 1] that a screen shows for exposed radiance. Radiance
/// must not be NaN; negative radiance counts as 0. Grey stays grey.
[[nodiscard]] glm::vec3 on_screen(ToneCurve curve, const glm::vec3& radiance);

} // namespace relumine::relight
