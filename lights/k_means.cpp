#include "lights/k_means.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "cubemap/split_mix64.h"
#include "files/parallel.h"
#include "files/seconds.h"
#include "lights/nearest_centre.h"

namespace relumine::lights {

namespace {

/// Points per task: about 0.3 ms if each point needs a search.
constexpr std::size_t PointsPerTask = 512;

std::vector<ClusterPoint> forgy(std::span<const ClusterPoint> points, std::size_t num_clusters,
                                cubemap::SplitMix64& random) {
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::vector<ClusterPoint> centres;
    // Fisher and Yates' shuffle, stopped after the first num_clusters.
    for (std::size_t i = 0; i < num_clusters; ++i) {
        std::swap(order[i], order[i + random.below(points.size() - i)]);
        centres.push_back(points[order[i]]);
    }
    return centres;
}

class Iteration {
public:
    Iteration(std::span<const ClusterPoint> points, std::vector<ClusterPoint> centres,
              const ClusterWeights& weights, KMeans& result)
        : points_(points), weights_(weights), slack_(NearestCentre::slack(weights)),
          result_(result), distance_(points.size()), others_(points.size(), 0.0),
          moves_(centres.size(), 0.0) {
        result_.centres = std::move(centres);
        result_.cluster_of.assign(points.size(), 0);
    }

    /// Assigns every point to its nearest centre. Returns the number of points that changed.
    std::size_t assign() {
        // [H10]: a point keeps its centre without a search if no other centre can have come nearer
        // than its own.
        const auto farthest = std::max_element(moves_.begin(), moves_.end());
        const auto most_moved = static_cast<std::uint32_t>(farthest - moves_.begin());
        const double first = *farthest;
        double second = 0.0;
        for (std::size_t j = 0; j < moves_.size(); ++j)
            if (j != most_moved)
                second = std::max(second, moves_[j]);

        const NearestCentre nearest(result_.centres, weights_);
        const std::size_t num_tasks = (points_.size() + PointsPerTask - 1) / PointsPerTask;
        std::vector<std::size_t> changed(num_tasks, 0);
        std::vector<std::size_t> searched(num_tasks, 0);
        files::parallel_for(std::size_t{0}, num_tasks, [&](std::size_t task) {
            std::vector<float> bounds;
            const std::size_t end = std::min((task + 1) * PointsPerTask, points_.size());
            for (std::size_t i = task * PointsPerTask; i < end; ++i) {
                std::uint32_t& cluster = result_.cluster_of[i];
                distance_[i] = distance(points_[i], result_.centres[cluster], weights_);
                others_[i] -= cluster == most_moved ? second : first;
                if (distance_[i] < others_[i] - slack_)
                    continue;
                const NearestCentre::Found found = nearest.find(points_[i], cluster, bounds);
                changed[task] += found.centre != cluster ? 1 : 0;
                ++searched[task];
                cluster = found.centre;
                distance_[i] = found.distance;
                others_[i] = found.others;
            }
        });
        result_.num_searches += std::accumulate(searched.begin(), searched.end(), std::size_t{0});
        result_.objective.push_back(std::accumulate(distance_.begin(), distance_.end(), 0.0));
        return std::accumulate(changed.begin(), changed.end(), std::size_t{0});
    }

    /// Moves every centre. Returns true if any moved.
    bool move_centres() {
        std::fill(moves_.begin(), moves_.end(), 0.0);
        reseed();
        sort_members();
        files::parallel_for(std::size_t{0}, result_.centres.size(), [&](std::size_t cluster) {
            const std::span<const std::uint32_t> members(members_.data() + begin_[cluster],
                                                         begin_[cluster + 1] - begin_[cluster]);
            if (members.empty())
                return;
            ClusterPoint& centre = result_.centres[cluster];
            const ClusterPoint moved = better_centre(members, centre);
            moves_[cluster] += distance(centre, moved, weights_);
            centre = moved;
        });
        return std::any_of(moves_.begin(), moves_.end(), [](double move) { return move > 0.0; });
    }

