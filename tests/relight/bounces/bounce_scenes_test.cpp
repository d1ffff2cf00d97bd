// Bounces in scenes with closed forms: the matrix, the path tracer, and each held to the other.
#include <cmath>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "prt/bounces/bounce_precompute.h"
#include "prt/precompute.h"
#include "relight/bounces/bounce_light.h"
#include "relight/probe_lights.h"
#include "relight/reference/exact.h"
#include "relight/reference/path_tracer.h"
#include "relight/relighter.h"
#include "tests/prt/memory_checkpoint.h"
#include "tests/prt/scenes.h"
#include "tests/relight/bounces/bouncing_scene.h"

namespace relumine::relight {
namespace {

/// n x n vertices of a unit square that starts at `corner` and faces cross(along, up).
mesh::TriangleMesh square(std::uint32_t n, const glm::vec3& corner, const glm::vec3& along,
                          const glm::vec3& up) {
    mesh::TriangleMesh result;
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const auto part = [n](std::uint32_t k) {
                return static_cast<float>(k) / static_cast<float>(n - 1);
            };
            result.positions.push_back(corner + part(i) * along + part(j) * up);
            result.normals.push_back(glm::cross(along, up));
        }
    for (std::uint32_t j = 0; j + 1 < n; ++j)
        for (std::uint32_t i = 0; i + 1 < n; ++i) {
            const std::uint32_t at = j * n + i;
            result.triangles.push_back({at, at + 1, at + n + 1});
            result.triangles.push_back({at, at + n + 1, at + n});
        }
    return result;
}

/// Mean over a square's area of values at its n x n vertices from `first` on: trapezoidal rule.
double area_mean(const std::vector<float>& values, std::size_t first, std::uint32_t n) {
    double sum = 0.0;
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const double weight = (i % (n - 1) == 0 ? 0.5 : 1.0) * (j % (n - 1) == 0 ? 0.5 : 1.0);
            sum += weight * static_cast<double>(values[first + j * n + i]);
        }
    return sum / ((n - 1.0) * (n - 1.0));
}

/// 1 for the vertices from `first` on, 0 before.
std::vector<float> radiant_from(std::size_t first, std::size_t size) {
    std::vector<float> result(size, 0.0f);
    std::fill(result.begin() + static_cast<std::ptrdiff_t>(first), result.end(), 1.0f);
    return result;
}

constexpr std::uint32_t GridSize = 25;

// Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", C-11.
TEST(BounceScenes, ViewFactorOfTwoParallelSquares) {
    const BouncingScene scene(scenes::joined(square(GridSize, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}),
                                             square(GridSize, {0, 1, 0}, {1, 0, 0}, {0, 0, 1})));
    constexpr std::size_t Second = GridSize * GridSize;
    const auto light = scene.bounce(radiant_from(Second, 2 * Second));
    const double x = 1.0, x1 = std::sqrt(1.0 + x * x);
    const double factor = 2.0 / (std::numbers::pi * x * x) *
                          (std::log(x1 * x1 / std::sqrt(1.0 + 2.0 * x * x)) +
                           2.0 * x * x1 * std::atan(x / x1) - 2.0 * x * std::atan(x));
    EXPECT_NEAR(factor, 0.1998, 1e-4);
    EXPECT_NEAR(area_mean(light, 0, GridSize), factor, 0.01 * factor);
    EXPECT_NEAR(area_mean(light, Second, GridSize), 0.0, 1e-6);
}

// Howell, C-14: two unit squares at a right angle with a common edge.
TEST(BounceScenes, ViewFactorOfACorner) {
    const BouncingScene scene(scenes::joined(square(GridSize, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}),
                                             square(GridSize, {0, 0, 0}, {0, 1, 0}, {0, 0, 1})));
    constexpr std::size_t Second = GridSize * GridSize;
    const auto light = scene.bounce(radiant_from(Second, 2 * Second));
    constexpr double Factor = 0.20004;
    EXPECT_NEAR(area_mean(light, 0, GridSize), Factor, 0.01 * Factor);
}

