#include "prt/precompute.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cubemap/cube_map.h"
#include "files/parallel.h"
#include "prt/clusters/lattice.h"
#include "prt/receivers/receiver_order.h"
#include "prt/visibility/ray_scene.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/same_transfer.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// Outgoing radiance of every receiver, in the receivers' order, under a sky of radiance 1, from
/// exact vector irradiances.
std::vector<double> radiance_under_white(const Transfer& transfer) {
    std::vector<double> radiance(transfer.num_receivers());
    for (std::size_t leaf = 0; leaf < transfer.num_clusters(); ++leaf) {
        const glm::dvec3 irradiance =
            scenes::vector_irradiance_of_white(transfer.quadtree.leaves()[leaf]);
        for (std::size_t place = 0; place < radiance.size(); ++place) {
            const double cosine =
                std::max(0.0, glm::dot(glm::dvec3(transfer.normals[place]), irradiance));
            radiance[transfer.order[place]] +=
                transfer.counts.count(place, leaf) / 16.0 * cosine / std::numbers::pi;
        }
    }
    return radiance;
}

/// Receivers of random normals at random places.
Receivers random_receivers(std::size_t n, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> coordinate(-1.0f, 1.0f);
    Receivers receivers;
    for (std::size_t i = 0; i < n; ++i) {
        receivers.positions.emplace_back(coordinate(random), coordinate(random),
                                         coordinate(random));
        receivers.normals.push_back(scenes::random_direction(random));
    }
    return receivers;
}

/// Along the x axis, facing up.
Receivers row_of_receivers(std::size_t n, float from, float to) {
    Receivers receivers;
    for (std::size_t i = 0; i < n; ++i) {
        const float at = static_cast<float>(i) / static_cast<float>(n - 1);
        receivers.positions.emplace_back(from + at * (to - from), 0.0f, 0.0f);
        receivers.normals.emplace_back(0.0f, 1.0f, 0.0f);
    }
    return receivers;
}

/// A mesh scene small enough to be precomputed many times.
struct SmallScene {
    mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    Receivers receivers = vertex_receivers(mesh);
    RayScene rays{mesh};
    PrecomputeOptions options{
        .tolerance = 0.02f, .face_resolution = 64, .bias = automatic_bias(mesh)};

    [[nodiscard]] Transfer transfer(const Work& work = {}) const {
        return precompute(receivers, rays, options, work);
    }
};

TEST(Precompute, WhiteFurnace) {
    const Receivers receivers = random_receivers(300, 1);
    for (const float tolerance : {0.0135f, 0.003f}) {
        const Transfer transfer = precompute(receivers, scenes::no_blockers(),
                                             {.tolerance = tolerance, .face_resolution = 256});
        double sum = 0.0;
        for (const double b : radiance_under_white(transfer)) {
            // Only cells that the horizon cuts err: max(n.E, 0) leaves out some of what is above.
            // Along a horizon of length 2 pi and for cells of a width w, this is w^2 / 24 on the
            // mean and w^2 / 8 at most. T runs from 0 to w / pi in such a cell, so w is at most
            // four times pi times the tolerance.
            const double w = 4.0 * std::numbers::pi * static_cast<double>(tolerance);
            EXPECT_LT(b, 1.0 + 1e-6);
            EXPECT_GT(b, 1.0 - w * w / 4.0);
            sum += b;
        }
        EXPECT_NEAR(sum / 300.0, 1.0, tolerance < 0.01f ? 6e-5 : 1e-3);
    }
}

TEST(Precompute, FloorWithNothingInTheWay) {
    // The horizon runs along cell edges. The samples on it are not above it, and nothing of the
    // cells above it is lost.
    const Transfer transfer = precompute(row_of_receivers(20, -1.0f, 1.0f), scenes::no_blockers());
    for (const double b : radiance_under_white(transfer))
        EXPECT_NEAR(b, 1.0, 1e-6);
    EXPECT_EQ(transfer.counts.num_mixed(), 0u);
}

// A half-plane parallel to the receiver at height h whose edge is d away hides the lune from the
// angle phi = atan(d/h) to the horizon. The lune's outline projects onto a half circle and a half
// ellipse of half-axis sin phi: pi/2 (1 - sin phi) is lost.
double radiance_beside_half_plane(double h, double d) {
    return 0.5 * (1.0 + d / std::hypot(d, h));
}

