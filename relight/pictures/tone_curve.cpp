#include "relight/pictures/tone_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/mat3x3.hpp>

namespace relumine::relight {

namespace {

/// Where no curve differs from white any more; keeps products finite.
constexpr float BeyondWhite = 1e8f;

glm::vec3 neutral(const glm::vec3& radiance) {
    constexpr float F90 = 0.04f, StartOfCompression = 0.8f - F90, Desaturation = 0.15f;
    const float least = std::min({radiance.r, radiance.g, radiance.b});
    // What a surface reflects at its rim under white light, taken off again.
    const float offset = least < 2.0f * F90 ? least - least * least / (4.0f * F90) : F90;
    const glm::vec3 color = radiance - offset;
    const float peak = std::max({color.r, color.g, color.b});
    if (peak <= StartOfCompression)
        return color;
    constexpr float Rest = 1.0f - StartOfCompression;
    const float shown = 1.0f - Rest * Rest / (peak + Rest - StartOfCompression);
    const float purity = 1.0f / (Desaturation * (peak - shown) + 1.0f);
    return glm::mix(glm::vec3(shown), color * (shown / peak), purity);
}

// Columns of the matrices, as glm has them.
const glm::mat3 Rec2020FromRec709(0.6274f, 0.0691f, 0.0164f, 0.3293f, 0.9195f, 0.0880f, 0.0433f,
                                  0.0113f, 0.8956f);
const glm::mat3 Rec709FromRec2020(1.6605f, -0.1246f, -0.0182f, -0.5876f, 1.1329f, -0.1006f,
                                  -0.0728f, -0.0083f, 1.1187f);
const glm::mat3 AgxInset(0.856627153f, 0.137318973f, 0.111898213f, 0.0951212405f, 0.761241991f,
                         0.0767994186f, 0.0482516061f, 0.101439036f, 0.811302368f);
const glm::mat3 AgxOutset(1.12710058f, -0.141329763f, -0.141329763f, -0.110606643f, 1.15782370f,
                          -0.110606643f, -0.0164939387f, -0.0164939387f, 1.25193641f);

glm::vec3 agx(const glm::vec3& radiance) {
    constexpr float DarkestEv = -12.47393f, BrightestEv = 4.026069f;
    const glm::vec3 inset = glm::max(AgxInset * (Rec2020FromRec709 * radiance), 1e-10f);
    const glm::vec3 x =
        glm::clamp((glm::log2(inset) - DarkestEv) / (BrightestEv - DarkestEv), 0.0f, 1.0f);
    const glm::vec3 x2 = x * x, x4 = x2 * x2;
    const glm::vec3 contrast = 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x +
                               0.4298f * x2 + 0.1191f * x - 0.00232f;
    return Rec709FromRec2020 * glm::pow(glm::max(AgxOutset * contrast, 0.0f), glm::vec3(2.2f));
}

const glm::mat3 AcesInput(0.59719f, 0.07600f, 0.02840f, 0.35458f, 0.90834f, 0.13383f, 0.04823f,
                          0.01566f, 0.83777f);
const glm::mat3 AcesOutput(1.60475f, -0.10208f, -0.00327f, -0.53108f, 1.10813f, -0.07276f,
                           -0.07367f, -0.00605f, 1.07602f);

glm::vec3 aces(const glm::vec3& radiance) {
    constexpr float Brightening = 1.0f / 0.6f;
    const glm::vec3 v = AcesInput * (Brightening * radiance);
    return AcesOutput *
           ((v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f));
}

glm::vec3 curved(ToneCurve curve, const glm::vec3& radiance) {
    switch (curve) {
    case ToneCurve::Neutral:
        return neutral(radiance);
    case ToneCurve::Agx:
        return agx(radiance);
    case ToneCurve::Aces:
        return aces(radiance);
    case ToneCurve::None:
        break;
    }
    return radiance;
}

} // namespace

std::optional<ToneCurve> tone_curve(std::string_view name) {
    for (std::size_t i = 0; i < ToneCurveNames.size(); ++i)
        if (ToneCurveNames[i] == name)
            return static_cast<ToneCurve>(i);
    return std::nullopt;
}

glm::vec3 on_screen(ToneCurve curve, const glm::vec3& radiance) {
    return glm::clamp(curved(curve, glm::clamp(radiance, 0.0f, BeyondWhite)), 0.0f, 1.0f);
}

} // namespace relumine::relight
