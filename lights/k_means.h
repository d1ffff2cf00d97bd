// k-means of a video environment's samples in direction, luminance and time.
// Based on: [S], Section 3.2; G. Hamerly, "Making k-means even faster", 2010 [H10] for the bounds
// that save searches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "lights/cluster_metric.h"

namespace relumine::lights {

/// Number of clusters, start and weights of k_means().
struct KMeansOptions {
    /// Number of clusters. Fewer if there are fewer points.
    std::size_t num_clusters = 512;
    ClusterWeights weights = {};
    /// Seed for the first centres: random points, all equally likely (Forgy).
    std::uint64_t seed = 1;
    std::size_t max_iterations = 300;
    /// Polled once per iteration. After a stop, the clusters reached so far are returned.
    std::stop_token stop = {};
    std::function<void(std::size_t iteration, double objective)> on_iteration = {};
};

/// The clusters, and how the iteration went.
struct KMeans {
    /// [points] index of the nearest centre. Of equally near centres the first.
    std::vector<std::uint32_t> cluster_of;
    /// [clusters] the centre of each cluster.
    std::vector<ClusterPoint> centres;
    /// Sum of D over all points after each assignment. It never rises.
    std::vector<double> objective;
    /// True if no point changed its cluster in the last iteration.
    bool converged = false;
    /// How often a cluster without points was given a new point.
    std::size_t num_reseeded = 0;
    /// Clusters without points at the end. There are some if there are more clusters than different
    /// points.
    std::size_t num_empty = 0;
    /// Number of searches among all centres. Without bounds: points x assignments.
    std::size_t num_searches = 0;
    double seconds = 0.0;
};

/// Assigns points to their nearest centres and moves centres to the mean of their points, until no
/// point changes its cluster. The mean of directions lies on the sphere.
///
/// Differs from [S]: means reduce squares of distances, but D adds up the distances themselves, so
/// plain means may go round in circles. Here a centre's direction, luminance and time each move to
/// the mean only if the move reduces the sum of their distances. So the objective never rises and
/// the iteration ends. A cluster without points restarts at the point farthest from its centre.
///
/// Threads: parallel; the result is bitwise the same for any number of threads, and the same as
///          without bounds.
/// Throws:  std::invalid_argument for weights that are negative or not finite, and for 0 clusters.
[[nodiscard]] KMeans k_means(std::span<const ClusterPoint> points,
                             const KMeansOptions& options = {});

} // namespace relumine::lights
