#include "relight/pictures/exposure.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace relumine::relight {

namespace {

// Chosen by looking at eight meshes under fifteen environments.
constexpr double BrightShare = 0.05;  // of what is lit is brighter than Bright
constexpr double Bright = 0.8;        // where the neutral tone curve begins to compress
constexpr double Middle = 0.1;        // the median is lifted to this, but
constexpr double LargestLift = 1.5;   // by no more than so many stops
constexpr double MiddleBehind = 0.18; // the median of a photograph behind is lifted to this, but
constexpr double LargestRaise = 0.6;  // by no more than so many stops
constexpr double BurntShare = 0.25;   // of a photograph behind may be brighter than Burnt, and more
constexpr double Burnt = 1.4;         // where what is lit
constexpr double BurntFloor = 0.02;   // of the picture may be a floor that is brighter, where
constexpr double DarkestAsset = 3.0;  // would be so many stops below Bright

/// The brightness of a part of what is lit, and its weight.
using Sample = std::pair<float, double>;

/// Returns the brightness that a share of the weight exceeds. `samples` ascend.
double exceeded_by(double share, const std::vector<Sample>& samples, double weight) {
    double brighter = 0.0;
    auto sample = samples.rbegin();
    while (sample + 1 != samples.rend() && brighter + sample->second <= share * weight)
        brighter += (sample++)->second;
    return static_cast<double>(sample->first);
}

float rounded(double ev) {
    return static_cast<float>(std::clamp(std::round(100.0 * ev) / 100.0, -100.0, 100.0));
}

std::vector<Sample> samples_of(std::span<const glm::vec3> colors, std::span<const float> weights) {
    std::vector<Sample> samples;
    samples.reserve(colors.size());
    for (std::size_t i = 0; i < colors.size(); ++i)
        if (const auto own = weights.empty() ? 1.0 : static_cast<double>(weights[i]); own > 0.0)
            samples.emplace_back(std::max({colors[i].r, colors[i].g, colors[i].b}), own);
    std::sort(samples.begin(), samples.end());
    return samples;
}

} // namespace

float suitable_exposure_ev(std::span<const glm::vec3> colors, std::span<const float> weights,
                           std::span<const glm::vec3> behind, const MeteredFloor& floor) {
    const std::vector<Sample> photograph = samples_of(behind, {});
    std::vector<Sample> samples = samples_of(colors, weights);
    if (samples.empty())
        samples = photograph;
    if (samples.empty())
        return 0.0f;
    double weight = 0.0;
    for (const Sample& sample : samples)
        weight += sample.second;
    const double bright = exceeded_by(BrightShare, samples, weight);
    if (!(bright > 0.0))
        return 0.0f;
    double ev = std::log2(Bright / bright);
    const double lowest = ev - DarkestAsset;
    if (const double middle = exceeded_by(0.5, samples, weight); middle > 0.0)
        ev = std::clamp(std::log2(Middle / middle), ev, ev + LargestLift);
    else
        ev += LargestLift;
    const auto size = static_cast<double>(photograph.size());
    const auto spare = [&](double most) {
        if (most > 0.0)
            ev = std::min(ev, std::max(std::log2(Burnt / most), lowest));
    };
    if (!photograph.empty()) {
        if (const double middle = exceeded_by(0.5, photograph, size); middle > 0.0)
            ev = std::clamp(std::log2(MiddleBehind / middle), ev, ev + LargestRaise);
        spare(exceeded_by(BurntShare, photograph, size));
    }
    const std::vector<Sample> ground = samples_of(floor.colors, {});
    const auto ground_size = static_cast<double>(ground.size());
    if (ground_size * floor.share > BurntFloor)
        spare(exceeded_by(BurntFloor / (ground_size * floor.share), ground, ground_size));
    return rounded(ev);
}

} // namespace relumine::relight
