#include "lights/k_means.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "lights/nearest_centre.h"

namespace relumine::lights {
namespace {

ClusterPoint point(double x, double y, double z, double luminance, double time) {
    return {.direction = glm::normalize(glm::dvec3(x, y, z)), .luminance = luminance, .time = time};
}

/// Clumps over the sphere whose luminance spreads over decades, some points many times.
std::vector<ClusterPoint> clumps(std::size_t count, unsigned seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<glm::dvec3> middles(7);
    for (glm::dvec3& middle : middles)
        middle = glm::normalize(glm::dvec3(normal(engine), normal(engine), normal(engine)));
    std::vector<ClusterPoint> points;
    while (points.size() < count) {
        if (points.size() > 10 && unit(engine) < 0.05) {
            points.push_back(points[engine() % points.size()]);
            continue;
        }
        const glm::dvec3 d = middles[engine() % middles.size()] +
                             (unit(engine) < 0.3 ? 1.0 : 0.05) *
                                 glm::dvec3(normal(engine), normal(engine), normal(engine));
        points.push_back(point(d.x, d.y, d.z, std::pow(10.0, -4.0 * unit(engine)),
                               std::floor(40.0 * unit(engine)) / 40.0));
    }
    return points;
}

std::uint32_t naive_nearest(const ClusterPoint& p, std::span<const ClusterPoint> centres,
                            const ClusterWeights& weights) {
    std::uint32_t best = 0;
    for (std::uint32_t j = 1; j < centres.size(); ++j)
        if (distance(p, centres[j], weights) < distance(p, centres[best], weights))
            best = j;
    return best;
}

TEST(ClusterMetric, HandWorkedValues) {
    const ClusterPoint up = point(0, 1, 0, 0.25, 0.1);
    const ClusterPoint side = point(1, 0, 0, 1.0, 0.4);
    EXPECT_NEAR(position_distance(up, side), 0.5, 1e-15);
    EXPECT_NEAR(distance(up, side, {.position = 3.0, .luminance = 2.0, .time = 10.0}),
                1.5 + 1.5 + 3.0, 1e-14);
    EXPECT_NEAR(position_distance(up, point(0, -1, 0, 0, 0)), 1.0, 1e-15);
    EXPECT_EQ(position_distance(up, up), 0.0);
    // where arccos of the dot product, 1 - 5e-21, would give 0
    EXPECT_NEAR(position_distance(up, point(1e-10, 1, 0, 0, 0)), 1e-10 / std::numbers::pi, 1e-20);
}

TEST(NearestCentre, IsThatOfAPlainLoopWhateverTheGuess) {
    for (const ClusterWeights& weights :
         {ClusterWeights{}, ClusterWeights{.position = 0.0},
          ClusterWeights{.luminance = 50.0, .time = 0.0},
          ClusterWeights{.position = 1e-3, .luminance = 0.0, .time = 0.0}}) {
        const std::vector<ClusterPoint> points = clumps(400, 3);
        std::vector<ClusterPoint> centres(points.begin(), points.begin() + 60);
        centres.push_back(centres[7]); // as near as another: the first wins
        const NearestCentre nearest(centres, weights);
        std::vector<float> room;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto guess = static_cast<std::uint32_t>(i % centres.size());
            const NearestCentre::Found found = nearest.find(points[i], guess, room);
            ASSERT_EQ(found.centre, naive_nearest(points[i], centres, weights)) << i;
            EXPECT_EQ(found.distance, distance(points[i], centres[found.centre], weights));
            for (std::uint32_t j = 0; j < centres.size(); ++j)
                if (j != found.centre) {
                    EXPECT_GE(distance(points[i], centres[j], weights), found.others);
                }
        }
    }
}

TEST(KMeans, TheSameAsWithoutBounds) {
    // What the bounds spare must change nothing: each assignment of the fast version is checked by
    // the centres it ended with, and its whole course by a plain one that starts from the same
    // centres.
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const std::vector<ClusterPoint> points = clumps(3000, static_cast<unsigned>(seed));
        const KMeansOptions options{.num_clusters = 40, .seed = seed};
        const KMeans fast = k_means(points, options);
        ASSERT_TRUE(fast.converged);
        ASSERT_EQ(fast.num_reseeded, 0u);

        // The first centres are those of no iteration at all.
        KMeansOptions none = options;
        none.max_iterations = 0;
        std::vector<ClusterPoint> centres = k_means(points, none).centres;
        std::vector<std::uint32_t> cluster_of(points.size(), 0);
        std::vector<double> objective;
        while (true) {
            bool changed = objective.empty();
            double sum = 0.0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const std::uint32_t best = naive_nearest(points[i], centres, options.weights);
                changed = changed || best != cluster_of[i];
                cluster_of[i] = best;
                sum += distance(points[i], centres[best], options.weights);
            }
            objective.push_back(sum);
            if (!changed)
                break;
            for (std::uint32_t j = 0; j < centres.size(); ++j) {
                glm::dvec3 direction(0.0);
                double luminance = 0.0;
                double time = 0.0;
                double size = 0.0;
                for (std::size_t i = 0; i < points.size(); ++i)
                    if (cluster_of[i] == j) {
                        direction += points[i].direction;
                        luminance += points[i].luminance;
                        time += points[i].time;
                        size += 1.0;
                    }
                if (size == 0.0)
                    continue;
                const ClusterPoint old = centres[j];
                const ClusterPoint mean{.direction = direction / glm::length(direction),
                                        .luminance = luminance / size,
                                        .time = time / size};
                double dp = 0.0;
                double dl = 0.0;
                double dt = 0.0;
                for (std::size_t i = 0; i < points.size(); ++i)
                    if (cluster_of[i] == j) {
                        dp +=
                            position_distance(points[i], old) - position_distance(points[i], mean);
                        dl += luminance_distance(points[i], old) -
                              luminance_distance(points[i], mean);
                        dt += time_distance(points[i], old) - time_distance(points[i], mean);
                    }
                if (dp > 1e-14 * size)
                    centres[j].direction = mean.direction;
                if (dl > 1e-14 * size)
                    centres[j].luminance = mean.luminance;
                if (dt > 1e-14 * size)
                    centres[j].time = mean.time;
            }
        }
        EXPECT_EQ(fast.cluster_of, cluster_of);
        EXPECT_EQ(fast.objective, objective);
        EXPECT_LT(fast.num_searches,
                  points.size() * objective.size() * 3 / 4); // the bounds do spare searches
    }
}

