#include "relight/harmonics/harmonic_light.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "relight/receiver_light.h"
#include "relight/reference/exact.h"
#include "relight/relighter.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/every_target.h"
#include "tests/relight/environments.h"
#include "tests/relight/harmonics/exact_harmonics.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

prt::Receivers points_at(const std::vector<glm::vec3>& positions) {
    prt::Receivers receivers;
    receivers.have_no_surface = true;
    receivers.positions = positions;
    receivers.normals.resize(positions.size(), glm::vec3(0.0f));
    return receivers;
}

/// Points around the sphere and the box of relit_scene(), and their transfer.
struct PointScene {
    prt::Receivers receivers;
    prt::Transfer transfer;
    const scenes::RelitScene& scene = scenes::relit_scene();

    explicit PointScene(std::size_t count = 150) {
        std::mt19937 random(7);
        std::uniform_real_distribution<float> place(-3.0f, 3.0f), height(0.2f, 3.0f);
        std::vector<glm::vec3> positions(count);
        for (glm::vec3& position : positions)
            position = {place(random), height(random), place(random)};
        receivers = points_at(positions);
        transfer = prt::precompute(receivers, scene.rays,
                                   {.tolerance = 0.0135f, .min_level = 4, .face_resolution = 64});
    }
    [[nodiscard]] ShadowRays shadow_rays() const {
        return {.blockers = &scene.rays, .positions = receivers.positions, .tolerance = 0.0135f};
    }
};

const PointScene& point_scene() {
    static const PointScene scene;
    return scene;
}

cubemap::CubeMap map_of(std::uint32_t resolution,
                        const std::function<double(const glm::dvec3&)>& radiance) {
    cubemap::CubeMap map(resolution);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < resolution; ++y)
            for (std::uint32_t x = 0; x < resolution; ++x)
                map.at(face, x, y) = glm::vec3(
                    static_cast<float>(radiance(cubemap::texel_direction(face, x, y, resolution))));
    return map;
}

double relative_l2(std::span<const glm::vec3> light, std::span<const glm::dvec3> exact) {
    double error = 0.0, all = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const glm::dvec3 difference = glm::dvec3(light[i]) - exact[i];
        error += glm::dot(difference, difference);
        all += glm::dot(exact[i], exact[i]);
    }
    return std::sqrt(error / all);
}

TEST(HarmonicLight, ConstantSkyAroundAnOpenPoint) {
    const prt::Receivers points = points_at({{0, 0, 0}, {3, 1, 2}});
    const prt::Transfer transfer = prt::precompute(points, scenes::no_blockers(), {.min_level = 2});
    Relighter relighter(transfer, {}, 3);
    // Texels count as their centres: so much narrower than they are at R = 256 that 3e-6 is left.
    relighter.set_environment(map_of(256, [](const glm::dvec3&) { return 1.0; }));
    EXPECT_NEAR(relighter.radiance()[1].g, 1.0f, 1e-5f);
    const std::vector<glm::vec3> light = relighter.harmonics();
    ASSERT_EQ(light.size(), 18u);
    for (const glm::vec3& normal : {glm::vec3(0, 1, 0), glm::vec3(0, 0, -1)})
        EXPECT_NEAR(irradiance(std::span(light).first(9), normal).r, std::numbers::pi, 1e-4);
    for (std::size_t k = 1; k < 9; ++k)
        EXPECT_NEAR(light[9 + k].r, 0.0f, 1e-4f) << HarmonicNames[k];
}