/// Six squares that face inwards.
mesh::TriangleMesh closed_room() {
    mesh::TriangleMesh room;
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    for (const mesh::TriangleMesh& wall :
         {square(9, {0, 0, 0}, z, x), square(9, {0, 1, 0}, x, z), square(9, {0, 0, 0}, y, z),
          square(9, {1, 0, 0}, z, y), square(9, {0, 0, 0}, x, y), square(9, {0, 0, 1}, y, x)})
        room = scenes::joined(room, wall);
    return room;
}

TEST(BounceScenes, AClosedRoomKeepsAllOfItsLight) {
    const BouncingScene scene(closed_room());
    EXPECT_NEAR(scene.statistics.mean_closure, 1.0, 1e-6);
    EXPECT_NEAR(scene.matrix.spectral_radius, 1.0f, 1e-4f);
    BounceLight light(scene.matrix, scene.transfer);
    const std::size_t n = scene.receivers.size();
    light.set_albedo(std::vector(n, glm::vec3(0.5f)));
    light.solve(std::vector(n, glm::vec3(2.0f)));
    for (const glm::vec3& indirect : light.indirect())
        EXPECT_NEAR(0.5f * (2.0f + indirect.g), 2.0f, 1e-3f);
    EXPECT_THROW(light.set_albedo(std::vector(n, glm::vec3(1.01f))), std::invalid_argument);
    // Of white walls nearly all light stays: 0.1 % is lost at each bounce.
    light.set_albedo(std::vector(n, glm::vec3(1.0f)));
    light.solve(std::vector(n, glm::vec3(2.0f)));
    for (const glm::vec3& indirect : light.indirect())
        EXPECT_NEAR(indirect.g, 2.0f * 999.0f, 20.0f);
}

/// The part of a sphere below its centre, seen from inside.
mesh::TriangleMesh bowl(std::uint32_t level) {
    mesh::TriangleMesh sphere = scenes::icosphere(level, 1.0f, glm::vec3(0.0f));
    mesh::TriangleMesh result;
    std::vector<std::uint32_t> index(sphere.num_vertices(), ~0u);
    for (const mesh::Triangle& triangle : sphere.triangles) {
        if (std::any_of(triangle.begin(), triangle.end(),
                        [&](auto v) { return sphere.positions[v].y > 1e-6f; }))
            continue;
        mesh::Triangle turned{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = triangle[2 - k];
            if (index[vertex] == ~0u) {
                index[vertex] = static_cast<std::uint32_t>(result.num_vertices());
                result.positions.push_back(sphere.positions[vertex]);
                result.normals.push_back(-sphere.normals[vertex]);
            }
            turned[k] = index[vertex];
        }
        result.triangles.push_back(turned);
    }
    return result;
}

double area_of(const mesh::TriangleMesh& mesh) {
    double area = 0.0;
    for (const mesh::Triangle& t : mesh.triangles)
        area += 0.5 * static_cast<double>(
                          glm::length(glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                                 mesh.positions[t[2]] - mesh.positions[t[0]])));
    return area;
}