// Where the shadow's edge runs along the texels, each may err by half of a texel of 2 / R along a
// line of length at most pi on the unit sphere: 0.5 (2 / 256) pi / pi.
constexpr double HalfTexel = 1.0 / 256.0;

TEST(Precompute, InfiniteHalfPlaneOverAReceiver) {
    const Receivers receivers = row_of_receivers(40, -3.0f, 3.0f);
    const Transfer transfer = precompute(receivers, scenes::half_plane_blocker(1.0, 0.2),
                                         {.tolerance = 0.003f, .face_resolution = 256});
    const std::vector<double> radiance = radiance_under_white(transfer);
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const double d = 0.2 - static_cast<double>(receivers.positions[i].x);
        EXPECT_NEAR(radiance[i], radiance_beside_half_plane(1.0, d), HalfTexel) << "edge at " << d;
    }
    // One receiver is a scene, too.
    const Transfer of_one =
        precompute(row_of_receivers(2, -3.0f, -0.5f), scenes::half_plane_blocker(1.0, 0.2),
                   {.tolerance = 0.003f, .face_resolution = 256});
    EXPECT_NEAR(radiance_under_white(of_one)[1], radiance_beside_half_plane(1.0, 0.7), HalfTexel);
}

TEST(Precompute, MeshOfAHalfPlaneOverAReceiver) {
    // So long that what is beyond its ends, 1e-4 above the horizon, weighs 1e-8 of the sky.
    mesh::TriangleMesh plane;
    const float far = 1e4f;
    for (const float x : {0.2f, 1.0f, 30.0f, far})
        for (const float z : {-far, -20.0f, 0.3f, 20.0f, far})
            plane.positions.emplace_back(x, 1.0f, z);
    for (std::uint32_t x = 0; x < 3; ++x)
        for (std::uint32_t z = 0; z < 4; ++z) {
            const std::uint32_t i = 5 * x + z;
            plane.triangles.push_back({i, i + 5, i + 6});
            plane.triangles.push_back({i, i + 6, i + 1});
        }
    const Receivers receivers = row_of_receivers(40, -3.0f, 3.0f);
    const Transfer transfer =
        precompute(receivers, RayScene(plane), {.tolerance = 0.003f, .face_resolution = 256});
    const std::vector<double> radiance = radiance_under_white(transfer);
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const double d = 0.2 - static_cast<double>(receivers.positions[i].x);
        EXPECT_NEAR(radiance[i], radiance_beside_half_plane(1.0, d), HalfTexel + 2e-4);
    }
}

// A sphere of angular radius a, its centre at the angle t from the normal and all of it above the
// horizon, hides pi sin^2(a) cos(t) of a constant sky's irradiance pi.
double radiance_below_sphere(const glm::dvec3& position, const glm::dvec3& centre, double radius) {
    const glm::dvec3 to_centre = centre - position;
    const double distance = glm::length(to_centre);
    return 1.0 - radius * radius / (distance * distance) * to_centre.y / distance;
}

TEST(Precompute, SphereOverAFloor) {
    const mesh::TriangleMesh floor = scenes::floor_grid(9, 6.0f);
    const glm::dvec3 centre(0.1, 1.5, -0.2);
    const Receivers receivers = vertex_receivers(floor);
    const PrecomputeOptions options{.tolerance = 0.005f, .face_resolution = 256};
    const std::vector<double> analytic =
        radiance_under_white(precompute(receivers, scenes::sphere_blocker(centre, 1.0), options));
    // 10,242 vertices with edges of 0.018: the polyhedron's sagitta is at most 0.018^2 / 6 = 5e-5
    // of the radius.
    const RayScene sphere(scenes::icosphere(5, 1.0f, centre));
    const std::vector<double> traced = radiance_under_white(precompute(receivers, sphere, options));
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const double expected = radiance_below_sphere(receivers.positions[i], centre, 1.0);
        // The outline's clusters err by chance, not alike: well below the tolerance of T times the
        // outline's solid angle.
        EXPECT_NEAR(analytic[i], expected, 0.004) << "receiver " << i;
        EXPECT_NEAR(traced[i], expected, 0.004) << "receiver " << i;
    }
}