TEST(HarmonicLight, HalfASky) {
    // A horizon of a plane below all: the upper half of a white sky.
    const prt::Receivers points = points_at({{0, 0, 0}});
    const prt::Transfer transfer = prt::precompute(points, scenes::no_blockers(), {.min_level = 4});
    Relighter relighter(transfer, {}, 3);
    relighter.set_environment(
        map_of(128, [](const glm::dvec3& w) { return w.y > 0.0 ? 1.0 : 0.0; }));
    const std::vector<glm::vec3> light = relighter.harmonics();
    // Over the half sphere the integrals of 1, y and 3 y^2 - 1 are 2 pi, pi and 0.
    EXPECT_NEAR(light[0].r, 0.5 * std::sqrt(1.0 / std::numbers::pi) * 2.0 * std::numbers::pi, 1e-3);
    EXPECT_NEAR(light[1].r, std::sqrt(3.0 / (4.0 * std::numbers::pi)) * std::numbers::pi, 1e-3);
    for (std::size_t k = 2; k < 9; ++k)
        EXPECT_NEAR(light[k].r, 0.0, 2e-3) << HarmonicNames[k];
    EXPECT_NEAR(irradiance(light, {0, 1, 0}).r, std::numbers::pi, 2e-3);
    EXPECT_NEAR(irradiance(light, {1, 0, 0}).r, std::numbers::pi / 2, 2e-3);
    EXPECT_NEAR(irradiance(light, {0, -1, 0}).r, 0.0, 2e-3);
    EXPECT_NEAR(relighter.radiance()[0].r, 0.5f, 1e-3f);
}

TEST(HarmonicLight, OneDistantLightThatASphereMayBlock) {
    // The sphere around the origin hides what is above from the point below it.
    const prt::Receivers points = points_at({{0, -2, 0}, {0, 2, 0}});
    const scenes::AnalyticBlockers blockers = scenes::sphere_blocker({0, 0, 0}, 1.0);
    const prt::Transfer transfer = prt::precompute(points, blockers, {.min_level = 4});
    for (const bool is_traced : {false, true}) {
        const ShadowRays rays{.blockers = is_traced ? &blockers : nullptr,
                              .positions = points.positions};
        Relighter relighter(transfer, rays, 3);
        const lights::DistantLight light{.direction = glm::normalize(glm::dvec3(0.1, 1, 0.2)),
                                         .irradiance = {2.0, 1.0, 0.5}};
        relighter.set_lights(std::span(&light, 1));
        const std::vector<glm::vec3> values = relighter.harmonics();
        const auto expected = harmonics(light.direction);
        // Seen in part, it comes from where its group's light comes from, and there is no other. A
        // cluster's light is spread as a cell of 5.6 degrees: it loses 0.25 % of the second band.
        const double allowed = is_traced ? 1e-6 : 0.002;
        for (std::size_t k = 0; k < 9; ++k) {
            EXPECT_EQ(values[k], glm::vec3(0.0f)) << k;
            EXPECT_NEAR(values[9 + k].r, 2.0 * expected[k], 2.0 * allowed) << k;
            EXPECT_NEAR(values[9 + k].b, 0.5 * expected[k], 0.5 * allowed) << k;
        }
        EXPECT_NEAR(relighter.radiance()[1].g, 1.0 / (4.0 * std::numbers::pi), 1e-4);
    }
}

TEST(HarmonicLight, ASphereHidesItsSolidAngle) {
    // Seen from a distance of 2, a unit sphere hides a cap of 30 degrees around +Y.
    const prt::Receivers points = points_at({{0, -2, 0}});
    const prt::Transfer transfer = prt::precompute(points, scenes::sphere_blocker({0, 0, 0}, 1.0),
                                                   {.min_level = 4, .face_resolution = 256});
    Relighter relighter(transfer, {}, 3);
    relighter.set_environment(map_of(64, [](const glm::dvec3&) { return 1.0; }));
    const std::vector<glm::vec3> light = relighter.harmonics();
    const double c = std::cos(std::numbers::pi / 6);
    EXPECT_NEAR(relighter.radiance()[0].r, 1.0 - 0.5 * (1.0 - c), 1e-4);
    EXPECT_NEAR(light[1].r,
                -std::sqrt(3.0 / (4.0 * std::numbers::pi)) * std::numbers::pi * (1.0 - c * c),
                1e-3);
}