// Any two points of a sphere see each other with the same form factor, so a bowl under a white sky
// is evenly bright: with f, its part of the sphere, rho (1 - f) / (1 - rho f).
TEST(BounceScenes, ABowlUnderAWhiteSkyIsEvenlyBright) {
    const BouncingScene scene(bowl(4));
    const double f = area_of(scene.mesh) / (4.0 * std::numbers::pi);
    constexpr float Albedo = 0.7f;
    const double expected = (1.0 - f) / (1.0 - static_cast<double>(Albedo) * f);
    const std::size_t n = scene.receivers.size();

    const cubemap::CubeMap white(8, glm::vec3(1.0f));
    Relighter relighter(scene.transfer);
    relighter.set_environment(white);
    BounceLight light(scene.matrix, scene.transfer);
    light.set_albedo(std::vector(n, glm::vec3(Albedo)));
    light.solve(relighter.diffuse_radiance());
    double mean = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const double all = static_cast<double>(relighter.diffuse_radiance()[i].g) +
                           static_cast<double>(light.indirect()[i].g);
        mean += all / static_cast<double>(n);
        squares += (all / expected - 1.0) * (all / expected - 1.0) / static_cast<double>(n);
    }
    EXPECT_NEAR(mean, expected, 0.005 * expected);
    EXPECT_LT(std::sqrt(squares), 0.02);

    std::vector<std::uint32_t> some(64);
    std::iota(some.begin(), some.end(), 100u);
    const auto traced =
        trace_bounces(scene.mesh, std::vector(n, glm::vec3(Albedo)), scene.receivers, some,
                      scene.rays, white, {.num_paths = 2000, .bias = scene.bias});
    const auto exact =
        exact_radiance(scene.receivers, some, scene.rays, white, {.bias = scene.bias});
    double traced_mean = 0.0;
    for (std::size_t i = 0; i < some.size(); ++i)
        traced_mean += (exact[i].g + traced[i].radiance.g) / static_cast<double>(some.size());
    EXPECT_NEAR(traced_mean, expected, 0.01 * expected);
}

// The sum over every path is 1 wherever nothing absorbs: a white furnace.
TEST(BounceScenes, PathsInAWhiteFurnaceMissNoLight) {
    const mesh::TriangleMesh mesh = bowl(3);
    const prt::Receivers receivers = prt::vertex_receivers(mesh);
    const prt::RayScene rays(mesh);
    const float bias = prt::automatic_bias(mesh);
    const cubemap::CubeMap white(16, glm::vec3(1.0f));
    std::vector<std::uint32_t> all(receivers.size());
    std::iota(all.begin(), all.end(), 0u);
    const auto exact = exact_radiance(receivers, all, rays, white, {.bias = bias});
    const auto traced =
        trace_bounces(mesh, std::vector(receivers.size(), glm::vec3(1.0f)), receivers, all, rays,
                      white, {.num_paths = 500, .bias = bias});
    double error = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        error += (exact[i].g + traced[i].radiance.g - 1.0) / static_cast<double>(all.size());
        variance += traced[i].standard_error.g * traced[i].standard_error.g;
    }
    const double standard_error = std::sqrt(variance) / static_cast<double>(all.size());
    EXPECT_LT(standard_error, 0.003);
    // The map's texels are points for exact integration.
    EXPECT_NEAR(error, 0.0, 4.0 * standard_error + 0.003);
}

TEST(BounceScenes, NoLightLeaksUnderABoxOnTheFloor) {
    // The box stands on the floor, a hair inside.
    mesh::TriangleMesh box = scenes::box({-0.5f, -0.001f, -0.5f}, {0.5f, 1.0f, 0.5f});
    const BouncingScene scene(scenes::joined(scenes::floor_grid(33, 4.0f), box));
    Relighter relighter(scene.transfer, {.blockers = &scene.rays,
                                         .positions = scene.receivers.positions,
                                         .bias = scene.bias,
                                         .tolerance = 0.03f});
    relighter.set_environment(cubemap::CubeMap(16, glm::vec3(1.0f)));
    BounceLight light(scene.matrix, scene.transfer);
    light.set_albedo(std::vector(scene.receivers.size(), glm::vec3(0.9f)));
    light.solve(relighter.diffuse_radiance());
    std::size_t num_under = 0;
    for (std::size_t i = 0; i < scene.receivers.size(); ++i) {
        const glm::vec3& p = scene.receivers.positions[i];
        if (p.y == 0.0f && std::max(std::abs(p.x), std::abs(p.z)) < 0.49f) {
            ++num_under;
            EXPECT_EQ(light.indirect()[i], glm::vec3(0.0f));
            EXPECT_EQ(relighter.radiance()[i], glm::vec3(0.0f));
        }
    }
    EXPECT_GT(num_under, 20u);
    EXPECT_GT(*std::max_element(scene.matrix.weights.begin(), scene.matrix.weights.end()), 0.0f);
}