    [[nodiscard]] std::size_t num_empty() const {
        std::vector<char> used(result_.centres.size(), 0);
        for (const std::uint32_t cluster : result_.cluster_of)
            used[cluster] = 1;
        return static_cast<std::size_t>(std::count(used.begin(), used.end(), 0));
    }

private:
    /// Gives each cluster without points the point farthest from its centre, the first of equally
    /// far ones, from a cluster with several points.
    void reseed() {
        std::vector<std::size_t> sizes(result_.centres.size(), 0);
        for (const std::uint32_t cluster : result_.cluster_of)
            ++sizes[cluster];
        for (std::size_t cluster = 0; cluster < sizes.size(); ++cluster) {
            if (sizes[cluster] != 0)
                continue;
            std::size_t chosen = points_.size();
            double farthest = 0.0;
            for (std::size_t i = 0; i < points_.size(); ++i)
                if (distance_[i] > farthest && sizes[result_.cluster_of[i]] > 1) {
                    chosen = i;
                    farthest = distance_[i];
                }
            if (chosen == points_.size()) // all points lie on centres
                return;
            --sizes[result_.cluster_of[chosen]];
            sizes[cluster] = 1;
            moves_[cluster] = distance(result_.centres[cluster], points_[chosen], weights_);
            result_.centres[cluster] = points_[chosen];
            result_.cluster_of[chosen] = static_cast<std::uint32_t>(cluster);
            distance_[chosen] = 0.0;
            others_[chosen] = 0.0; // its bound is unknown
            ++result_.num_reseeded;
        }
    }

    /// Sorts the points by cluster and keeps their order within each. So a sum over a cluster
    /// always has the same order.
    void sort_members() {
        begin_.assign(result_.centres.size() + 1, 0);
        for (const std::uint32_t cluster : result_.cluster_of)
            ++begin_[cluster + 1];
        std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
        std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
        members_.resize(points_.size());
        for (std::size_t i = 0; i < points_.size(); ++i)
            members_[next[result_.cluster_of[i]]++] = static_cast<std::uint32_t>(i);
    }

    [[nodiscard]] ClusterPoint better_centre(std::span<const std::uint32_t> members,
                                             const ClusterPoint& centre) const {
        ClusterPoint mean{.direction = glm::dvec3(0.0), .luminance = 0.0, .time = 0.0};
        for (const std::uint32_t i : members) {
            mean.direction += points_[i].direction;
            mean.luminance += points_[i].luminance;
            mean.time += points_[i].time;
        }
        const auto size = static_cast<double>(members.size());
        const double length = glm::length(mean.direction);
        // Directions that cancel have no mean.
        mean.direction = length > 1e-9 * size ? mean.direction / length : centre.direction;
        mean.luminance /= size;
        mean.time /= size;
        double position = 0.0; // by how much the mean reduces the distances
        double luminance = 0.0;
        double time = 0.0;
        for (const std::uint32_t i : members) {
            position += position_distance(points_[i], centre) - position_distance(points_[i], mean);
            luminance +=
                luminance_distance(points_[i], centre) - luminance_distance(points_[i], mean);
            time += time_distance(points_[i], centre) - time_distance(points_[i], mean);
        }
        // Only a gain above rounding counts, or equal points would wander in the last bits.
        const double rounding = 1e-14 * size;
        return {.direction = position > rounding ? mean.direction : centre.direction,
                .luminance = luminance > rounding ? mean.luminance : centre.luminance,
                .time = time > rounding ? mean.time : centre.time};
    }

    std::span<const ClusterPoint> points_;
    ClusterWeights weights_;
    double slack_;
    KMeans& result_;
    /// [points] distance to the point's own centre.
    std::vector<double> distance_;
    /// [points] no other centre is nearer than this.
    std::vector<double> others_;
    /// [clusters] how far the centre moved since the last assignment.
    std::vector<double> moves_;
    /// [clusters + 1] begin of each cluster in members_.
    std::vector<std::size_t> begin_;
    /// [points] point indices, cluster after cluster.
    std::vector<std::uint32_t> members_;
};

void check(const KMeansOptions& options) {
    for (const double weight :
         {options.weights.position, options.weights.luminance, options.weights.time})
        if (!std::isfinite(weight) || weight < 0.0)
            throw std::invalid_argument(
                fmt::format("expected weights that are finite and not negative, got {}", weight));
    if (options.num_clusters == 0)
        throw std::invalid_argument("expected at least 1 cluster, got 0");
}

} // namespace

KMeans k_means(std::span<const ClusterPoint> points, const KMeansOptions& options) {
    check(options);
    const auto start_time = std::chrono::steady_clock::now();
    KMeans result;
    if (points.empty()) {
        result.converged = true;
        return result;
    }
    cubemap::SplitMix64 random(options.seed);
    const std::size_t num_clusters = std::min(options.num_clusters, points.size());
    Iteration iteration(points, forgy(points, num_clusters, random), options.weights, result);
    iteration.assign();
    for (std::size_t step = 0; step < options.max_iterations && !options.stop.stop_requested();
         ++step) {
        if (options.on_iteration)
            options.on_iteration(step, result.objective.back());
        if (!iteration.move_centres() || iteration.assign() == 0) {
            result.converged = true;
            break;
        }
    }
    result.num_empty = iteration.num_empty();
    result.seconds = files::seconds_since(start_time);
    return result;
}

} // namespace relumine::lights
