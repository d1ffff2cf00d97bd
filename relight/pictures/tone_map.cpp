#include "relight/pictures/tone_map.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace relumine::relight {

ToneMap::ToneMap(std::vector<LuminanceSample> samples, const ToneMapOptions& options)
    : weights_(options.weights) {
    double largest = 0.0;
    for (const LuminanceSample& sample : samples)
        largest = std::max(largest, sample.luminance);
    for (LuminanceSample& sample : samples)
        sample.luminance = std::max(sample.luminance, options.floor * largest);
    std::erase_if(samples, [](const LuminanceSample& s) { return s.luminance <= 0.0; });
    if (samples.empty())
        return;

    double log_sum = 0.0;
    double weight = 0.0;
    for (const LuminanceSample& sample : samples) {
        log_sum += std::log(sample.luminance) * sample.weight;
        weight += sample.weight;
    }
    constexpr double MiddleGrey = 0.18;
    key_ = MiddleGrey / std::exp(log_sum / weight);

    if (options.white_share == 0.0)
        return;
    std::sort(samples.begin(), samples.end());
    double brighter = 0.0;
    while (samples.size() > 1 && brighter < options.white_share * weight) {
        brighter += samples.back().weight;
        samples.pop_back();
    }
    white_ = std::max(key_ * samples.back().luminance, 1.0);
}

glm::vec3 ToneMap::operator()(const glm::dvec3& radiance) const {
    const double value = key_ * cubemap::luminance(radiance, weights_);
    // Eq. 4 of the paper, divided by the value.
    const double factor = key_ * (1.0 + value / (white_ * white_)) / (1.0 + value);
    return glm::vec3(glm::min(radiance * factor, glm::dvec3(1.0)));
}

} // namespace relumine::relight