TEST(HarmonicLight, PointsAgreeWithExactIntegration) {
    const PointScene& points = point_scene();
    const cubemap::CubeMap environment = scenes::random_environment(64, 5, 1.0f);
    std::vector<std::uint32_t> all(points.receivers.size());
    for (std::uint32_t i = 0; i < all.size(); ++i)
        all[i] = i;
    const std::vector<glm::dvec3> exact =
        exact_harmonics(points.receivers, all, points.scene.rays, environment, 3, 0.0f);
    Relighter relighter(points.transfer, points.shadow_rays(), 3);
    relighter.set_environment(environment);
    EXPECT_LT(relative_l2(relighter.harmonics(), exact), 0.004);
    const ErrorReport error =
        compare(all, exact_radiance(points.receivers, all, points.scene.rays, environment),
                relighter.radiance());
    EXPECT_LT(error.relative_l2, 0.003);
}

TEST(HarmonicLight, SurfacesAreBoundToTheirRadiance) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    for (const std::uint32_t order : {2u, 3u}) {
        Relighter relighter(scene.transfer, scene.shadow_rays(), order);
        relighter.set_environment(scenes::random_environment(64, 3));
        const std::vector<glm::vec3> light = relighter.harmonics();
        const std::size_t count = num_harmonics(order);
        for (std::size_t i = 0; i < scene.receivers.size(); ++i) {
            const glm::dvec3 e =
                irradiance(std::span(light).subspan(i * count, count), scene.receivers.normals[i]);
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(e[channel] / std::numbers::pi, relighter.radiance()[i][channel],
                            1e-6 * std::max(1.0f, relighter.radiance()[i][channel]));
        }
    }
}

