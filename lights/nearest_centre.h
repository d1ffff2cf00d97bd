// Which of some hundred centres is nearest to a sample.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lights/cluster_metric.h"

namespace relumine::lights {

/// Finds the nearest centre as a loop over all of them would, the first of equally near ones, but
/// works out the arc sine of a few only: a chord is never longer than its arc, so
///     D >= alpha |u - v| / pi + beta L + gamma T,
/// in float and for many centres at once, leaves those that could be the nearest.
class NearestCentre {
public:
    /// The centres are copied, in float for the bound; they must outlive it, too.
    NearestCentre(std::span<const ClusterPoint> centres, const ClusterWeights& weights);

    struct Found {
        std::uint32_t centre = 0;
        double distance = 0.0;
        /// No other centre is nearer than this; infinite where there is none
        double others = 0.0;
    };
    /// `guess`: a centre that is likely to be near. The result does not depend on it. `bounds` is
    /// room for work, resized.
    [[nodiscard]] Found find(const ClusterPoint& point, std::uint32_t guess,
                             std::vector<float>& bounds) const;

    /// What float and rounding may do to a bound on D: bounds are trusted beyond this only.
    [[nodiscard]] static double slack(const ClusterWeights& weights) {
        return 2e-6 * (weights.position + weights.luminance + weights.time);
    }

private:
    std::span<const ClusterPoint> centres_;
    ClusterWeights weights_;
    /// Times their weight, x, y and z over pi
    std::vector<float> x_, y_, z_, luminance_, time_;
};

} // namespace relumine::lights
