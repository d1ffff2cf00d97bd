// k-means of a video environment's samples in direction, luminance and time.
// Based on: [S], Section 3.2; G. Hamerly, "Making k-means even faster", 2010 [H10] for the bounds that spare searches.
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
    std::size_t num_clusters = 512; ///< fewer where there are fewer points
    ClusterWeights weights = {};
    std::uint64_t seed = 1; ///< of the first centres: any points, all as likely (Forgy)
    std::size_t max_iterations = 300;
    std::stop_token stop = {}; ///< polled once an iteration; the clusters by then are returned
    std::function<void(std::size_t iteration, double objective)> on_iteration = {};
};

struct KMeans {
    std::vector<std::uint32_t>
        cluster_of; ///< [points] index of the nearest centre, the first of equally near ones
    std::vector<ClusterPoint> centres; ///< [clusters]
    std::vector<double> objective; ///< the sum of D over all points, after each assignment; it never rises
    bool converged = false;        ///< no point changed its cluster in the last iteration
    std::size_t num_reseeded = 0;  ///< times that a cluster without points was given a new one
    std::size_t num_empty = 0; ///< clusters without points at the end: more clusters than points that differ
    std::size_t num_searches = 0; ///< of points among all centres; points x assignments without bounds
    double seconds = 0.0;
};

/// Assigns points to their nearest centres and moves centres to their points' mean (of directions: on the sphere) until no point changes.
///
/// Differs from [S]: the mean lessens squares of distances, D adds up the distances themselves, so plain means may go round in circles. Here a
/// centre's direction, luminance and time each move to the mean only where that brings the sum of their distances down. So the
/// objective never rises and the iteration ends. A cluster left without points restarts at the point farthest from its centre.
///
/// Parallel; bitwise the same for any number of threads, and as without bounds. Throws std::invalid_argument for weights that are negative or not
/// finite, and for 0 clusters.
[[nodiscard]] KMeans k_means(std::span<const ClusterPoint> points, const KMeansOptions& options = {});

} // namespace relumine::lights
