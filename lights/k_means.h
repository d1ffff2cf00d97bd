// k-means of a video environment's samples in direction, luminance and time.
// Based on: [S], Section 3.2; G. Hamerly, "Making k-means even faster", 2010 [H10] for the bounds
// that spare searches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "lights/cluster_metric.h"

namespace relumine::lights {

struct KMeansOptions {
    /// Fewer where there are fewer points
    std::size_t num_clusters = 512;
    ClusterWeights weights = {};
    /// Of the first centres: any points, all as likely (Forgy)
    std::uint64_t seed = 1;
    std::size_t max_iterations = 300;
    /// Polled once an iteration; the clusters by then are returned
    std::stop_token stop = {};
    std::function<void(std::size_t iteration, double objective)> on_iteration = {};
};

struct KMeans {
    /// [points] index of the nearest centre, the first of equally near ones
    std::vector<std::uint32_t> cluster_of;
    /// [clusters]
    std::vector<ClusterPoint> centres;
    /// The sum of D over all points, after each assignment; it never rises
    std::vector<double> objective;
    /// No point changed its cluster in the last iteration
    bool converged = false;
    /// Times that a cluster without points was given a new one
    std::size_t num_reseeded = 0;
    /// Clusters without points at the end: more clusters than points that differ
    std::size_t num_empty = 0;
    /// Of points among all centres; points x assignments without bounds
    std::size_t num_searches = 0;
    double seconds = 0.0;
};

/// Assigns points to their nearest centres and moves centres to their points' mean (of directions:
/// on the sphere) until no point changes.
///
/// Differs from [S]: the mean lessens squares of distances, D adds up the distances themselves, so
/// plain means may go round in circles. Here a centre's direction, luminance and time each move to
/// the mean only where that brings the sum of their distances down. So the objective never rises
/// and the iteration ends. A cluster left without points restarts at the point farthest from its
/// centre.
///
/// Parallel; bitwise the same for any number of threads, and as without bounds. Throws
/// std::invalid_argument for weights that are negative or not finite, and for 0 clusters.
[[nodiscard]] KMeans k_means(std::span<const ClusterPoint> points,
                             const KMeansOptions& options = {});

} // namespace relumine::lights
