// The distance between samples of a video environment in direction, luminance and time.
// Based on: [S], Section 3.2.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace relumine::lights {

/// alpha, beta and gamma of [S, Eq. 3]. Finite and not negative.
struct ClusterWeights {
    double position = 3.0;
    double luminance = 3.0;
    double time = 1.0;
};

/// A point to be clustered: a sample, or the centre of a cluster.
struct ClusterPoint {
    /// Unit direction.
    glm::dvec3 direction{0.0, 1.0, 0.0};
    /// Luminance over the largest luminance of all samples, in [0, 1].
    double luminance = 0.0;
    /// Frame over the number of frames, in [0, 1).
    double time = 0.0;
};

/// Returns P, the angle over pi [S, Eq. 4]. The angle comes from the chord, which keeps small
/// angles; arccos loses angles below 1e-8.
[[nodiscard]] inline double position_distance(const ClusterPoint& u, const ClusterPoint& v) {
    return 2.0 * std::numbers::inv_pi *
           std::asin(std::min(0.5 * glm::length(u.direction - v.direction), 1.0));
}
/// Returns L [S, Eq. 5].
[[nodiscard]] inline double luminance_distance(const ClusterPoint& u, const ClusterPoint& v) {
    return std::abs(u.luminance - v.luminance);
}
/// Returns T [S, Eq. 6].
[[nodiscard]] inline double time_distance(const ClusterPoint& u, const ClusterPoint& v) {
    return std::abs(u.time - v.time);
}
/// Returns D = alpha P + beta L + gamma T [S, Eq. 3]. Each term is a metric, so D obeys the
/// triangle inequality.
[[nodiscard]] inline double distance(const ClusterPoint& u, const ClusterPoint& v,
                                     const ClusterWeights& weights) {
    return weights.position * position_distance(u, v) +
           weights.luminance * luminance_distance(u, v) + weights.time * time_distance(u, v);
}

} // namespace relumine::lights
