#include "lights/nearest_centre.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace relumine::lights {

NearestCentre::NearestCentre(std::span<const ClusterPoint> centres, const ClusterWeights& weights)
    : centres_(centres), weights_(weights), x_(centres.size()), y_(centres.size()),
      z_(centres.size()), luminance_(centres.size()), time_(centres.size()) {
    const double scale = weights.position * std::numbers::inv_pi;
    for (std::size_t i = 0; i < centres.size(); ++i) {
        x_[i] = static_cast<float>(scale * centres[i].direction.x);
        y_[i] = static_cast<float>(scale * centres[i].direction.y);
        z_[i] = static_cast<float>(scale * centres[i].direction.z);
        luminance_[i] = static_cast<float>(weights.luminance * centres[i].luminance);
        time_[i] = static_cast<float>(weights.time * centres[i].time);
    }
}

NearestCentre::Found NearestCentre::find(const ClusterPoint& point, std::uint32_t guess,
                                         std::vector<float>& bounds) const {
    const std::size_t num_centres = centres_.size();
    bounds.resize(num_centres);
    const double scale = weights_.position * std::numbers::inv_pi;
    const auto px = static_cast<float>(scale * point.direction.x);
    const auto py = static_cast<float>(scale * point.direction.y);
    const auto pz = static_cast<float>(scale * point.direction.z);
    const auto luminance = static_cast<float>(weights_.luminance * point.luminance);
    const auto time = static_cast<float>(weights_.time * point.time);
    const auto margin = static_cast<float>(slack(weights_));
    float* const bound = bounds.data();
    // The loop has no branches, so compilers vectorise it.
    for (std::size_t i = 0; i < num_centres; ++i) {
        const float dx = x_[i] - px;
        const float dy = y_[i] - py;
        const float dz = z_[i] - pz;
        bound[i] = std::sqrt(dx * dx + dy * dy + dz * dz) + std::abs(luminance_[i] - luminance) +
                   std::abs(time_[i] - time) - margin;
    }

    Found found{.centre = guess,
                .distance = distance(point, centres_[guess], weights_),
                .others = std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < num_centres; ++i) {
        const auto least = static_cast<double>(bound[i]);
        // A centre that is neither the nearest nor the second nearest needs no exact distance.
        if (least >= found.others || i == guess)
            continue;
        if (least > found.distance) {
            found.others = least;
            continue;
        }
        const double exact = distance(point, centres_[i], weights_);
        if (exact < found.distance || (exact == found.distance && i < found.centre)) {
            found.others = std::min(found.others, found.distance);
            found.centre = static_cast<std::uint32_t>(i);
            found.distance = exact;
        } else {
            found.others = std::min(found.others, exact);
        }
    }
    return found;
}

} // namespace relumine::lights
