// Finds the nearest of some hundred centres.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lights/cluster_metric.h"

namespace relumine::lights {

/// Finds the centre nearest to a point, as a loop over all centres would: of equally near centres
/// the first. Only a few arc sines are computed. A chord is never longer than its arc, so
///     D >= alpha |u - v| / pi + beta L + gamma T.
/// This bound, in float and for many centres at once, leaves the centres that could be the nearest.
class NearestCentre {
public:
    /// Copies the centres in float for the bound. `centres` must also outlive the object.
    NearestCentre(std::span<const ClusterPoint> centres, const ClusterWeights& weights);

    struct Found {
        std::uint32_t centre = 0;
        double distance = 0.0;
        /// No other centre is nearer than this. Infinite if there is no other centre.
        double others = 0.0;
    };
    /// Finds the centre nearest to a point. `guess` is a centre that is likely to be near; the
    /// result does not depend on it. `bounds` is scratch space and is resized.
    [[nodiscard]] Found find(const ClusterPoint& point, std::uint32_t guess,
                             std::vector<float>& bounds) const;

    /// Returns the largest error that float and rounding may cause in a bound on D. Bounds are
    /// trusted only beyond this slack.
    [[nodiscard]] static double slack(const ClusterWeights& weights) {
        return 2e-6 * (weights.position + weights.luminance + weights.time);
    }

private:
    std::span<const ClusterPoint> centres_;
    ClusterWeights weights_;
    /// Coordinates times their weight; x, y and z also over pi.
    std::vector<float> x_, y_, z_, luminance_, time_;
};

} // namespace relumine::lights