TEST(Precompute, SphereOnAMeshFloorBlocksWithTheFloorItselfThere) {
    // The same with the floor and its automatic bias among the blockers: nothing of the floor may
    // be in its own way.
    const glm::dvec3 centre(0.0, 1.3, 0.0);
    const mesh::TriangleMesh mesh =
        scenes::joined(scenes::floor_grid(9, 4.0f), scenes::icosphere(4, 1.0f, centre));
    const Receivers all = vertex_receivers(mesh);
    Receivers receivers;
    receivers.positions.assign(all.positions.begin(), all.positions.begin() + 81);
    receivers.normals.assign(all.normals.begin(), all.normals.begin() + 81);
    const Transfer transfer =
        precompute(receivers, RayScene(mesh),
                   {.tolerance = 0.005f, .face_resolution = 256, .bias = automatic_bias(mesh)});
    const std::vector<double> radiance = radiance_under_white(transfer);
    for (std::size_t i = 0; i < receivers.size(); ++i)
        // Sagitta 0.037^2 / 6 = 2.3e-4, twice that in area, and the bias of 6e-4 towards the
        // sphere.
        EXPECT_NEAR(radiance[i], radiance_below_sphere(receivers.positions[i], centre, 1.0), 0.006);
}

TEST(Precompute, ToleranceZeroHoldsTheVisibilityOfEveryTexelCentre) {
    const SmallScene scene;
    for (const std::uint32_t r : {1u, 8u, 16u}) {
        const Transfer transfer =
            precompute(scene.receivers, scene.rays,
                       {.tolerance = 0.0f, .face_resolution = r, .bias = scene.options.bias});
        ASSERT_EQ(transfer.num_clusters(), 6u * r * r);
        for (std::size_t leaf = 0; leaf < transfer.num_clusters(); ++leaf) {
            const Cell& cell = transfer.quadtree.leaves()[leaf];
            ASSERT_EQ(cell.size(), 1.0 / r);
            const glm::vec3 w = cubemap::texel_direction(cell.face, cell.x, cell.y, r);
            for (std::size_t place = 0; place < transfer.num_receivers(); ++place) {
                const std::uint32_t receiver = transfer.order[place];
                const glm::vec3& n = scene.receivers.normals[receiver];
                const float cosine = n.x * w.x + n.y * w.y + n.z * w.z;
                if (std::abs(cosine) < 1e-6f)
                    continue; // rounding decides whether it is above
                const glm::vec3 origin =
                    ray_origin(scene.receivers.positions[receiver], n, scene.options.bias);
                if (cosine > 0.0f) {
                    ASSERT_EQ(transfer.counts.count(place, leaf),
                              scene.rays.occluded(origin, w) ? 0 : 16);
                }
            }
        }
    }
}

TEST(Precompute, ResolutionsBetweenPowersOfTwoGoDownToTheNextOne) {
    const Receivers receivers = row_of_receivers(3, -1.0f, 1.0f);
    const auto clusters = [&](std::uint32_t r) {
        return precompute(receivers, scenes::no_blockers(),
                          {.tolerance = 0.0f, .face_resolution = r})
            .num_clusters();
    };
    EXPECT_EQ(clusters(2), 24u);
    EXPECT_EQ(clusters(3), 96u);
    EXPECT_EQ(clusters(4), 96u);
    EXPECT_EQ(clusters(5), 384u);
}

TEST(Precompute, CountsAreTheVisiblePartOfWhatIsAboveTheHorizon) {
    const SmallScene scene;
    const Transfer transfer = scene.transfer();
    for (std::size_t leaf = 0; leaf < transfer.num_clusters(); leaf += 7) {
        const Cell& cell = transfer.quadtree.leaves()[leaf];
        const auto points = lattice_points(cell);
        for (std::size_t place = 0; place < transfer.num_receivers(); ++place) {
            const std::uint32_t receiver = transfer.order[place];
            const glm::vec3& n = scene.receivers.normals[receiver];
            const glm::vec3 origin =
                ray_origin(scene.receivers.positions[receiver], n, scene.options.bias);
            int count = 0, above = 0;
            bool doubtful = false;
            for (std::size_t l = 0; l < SamplesPerCell; ++l) {
                const glm::vec3 w = direction(points[l]);
                const float cosine = glm::dot(n, w);
                doubtful = doubtful || std::abs(cosine) < 1e-6f;
                const int weight = cell.level < 6      ? SampleWeights[l]
                                   : l == CentreSample ? FullCount
                                                       : 0;
                above += cosine > 0.0f ? weight : 0;
                count += cosine > 0.0f && !scene.rays.occluded(origin, w) ? weight : 0;
            }
            if (!doubtful && above != 0) {
                ASSERT_EQ(transfer.counts.count(place, leaf), std::lround(16.0 * count / above));
            }
        }
    }
}