TEST(KMeans, ObjectiveNeverRises) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
        const KMeans result =
            k_means(clumps(2000, static_cast<unsigned>(seed)), {.num_clusters = 100, .seed = seed});
        ASSERT_GT(result.objective.size(), 3u);
        for (std::size_t i = 1; i < result.objective.size(); ++i)
            EXPECT_LE(result.objective[i], result.objective[i - 1] * (1.0 + 1e-12)) << i;
        EXPECT_TRUE(result.converged);
    }
}

TEST(KMeans, TheSameForAnyNumberOfThreads) {
    const std::vector<ClusterPoint> points = clumps(5000, 9);
    const KMeans many = k_means(points, {.num_clusters = 64});
    const files::ThreadLimit one(1);
    const KMeans alone = k_means(points, {.num_clusters = 64});
    EXPECT_EQ(many.cluster_of, alone.cluster_of);
    EXPECT_EQ(many.objective, alone.objective);
    for (std::size_t j = 0; j < many.centres.size(); ++j)
        EXPECT_EQ(many.centres[j].direction, alone.centres[j].direction);
}

TEST(KMeans, EmptyClustersAreReseeded) {
    // 500 times one point, and 4 others: Forgy's start finds the one again and again.
    std::vector<ClusterPoint> points(500, point(0, 1, 0, 1.0, 0.5));
    for (const double x : {-1.0, -0.5, 0.5, 1.0})
        points.push_back(point(x, 0.2, 1, 0.1, 0.5));
    const KMeans result = k_means(points, {.num_clusters = 5});
    EXPECT_GE(result.num_reseeded, 3u);
    EXPECT_EQ(result.num_empty, 0u);
    EXPECT_NEAR(result.objective.back(), 0.0, 1e-12);
    for (std::size_t i = 1; i < result.objective.size(); ++i)
        EXPECT_LE(result.objective[i], result.objective[i - 1]);
    // More clusters than points that differ: the rest stays empty, and is said.
    EXPECT_EQ(k_means(points, {.num_clusters = 8}).num_empty, 3u);
    EXPECT_EQ(k_means(points, {.num_clusters = 600}).centres.size(), points.size());
}

TEST(KMeans, BadOptions) {
    const std::vector<ClusterPoint> points = clumps(20, 1);
    EXPECT_THROW(static_cast<void>(k_means(points, {.num_clusters = 0})), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(k_means(points, {.weights = {.time = -1.0}})),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(k_means(
                     points, {.weights = {.position = std::numeric_limits<double>::quiet_NaN()}})),
                 std::invalid_argument);
    EXPECT_TRUE(k_means({}, {}).converged);
    std::stop_source stop;
    stop.request_stop();
    const KMeans stopped = k_means(points, {.num_clusters = 3, .stop = stop.get_token()});
    EXPECT_FALSE(stopped.converged);
    EXPECT_EQ(stopped.cluster_of.size(), points.size());
}

} // namespace
} // namespace relumine::lights
