// Tone curves: from the radiance of a scene to the colours of a screen. A curve is a function, an
// enumerator and a line of ToneCurves, all here; the window's shaders have the same functions.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/mat3x3.hpp>
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

/// The curves' functions, in the language that C++ with glm and GLSL 3.30 have in common: `const`
/// is for constants alone. Radiance is 0 to 1e8, and what is returned is clipped to 0 to 1.
namespace tone_curves {

using namespace glm; // NOLINT(google-build-using-namespace): GLSL has no namespaces

// Defines a function, and NAME_source with its words.
#define RELUMINE_TONE_CURVE(name, ...)                                                             \
    inline __VA_ARGS__ inline constexpr std::string_view name##_source = #__VA_ARGS__;

// clang-format off
RELUMINE_TONE_CURVE(neutral, vec3 neutral(vec3 radiance) {
    const float f90 = 0.04f;
    const float start = 0.8f - f90;
    float least = min(min(radiance.r, radiance.g), radiance.b);
    /* What a surface reflects at its rim under white light, taken off again. */
    float offset = least < 2.0f * f90 ? least - least * least / (4.0f * f90) : f90;
    vec3 color = radiance - offset;
    float peak = max(max(color.r, color.g), color.b);
    if (peak <= start)
        return color;
    const float rest = 1.0f - start;
    float shown = 1.0f - rest * rest / (peak + rest - start);
    float purity = 1.0f / (0.15f * (peak - shown) + 1.0f);
    return mix(vec3(shown), color * (shown / peak), purity);
})

/* Columns of the matrices. */
RELUMINE_TONE_CURVE(agx, vec3 agx(vec3 radiance) {
    const mat3 rec2020 = mat3(0.6274f, 0.0691f, 0.0164f, 0.3293f, 0.9195f, 0.0880f,
                              0.0433f, 0.0113f, 0.8956f);
    const mat3 rec709 = mat3(1.6605f, -0.1246f, -0.0182f, -0.5876f, 1.1329f, -0.1006f,
                             -0.0728f, -0.0083f, 1.1187f);
    const mat3 inset = mat3(0.856627153f, 0.137318973f, 0.111898213f,
                            0.0951212405f, 0.761241991f, 0.0767994186f,
                            0.0482516061f, 0.101439036f, 0.811302368f);
    const mat3 outset = mat3(1.12710058f, -0.141329763f, -0.141329763f,
                             -0.110606643f, 1.15782370f, -0.110606643f,
                             -0.0164939387f, -0.0164939387f, 1.25193641f);
    const float darkest = -12.47393f;
    const float brightest = 4.026069f;
    vec3 wide = max(inset * (rec2020 * radiance), 1e-10f);
    vec3 x = clamp((log2(wide) - darkest) / (brightest - darkest), 0.0f, 1.0f);
    vec3 x2 = x * x;
    vec3 x4 = x2 * x2;
    vec3 contrast = 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x +
                          0.4298f * x2 + 0.1191f * x - 0.00232f;
    return rec709 * pow(max(outset * contrast, 0.0f), vec3(2.2f));
})

RELUMINE_TONE_CURVE(aces, vec3 aces(vec3 radiance) {
    const mat3 input_fit = mat3(0.59719f, 0.07600f, 0.02840f, 0.35458f, 0.90834f, 0.13383f,
                                0.04823f, 0.01566f, 0.83777f);
    const mat3 output_fit = mat3(1.60475f, -0.10208f, -0.00327f, -0.53108f, 1.10813f, -0.07276f,
                                 -0.07367f, -0.00605f, 1.07602f);
    const float brightening = 1.0f / 0.6f;
    vec3 v = input_fit * (brightening * radiance);
    return output_fit * ((v * (v + 0.0245786f) - 0.000090537f) /
                         (v * (0.983729f * v + 0.4329510f) + 0.238081f));
})

RELUMINE_TONE_CURVE(none, vec3 none(vec3 radiance) { return radiance; })
// clang-format on

#undef RELUMINE_TONE_CURVE

} // namespace tone_curves

/// All curves, in the order of the enumerators.
struct ToneCurveEntry {
    std::string_view name;
    glm::vec3 (*function)(glm::vec3 radiance);
    /// GLSL
    std::string_view source;
};
inline constexpr std::array<ToneCurveEntry, 4> ToneCurves = {{
    {"neutral", tone_curves::neutral, tone_curves::neutral_source},
    {"agx", tone_curves::agx, tone_curves::agx_source},
    {"aces", tone_curves::aces, tone_curves::aces_source},
    {"none", tone_curves::none, tone_curves::none_source},
}};
static_assert(ToneCurves.size() == static_cast<std::size_t>(ToneCurve::None) + 1);

/// The names of all curves, in the order of the enumerators.
inline constexpr auto ToneCurveNames = [] {
    std::array<std::string_view, ToneCurves.size()> names;
    std::transform(ToneCurves.begin(), ToneCurves.end(), names.begin(),
                   [](const ToneCurveEntry& entry) { return entry.name; });
    return names;
}();

/// Returns the curve of a name: neutral, agx, aces or none; empty for any other word.
[[nodiscard]] std::optional<ToneCurve> tone_curve(std::string_view name);

/// Returns the linear Rec. 709 colour in [0, 1] that a screen shows for exposed radiance. Radiance
/// must not be NaN; negative radiance counts as 0. Grey stays grey.
[[nodiscard]] glm::vec3 on_screen(ToneCurve curve, const glm::vec3& radiance);

/// Returns GLSL for `vec3 on_screen(int curve, vec3 radiance)`, which does the same.
[[nodiscard]] std::string on_screen_source();

} // namespace relumine::relight