TEST(Precompute, TracesEveryDirectionOnceForEveryReceiver) {
    const SmallScene scene;
    Receivers receivers;
    for (std::size_t i = 0; i < scene.receivers.size(); i += 9) {
        receivers.positions.push_back(scene.receivers.positions[i]);
        receivers.normals.push_back(scene.receivers.normals[i]);
    }
    const scenes::CountingBlockers counting(scene.rays);
    PrecomputeStatistics statistics;
    const Transfer transfer = precompute(receivers, counting, scene.options, {}, &statistics);
    std::size_t num_repeated = 0;
    for (const auto& [ray, count] : counting.rays())
        num_repeated += count == 1 ? 0 : 1;
    EXPECT_EQ(num_repeated, 0u);
    EXPECT_EQ(statistics.num_rays, counting.rays().size());
    EXPECT_EQ(statistics.num_samples, statistics.num_directions * receivers.size());
    EXPECT_EQ(statistics.num_clusters, transfer.num_clusters());
    EXPECT_GT(transfer.num_clusters(), 500u) << "the scene should split well below the first cells";
    std::uint32_t deepest = 0;
    for (const Cell& cell : transfer.quadtree.leaves())
        deepest = std::max<std::uint32_t>(deepest, cell.level);
    EXPECT_EQ(statistics.deepest_level, deepest);
}

TEST(Precompute, ATighterToleranceOnlyRefinesTheTree) {
    SmallScene scene;
    std::optional<Transfer> loose;
    for (const float tolerance : {0.1f, 0.05f, 0.03f, 0.0135f, 0.005f, 0.0f}) {
        scene.options.tolerance = tolerance;
        Transfer tight = scene.transfer();
        if (loose) {
            EXPECT_GE(tight.num_clusters(), loose->num_clusters());
            for (const Cell& cell : tight.quadtree.leaves()) {
                const double size = cell.size();
                std::vector<std::uint32_t> around;
                loose->quadtree.find_leaves({cell.face, cell.x * size, cell.y * size,
                                             (cell.x + 1) * size, (cell.y + 1) * size},
                                            around);
                ASSERT_EQ(around.size(), 1u);
                ASSERT_LE(loose->quadtree.leaves()[around[0]].level, cell.level);
            }
        }
        loose = std::move(tight);
    }
    EXPECT_EQ(loose->num_clusters(), 6u * 64 * 64);
}

TEST(Precompute, EpsilonIsToleranceOverTheRootOfTheNumberOfReceivers) {
    SmallScene scene;
    const Transfer by_tolerance = scene.transfer();
    const double n = static_cast<double>(scene.receivers.size());
    scene.options.epsilon =
        static_cast<float>(static_cast<double>(scene.options.tolerance) / std::sqrt(n));
    scene.options.tolerance = 0.5f; // overridden
    expect_same(scene.transfer(), by_tolerance);
}

TEST(Precompute, ToleranceGrowsUntilThereAreFewClusters) {
    SmallScene scene;
    const Transfer all = scene.transfer();
    const auto few = static_cast<std::uint32_t>(all.num_clusters() / 3);
    PrecomputeStatistics statistics;
    const auto limited = [&](std::uint32_t most) {
        scene.options.most_clusters = most;
        Transfer transfer = precompute(scene.receivers, scene.rays, scene.options, {}, &statistics);
        scene.options.most_clusters.reset();
        return transfer;
    };
    expect_same(limited(static_cast<std::uint32_t>(all.num_clusters())), all);
    EXPECT_EQ(statistics.grown_tolerance, 0.0f);

    const Transfer transfer = limited(few);
    EXPECT_LE(transfer.num_clusters(), few);
    EXPECT_GT(statistics.grown_tolerance, scene.options.tolerance);
    scene.options.tolerance = statistics.grown_tolerance / 1.25f;
    EXPECT_GT(scene.transfer().num_clusters(), few) << "no smaller tolerance makes so few";
    scene.options.tolerance = statistics.grown_tolerance;
    expect_same(scene.transfer(), transfer);

    EXPECT_EQ(limited(1).num_clusters(), 6u << (2 * scene.options.min_level));
}

