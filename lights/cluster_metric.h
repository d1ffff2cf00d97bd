// The distance between samples of a video environment: direction, luminance and time.
// Based on: [S], Section 3.2.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace relumine::lights {

/// alpha, beta and gamma of [S, Eq. 3]. Finite, not negative.
struct ClusterWeights {
    double position = 3.0;
    double luminance = 3.0;
    double time = 1.0;
};

/// What is clustered: a sample, or a cluster's centre.
struct ClusterPoint {
    /// unit
    glm::dvec3 direction{0.0, 1.0, 0.0};
    /// Over the largest of all samples: [0, 1]
    double luminance = 0.0;
    /// Frame over the number of frames: [0, 1)
    double time = 0.0;
};

/// P: the angle over pi [S, Eq. 4]. As an arc of the chord, which keeps small angles that arccos
/// loses below 1e-8.
[[nodiscard]] inline double position_distance(const ClusterPoint& u, const ClusterPoint& v) {
    return 2.0 * std::numbers::inv_pi *
           std::asin(std::min(0.5 * glm::length(u.direction - v.direction), 1.0));
}
/// L [S, Eq. 5].
[[nodiscard]] inline double luminance_distance(const ClusterPoint& u, const ClusterPoint& v) {
    return std::abs(u.luminance - v.luminance);
}
/// T [S, Eq. 6].
[[nodiscard]] inline double time_distance(const ClusterPoint& u, const ClusterPoint& v) {
    return std::abs(u.time - v.time);
}
/// D = alpha P + beta L + gamma T [S, Eq. 3]. Each term is a metric, so D is one: the triangle
/// inequality holds.
[[nodiscard]] inline double distance(const ClusterPoint& u, const ClusterPoint& v,
                                     const ClusterWeights& weights) {
    return weights.position * position_distance(u, v) +
           weights.luminance * luminance_distance(u, v) + weights.time * time_distance(u, v);
}

} // namespace relumine::lights