TEST(BounceScenes, BacksRadiateOnlyWhereAsked) {
    // The upper square faces away from the lower one.
    const mesh::TriangleMesh mesh = scenes::joined(square(9, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}),
                                                   square(9, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}));
    const BouncingScene scene(mesh);
    EXPECT_TRUE(scene.matrix.emitters.places.empty());
    const prt::BounceMatrix two_sided = prt::precompute_bounces(
        scene.mesh, scene.receivers, scene.transfer, probe_radiance(scene.transfer), scene.rays,
        {.two_sided = true, .bias = scene.bias});
    EXPECT_GT(two_sided.emitters.places.size(), 81u);

    // The upper square sends down what the sky gives its front: the white light of the lower one's
    // closed directions.
    BounceLight light(two_sided, scene.transfer);
    const std::size_t n = scene.receivers.size();
    light.set_albedo(std::vector(n, glm::vec3(1.0f)));
    Relighter relighter(scene.transfer);
    const cubemap::CubeMap white(16, glm::vec3(1.0f));
    relighter.set_environment(white);
    light.solve(relighter.diffuse_radiance());
    std::vector<std::uint32_t> all(n);
    std::iota(all.begin(), all.end(), 0u);
    for (const bool is_two_sided : {false, true}) {
        const auto traced = trace_bounces(
            scene.mesh, std::vector(n, glm::vec3(1.0f)), scene.receivers, all, scene.rays, white,
            {.num_paths = 400, .two_sided = is_two_sided, .bias = scene.bias});
        for (std::size_t i = 0; i < n; ++i)
            ASSERT_NEAR(traced[i].radiance.g,
                        is_two_sided ? static_cast<double>(light.indirect()[i].g) : 0.0,
                        0.03 + 4.0 * traced[i].standard_error.g);
    }
    EXPECT_GT(light.indirect()[40].g, 0.1f);
}

TEST(BounceScenes, AKilledRunThatIsTakenUpFindsTheSameRows) {
    // More blocks than are done between two looks at the checkpoint.
    const mesh::TriangleMesh mesh = scenes::joined(scenes::floor_grid(100, 4.0f),
                                                   scenes::icosphere(3, 0.5f, {0.0f, 0.6f, 0.0f}));
    const BouncingScene scene(mesh, 0.02f, 0.1f);
    const auto probes = probe_radiance(scene.transfer);
    prt::BounceStatistics found;
    const auto rows = [&](prt::Checkpoint& checkpoint) {
        return prt::precompute_bounces(scene.mesh, scene.receivers, scene.transfer, probes,
                                       scene.rays, {.tolerance = 0.02f, .bias = scene.bias},
                                       {.checkpoint = &checkpoint}, &found);
    };
    std::size_t num_saves = 0;
    for (;; ++num_saves) {
        prt::MemoryCheckpoint checkpoint;
        checkpoint.saves_to_live = num_saves;
        bool is_killed = false;
        try {
            static_cast<void>(rows(checkpoint));
        } catch (const prt::Killed&) {
            is_killed = true;
        }
        checkpoint.saves_to_live = static_cast<std::size_t>(-1);
        EXPECT_EQ(rows(checkpoint), scene.matrix) << "killed at save " << num_saves;
        EXPECT_EQ(found.num_rays, scene.statistics.num_rays);
        EXPECT_EQ(found.rms_error, scene.statistics.rms_error);
        if (!is_killed)
            break;
    }
    EXPECT_EQ(num_saves, 6u);

    // A run that is stopped leaves what it has, and one whose saves fail goes on.
    prt::MemoryCheckpoint checkpoint;
    checkpoint.every = 2;
    std::stop_source stop;
    const prt::Work work{
        .checkpoint = &checkpoint, .stop = stop.get_token(), .on_progress = [&](double done) {
            if (done > 0.8)
                stop.request_stop();
        }};
    EXPECT_THROW(static_cast<void>(prt::precompute_bounces(
                     scene.mesh, scene.receivers, scene.transfer, probes, scene.rays,
                     {.tolerance = 0.02f, .bias = scene.bias}, work)),
                 prt::Cancelled);
    EXPECT_GT(checkpoint.parts.at("more_bounces").records.size(), 0u);
    EXPECT_EQ(rows(checkpoint), scene.matrix);
    prt::MemoryCheckpoint failing;
    failing.is_failing = true;
    EXPECT_EQ(rows(failing), scene.matrix);
}