// Half of the receivers choose for all of them.
TEST(Precompute, ASampleChoosesFewClusters) {
    const mesh::TriangleMesh mesh = scenes::joined(scenes::floor_grid(190, 4.0f),
                                                   scenes::icosphere(3, 0.5f, {0.2f, 0.7f, 0.0f}));
    const Receivers receivers = vertex_receivers(mesh);
    const RayScene rays(mesh);
    PrecomputeOptions options{
        .tolerance = 0.06f, .face_resolution = 64, .bias = automatic_bias(mesh)};
    const std::vector<double> expected = radiance_under_white(precompute(receivers, rays, options));
    options.most_clusters = 4096;
    const std::vector<double> radiance = radiance_under_white(precompute(receivers, rays, options));
    double error = 0.0, power = 0.0;
    for (std::size_t i = 0; i < radiance.size(); ++i) {
        error += (radiance[i] - expected[i]) * (radiance[i] - expected[i]);
        power += expected[i] * expected[i];
    }
    EXPECT_LT(std::sqrt(error / power), 0.005);
}

TEST(Precompute, MinLevelIsHonoured) {
    SmallScene scene;
    scene.options.tolerance = 10.0f; // anything is similar
    for (const std::uint32_t min_level : {0u, 1u, 4u}) {
        scene.options.min_level = min_level;
        EXPECT_EQ(scene.transfer().num_clusters(), 6u << (2 * min_level));
    }
    scene.options.min_level = MaxLevel; // single texels stop it before
    scene.options.face_resolution = 8;
    EXPECT_EQ(scene.transfer().num_clusters(), 6u * 8 * 8);
    scene = SmallScene();
    const Transfer transfer = scene.transfer();
    for (const Cell& cell : transfer.quadtree.leaves())
        EXPECT_GE(cell.level, 3);
}

TEST(Precompute, AnyNumberOfThreadsGivesTheSameBits) {
    const SmallScene scene;
    std::optional<Transfer> first;
    for (const std::size_t num_threads : {1u, 2u, 3u}) {
        const files::ThreadLimit threads(num_threads);
        const Transfer transfer = scene.transfer();
        if (first)
            expect_same(transfer, *first);
        else
            first = transfer;
    }
}

TEST(Precompute, OrderIsSpatialAndNormalsFollowIt) {
    const SmallScene scene;
    const Transfer transfer = scene.transfer();
    EXPECT_EQ(transfer.order, spatial_order(scene.receivers));
    for (std::size_t place = 0; place < transfer.num_receivers(); ++place)
        EXPECT_EQ(transfer.normals[place], scene.receivers.normals[transfer.order[place]]);
    EXPECT_EQ(transfer.counts.num_receivers, transfer.num_receivers());
    EXPECT_EQ(transfer.counts.num_leaves, transfer.num_clusters());
}

TEST(Precompute, ReceiversWithoutANormalReceiveNothing) {
    Receivers receivers = random_receivers(100, 2);
    for (std::size_t i = 0; i < receivers.size(); i += 3)
        receivers.normals[i] = glm::vec3(0.0f);
    const Transfer transfer = precompute(receivers, scenes::no_blockers(), {.face_resolution = 32});
    const std::vector<double> radiance = radiance_under_white(transfer);
    for (std::size_t i = 0; i < radiance.size(); ++i) {
        if (i % 3 == 0)
            EXPECT_EQ(radiance[i], 0.0);
        else
            EXPECT_GT(radiance[i], 0.9);
    }

    for (glm::vec3& normal : receivers.normals)
        normal = glm::vec3(0.0f);
    EXPECT_EQ(precompute(receivers, scenes::no_blockers()).num_clusters(), 6u * 64)
        << "all alike: no need to split";
}