TEST(HarmonicLight, SurfacesKnowTheIrradianceOfOtherNormals) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    const cubemap::CubeMap environment = scenes::smooth_environment(64);
    Relighter relighter(scene.transfer, scene.shadow_rays(), 3);
    relighter.set_environment(environment);
    const std::vector<glm::vec3> light = relighter.harmonics();
    const std::vector<std::uint32_t> chosen = random_receivers(scene.transfer, 200, 3);
    std::vector<glm::vec3> normals;
    for (const std::uint32_t i : chosen) {
        const glm::vec3& n = scene.receivers.normals[i];
        const glm::vec3 side = glm::normalize(
            glm::cross(n, std::abs(n.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
        normals.push_back(std::cos(0.5f) * n + std::sin(0.5f) * side);
    }
    const std::vector<glm::dvec3> exact = exact_irradiance(
        scene.receivers, chosen, normals, scene.rays, environment, scene.options.bias);
    double error = 0.0, all = 0.0;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const glm::dvec3 e =
            irradiance(std::span(light).subspan(std::size_t{9} * chosen[i], 9), normals[i]);
        error += glm::dot(e - exact[i], e - exact[i]);
        all += glm::dot(exact[i], exact[i]);
    }
    EXPECT_LT(std::sqrt(error / all), 0.03);
}

/// Relights after edits and compares with light that is set anew.
void expect_edits_leave_no_trace(const prt::Transfer& transfer, const ShadowRays& rays) {
    Relighter edited(transfer, rays, 3), fresh(transfer, rays, 3);
    cubemap::CubeMap environment = scenes::random_environment(32, 9);
    edited.set_environment(environment);
    std::mt19937 random(3);
    for (int i = 0; i < 12; ++i) {
        const auto x = static_cast<std::uint32_t>(random() % 28),
                   y = static_cast<std::uint32_t>(random() % 28);
        const TexelRectangle rectangle{
            .face = cubemap::AllFaces[random() % 6], .x0 = x, .y0 = y, .x1 = x + 4, .y1 = y + 4};
        const std::vector<glm::vec3> texels(16, glm::vec3(i % 3 == 0 ? 1e5f : 0.1f));
        put_texels(rectangle, texels, environment);
        update_region(edited, rectangle, texels);
    }
    fresh.set_environment(environment);
    scenes::expect_close(edited.radiance(), fresh.radiance(), 2e-5);
    const std::vector<glm::vec3> light = edited.harmonics(), expected = fresh.harmonics();
    ASSERT_EQ(light.size(), expected.size());
    for (std::size_t i = 0; i < light.size(); ++i) {
        const float scale = expected[i / 9 * 9].r + 1.0f;
        EXPECT_NEAR(light[i].r, expected[i].r, 3e-5f * scale);
    }
    edited.resum();
    EXPECT_EQ(edited.harmonics(), expected);
}

TEST(HarmonicLight, EditsLeaveNoTraceOnAnyProcessor) {
    scenes::on_every_target(
        [] { expect_edits_leave_no_trace(point_scene().transfer, point_scene().shadow_rays()); });
}

TEST(HarmonicLight, EditsLeaveNoTrace) {
    expect_edits_leave_no_trace(point_scene().transfer, {});
    expect_edits_leave_no_trace(scenes::relit_scene().transfer,
                                scenes::relit_scene().shadow_rays());
}

TEST(HarmonicLight, FramesAreAsIfSet) {
    Relighter frames(point_scene().transfer, point_scene().shadow_rays(), 2),
        fresh(point_scene().transfer, point_scene().shadow_rays(), 2);
    EnvironmentBinner binner = binner_of(frames);
    cubemap::CubeMap environment = scenes::random_environment(32, 4);
    frames.set_frame(binner.bin(environment));
    environment.at(cubemap::Face::PositiveY, 3, 4) = glm::vec3(500.0f);
    environment.at(cubemap::Face::PositiveX, 9, 9) = glm::vec3(0.0f);
    frames.set_frame(binner.bin(environment));
    fresh.set_environment(environment);
    scenes::expect_close(frames.radiance(), fresh.radiance(), 1e-5);
}

TEST(HarmonicLight, IsTheSameForAnyNumberOfThreads) {
    const auto light_with = [](std::size_t threads) {
        const files::ThreadLimit limit(threads);
        Relighter relighter(scenes::relit_scene().transfer, scenes::relit_scene().shadow_rays(), 3);
        relighter.set_environment(scenes::random_environment(32, 8));
        return relighter.harmonics();
    };
    EXPECT_EQ(light_with(1), light_with(4));
}

TEST(HarmonicLight, RadianceOfSurfacesDoesNotDependOnIt) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    Relighter with(scene.transfer, scene.shadow_rays(), 3),
        without(scene.transfer, scene.shadow_rays());
    with.set_environment(scenes::random_environment(32, 8));
    without.set_environment(scenes::random_environment(32, 8));
    EXPECT_TRUE(
        std::equal(with.radiance().begin(), with.radiance().end(), without.radiance().begin()));
    EXPECT_THROW(static_cast<void>(without.harmonics()), std::logic_error);
    EXPECT_THROW(Relighter(scene.transfer, {}, 4), std::invalid_argument);
}

TEST(HarmonicLight, OfAPointFromItsClustersAddsUp) {
    const PointScene& points = point_scene();
    Relighter relighter(points.transfer);
    relighter.set_environment(scenes::smooth_environment(32));
    for (std::size_t place = 0; place < 150; place += 37) {
        glm::dvec3 sum(0.0);
        for (std::size_t cluster = 0; cluster < points.transfer.num_clusters(); ++cluster)
            sum += relighter.receiver_light().mean_from_cluster(cluster) *
                   static_cast<double>(points.transfer.counts.count(place, cluster));
        EXPECT_NEAR(sum.g, relighter.radiance()[points.transfer.order[place]].g, 1e-5 * sum.g);
    }
}

} // namespace
} // namespace relumine::relight
