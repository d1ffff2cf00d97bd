#include "relight/pictures/exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace relumine::relight {

float suitable_exposure_ev(std::span<const glm::vec3> radiance) {
    std::vector<float> brightness;
    brightness.reserve(radiance.size());
    for (const glm::vec3& value : radiance)
        brightness.push_back(std::max({value.r, value.g, value.b}));
    if (brightness.empty())
        return 0.0f;
    const auto bright =
        brightness.begin() + static_cast<std::ptrdiff_t>(brightness.size() * 49 / 50);
    std::nth_element(brightness.begin(), bright, brightness.end());
    if (!(*bright > 0.0f) || (*bright > 0.4f && *bright < 2.5f))
        return 0.0f;
    return std::clamp(0.5f * std::round(-2.0f * std::log2(*bright)), -20.0f, 20.0f);
}

} // namespace relumine::relight