TEST(Precompute, BiasLiftsTheRaysOffTheSurface) {
    // A floor 1e-3 above the receivers is in the way of a smaller bias and not of a larger one.
    const Receivers receivers = row_of_receivers(4, -0.1f, 0.1f);
    const RayScene cover(scenes::floor_grid(2, 100.0f, 1e-3f));
    const auto radiance = [&](float bias) {
        return radiance_under_white(
            precompute(receivers, cover, {.face_resolution = 32, .bias = bias}))[0];
    };
    EXPECT_NEAR(radiance(5e-4f), 0.0, 1e-6);
    EXPECT_NEAR(radiance(2e-3f), 1.0, 1e-6);
}

TEST(Precompute, StopsBeforeItBegins) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(static_cast<void>(SmallScene().transfer({.stop = stop.get_token()})), Cancelled);
}

TEST(Precompute, StopsSoon) {
    // Packets asked for after the stop. At a million packets a second and more, "a few times a
    // second" is 300,000 of them on each thread; however few the receivers are and however many the
    // directions.
    for (const std::size_t num_receivers : {40u, 600u}) {
        std::stop_source stop;
        std::atomic<std::size_t> num_packets = 0;
        class Watched final : public Blockers {
        public:
            Watched(std::stop_source& source, std::atomic<std::size_t>& packets)
                : source_(source), packets_(packets) {}
            std::uint32_t occluded(const glm::vec3&, const DirectionPacket&,
                                   std::uint32_t) const override {
                if (++packets_ == 1000)
                    source_.request_stop();
                return 0;
            }

        private:
            std::stop_source& source_;
            std::atomic<std::size_t>& packets_;
        };
        EXPECT_THROW(static_cast<void>(
                         precompute(random_receivers(num_receivers, 3), Watched(stop, num_packets),
                                    {.tolerance = 0.0f, .min_level = 8, .face_resolution = 256},
                                    {.stop = stop.get_token()})),
                     Cancelled);
        EXPECT_LT(num_packets, 400000u) << num_receivers << " receivers";
    }
}

TEST(Precompute, ProgressNeverFallsAndEndsByOne) {
    std::vector<double> fractions;
    static_cast<void>(SmallScene().transfer({.on_progress = [&](double fraction) {
        fractions.push_back(fraction);
    }}));
    ASSERT_GE(fractions.size(), 3u);
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_GE(fractions.front(), 0.0);
    EXPECT_LE(fractions.back(), 1.0);
    EXPECT_GT(fractions.back(), 0.5);
}

TEST(Precompute, WhatTheProgressCallThrowsComesOut) {
    const Work work{.on_progress = [](double) {
        throw std::runtime_error("enough");
    }};
    EXPECT_THROW(static_cast<void>(SmallScene().transfer(work)), std::runtime_error);
}

TEST(Precompute, RefusesOptionsOutOfRangeInOneLine) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const Receivers receivers = row_of_receivers(3, -1.0f, 1.0f);
    const auto refused = [&](const Receivers& r, const PrecomputeOptions& options,
                             const char* expected) {
        try {
            static_cast<void>(precompute(r, scenes::no_blockers(), options));
            ADD_FAILURE() << "accepted: " << expected;
        } catch (const std::invalid_argument& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr(expected));
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    };
    refused({}, {}, "at least one receiver");
    refused(receivers, {.tolerance = -0.1f}, "tolerance >= 0, got -0.1");
    refused(receivers, {.tolerance = nan}, "tolerance");
    refused(receivers, {.tolerance = infinity}, "tolerance");
    refused(receivers, {.epsilon = -1.0f}, "epsilon >= 0, got -1");
    refused(receivers, {.epsilon = nan}, "epsilon");
    refused(receivers, {.min_level = 15}, "minimum depth from 0 to 14, got 15");
    refused(receivers, {.face_resolution = 0}, "face resolution from 1 to 16384, got 0");
    refused(receivers, {.face_resolution = 16385}, "face resolution from 1 to 16384, got 16385");
    refused(receivers, {.bias = -1e-3f}, "bias >= 0");
    refused(receivers, {.bias = nan}, "bias");
    Receivers without_normals = receivers;
    without_normals.normals.pop_back();
    refused(without_normals, {}, "normal");
}

} // namespace
} // namespace relumine::prt
