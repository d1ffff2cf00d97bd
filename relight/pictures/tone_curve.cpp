#include "relight/pictures/tone_curve.h"

#include <fmt/format.h>

namespace relumine::relight {

namespace {

/// Where no curve differs from white any more; keeps products finite.
constexpr float BeyondWhite = 1e8f;

} // namespace

std::optional<ToneCurve> tone_curve(std::string_view name) {
    for (std::size_t i = 0; i < ToneCurveNames.size(); ++i)
        if (ToneCurveNames[i] == name)
            return static_cast<ToneCurve>(i);
    return std::nullopt;
}

glm::vec3 on_screen(ToneCurve curve, const glm::vec3& radiance) {
    const ToneCurveEntry& entry = ToneCurves[static_cast<std::size_t>(curve)];
    return glm::clamp(entry.function(glm::clamp(radiance, 0.0f, BeyondWhite)), 0.0f, 1.0f);
}

std::string on_screen_source() {
    std::string functions;
    std::string cases;
    for (std::size_t i = 0; i < ToneCurves.size(); ++i) {
        functions += fmt::format("{}\n", ToneCurves[i].source);
        cases += fmt::format("    if (curve == {}) x = {}(x);\n", i, ToneCurves[i].name);
    }
    return fmt::format("{}vec3 on_screen(int curve, vec3 radiance) {{\n"
                       "    vec3 x = clamp(radiance, 0.0, {:.1f});\n{}"
                       "    return clamp(x, 0.0, 1.0);\n}}\n",
                       functions, BeyondWhite, cases);
}

} // namespace relumine::relight