TEST(BounceScenes, RowsThatTakeTooMuchMemoryAreRefused) {
    const BouncingScene scene(scenes::sphere_and_box_on_floor());
    const auto probes = probe_radiance(scene.transfer);
    const auto within = [&](std::uint64_t max_bytes) {
        return prt::precompute_bounces(scene.mesh, scene.receivers, scene.transfer, probes,
                                       scene.rays, {.bias = scene.bias, .max_bytes = max_bytes});
    };
    EXPECT_EQ(within(2 * prt::BytesPerHit * scene.statistics.num_hits), scene.matrix);
    EXPECT_THROW(static_cast<void>(within(prt::BytesPerHit * scene.statistics.num_hits / 2)),
                 prt::TooLarge);
}

TEST(BounceScenes, RowsAreTheSameOnAnyNumberOfThreads) {
    const BouncingScene scene(scenes::sphere_and_box_on_floor());
    std::vector<prt::BounceMatrix> matrices;
    for (const std::size_t num_threads : {1u, 2u, 7u}) {
        const files::ThreadLimit limit(num_threads);
        matrices.push_back(prt::precompute_bounces(scene.mesh, scene.receivers, scene.transfer,
                                                   probe_radiance(scene.transfer), scene.rays,
                                                   {.bias = scene.bias}));
    }
    EXPECT_GT(matrices[0].emitters.places.size(), 100u);
    EXPECT_EQ(matrices[0], matrices[1]);
    EXPECT_EQ(matrices[0], matrices[2]);
    prt::require_bounces(matrices[0], matrices[0].num_rows());
}

TEST(BounceScenes, ASmallerToleranceTakesMoreRaysAndErrsLess) {
    const BouncingScene coarse(bowl(3), 0.1f);
    prt::BounceStatistics fine;
    static_cast<void>(prt::precompute_bounces(
        coarse.mesh, coarse.receivers, coarse.transfer, probe_radiance(coarse.transfer),
        coarse.rays, {.tolerance = 0.004f, .bias = coarse.bias}, {}, &fine));
    EXPECT_LT(2 * coarse.statistics.num_rays, fine.num_rays);
    EXPECT_LT(2.0 * fine.rms_error, coarse.statistics.rms_error);
    EXPECT_LE(fine.rms_error, 0.0045);
}

TEST(BounceScenes, RefusesWhatDoesNotFit) {
    const BouncingScene scene(scenes::floor_grid(5, 1.0f));
    const auto probes = probe_radiance(scene.transfer);
    const auto refuses = [&](const prt::BounceOptions& options) {
        EXPECT_THROW(static_cast<void>(prt::precompute_bounces(
                         scene.mesh, scene.receivers, scene.transfer, probes, scene.rays, options)),
                     std::invalid_argument);
    };
    refuses({.tolerance = 0.0f});
    refuses({.tolerance = std::nanf("")});
    refuses({.min_directions = 1});
    refuses({.min_directions = 64, .max_directions = 32});
    prt::Receivers points = scene.receivers;
    points.points.resize(points.size());
    EXPECT_THROW(static_cast<void>(prt::precompute_bounces(scene.mesh, points, scene.transfer,
                                                           probes, scene.rays, {})),
                 std::invalid_argument);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(static_cast<void>(prt::precompute_bounces(scene.mesh, scene.receivers,
                                                           scene.transfer, probes, scene.rays, {},
                                                           {.stop = stop.get_token()})),
                 prt::Cancelled);
}

} // namespace
} // namespace relumine::relight
