// Rays against the integral over all texels.
#include "relight/surfaces/reflections.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/glossy/brdf.h"
#include "relight/kernels/cluster_lights.h"
#include "tests/prt/scenes.h"
#include "tests/relight/environments.h"

namespace relumine::relight {
namespace {

constexpr std::uint32_t R = 64;

const Reflections::Surfaces NoSurface = [](const MetSurface&) {
    ADD_FAILURE() << "nothing stands around the point";
    return glm::vec3(0.0f);
};

prt::Surface metal(float roughness) {
    return {.albedo = glm::vec3(0.0f),
            .specular = glm::vec3(1.0f),
            .highlight = prt::Highlight::GgxWhole,
            .roughness_or_exponent = roughness,
            .metallic = 1.0f};
}

MirrorPoint seen_at(float n_v) {
    return {.position = glm::vec3(0.0f),
            .normal = {0.0f, 0.0f, 1.0f},
            .to_eye = {std::sqrt(1.0f - n_v * n_v), 0.0f, n_v},
            .shift = {0.3f, 0.7f}};
}

prt::Lobes<glm::vec3> mirrored(const Reflections& reflections, const prt::Surface& surface,
                               const MirrorPoint& point,
                               const Reflections::Surfaces& surfaces = NoSurface) {
    return lobes_of(surface, reflections.light(surface, point, reflections.num_rays(), surfaces),
                    {surface, point.normal, point.to_eye});
}

/// The sum over texels, each at its middle.
prt::Lobes<glm::vec3> integrated(const prt::Surface& surface, const MirrorPoint& point,
                                 const cubemap::CubeMap& environment) {
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(environment.resolution);
    prt::Lobes<glm::vec3> sum;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < environment.resolution; ++y)
            for (std::uint32_t x = 0; x < environment.resolution; ++x) {
                const glm::vec3 w(cubemap::texel_direction(face, x, y, environment.resolution));
                const auto lobes = prt::evaluate_lobes(surface, point.normal, point.to_eye, w);
                const glm::vec3 light =
                    environment.at(face, x, y) *
                    static_cast<float>(solid_angles[std::size_t{y} * environment.resolution + x]);
                prt::add_scaled(sum, prt::converted<glm::vec3>(lobes), light);
            }
    return sum;
}

/// A mesh that no ray meets.
const prt::RayScene& nothing() {
    static const prt::RayScene Rays(scenes::box({-1.0f, -1.0f, -3.0f}, {1.0f, 1.0f, -2.0f}));
    return Rays;
}

TEST(Reflections, OfASmoothSkyAreItsIntegral) {
    const cubemap::CubeMap sky = scenes::smooth_environment(R);
    const Reflections reflections(nothing(), 0.0f, 1024, sky, {});
    for (const float roughness : {0.3f, 0.5f, 1.0f})
        for (const float n_v : {1.0f, 0.6f, 0.2f}) {
            const prt::Surface surface = metal(roughness);
            const MirrorPoint point = seen_at(n_v);
            const auto lobes = mirrored(reflections, surface, point);
            const auto expected = integrated(surface, point, sky);
            const float scale = expected.specular.g;
            EXPECT_NEAR(lobes.specular.g, expected.specular.g, 0.01f * scale)
                << roughness << " " << n_v;
            EXPECT_NEAR(lobes.specular_grazing.g, expected.specular_grazing.g, 0.01f * scale);
        }
}

/// White plaster under a coat and a sheen.
prt::Surface layered(float roughness) {
    return {.specular = glm::vec3(0.04f),
            .highlight = prt::Highlight::GgxWhole,
            .roughness_or_exponent = roughness,
            .coat = 1.0f,
            .coat_roughness = roughness,
            .sheen = glm::vec3(1.0f),
            .sheen_roughness = roughness};
}

TEST(Reflections, OfCoatAndSheenAreTheirIntegral) {
    const cubemap::CubeMap sky = scenes::smooth_environment(R);
    const Reflections reflections(nothing(), 0.0f, 4096, sky, {});
    for (const float roughness : {0.4f, 1.0f})
        for (const float n_v : {0.9f, 0.4f}) {
            prt::Surface surface = layered(roughness);
            surface.coat_normal = glm::normalize(glm::vec3(0.2f, 0.1f, 1.0f));
            const MirrorPoint point = seen_at(n_v);
            const auto lobes = mirrored(reflections, surface, point);
            const auto expected = integrated(surface, point, sky);
            EXPECT_NEAR(lobes.coat.g, expected.coat.g, 0.02f * expected.coat.g)
                << roughness << " " << n_v;
            EXPECT_NEAR(lobes.sheen.g, expected.sheen.g, 0.02f * expected.sheen.g)
                << roughness << " " << n_v;
        }
}

/// Where the sky has detail, rays of a sheen look into their parts, too.
TEST(Reflections, SheenSeesWhereTheLightComesFrom) {
    const cubemap::CubeMap sky =
        scenes::times(scenes::smooth_environment(R), [](const glm::dvec3& w) {
            return w.x < -0.3 && std::sin(40.0 * w.y) > 0.0 ? 20.0f : 0.1f;
        });
    const Reflections reflections(nothing(), 0.0f, 1024, sky, {});
    for (const float roughness : {0.4f, 0.8f})
        for (const float n_v : {0.9f, 0.4f}) {
            const prt::Surface surface = layered(roughness);
            const MirrorPoint point = seen_at(n_v);
            const float expected = integrated(surface, point, sky).sheen.g;
            EXPECT_NEAR(mirrored(reflections, surface, point).sheen.g, expected, 0.03f * expected)
                << roughness << " " << n_v;
        }
}

/// Each colour has its own highlight.
TEST(Reflections, OfAFilmAreTheirIntegral) {
    const cubemap::CubeMap sky = scenes::smooth_environment(R);
    const Reflections reflections(nothing(), 0.0f, 4096, sky, {});
    for (const float roughness : {0.3f, 0.8f})
        for (const float n_v : {0.9f, 0.4f}) {
            prt::Surface surface = metal(roughness);
            surface.film = 1.0f;
            surface.film_ior = 1.5f;
            const MirrorPoint point = seen_at(n_v);
            const auto lobes = mirrored(reflections, surface, point);
            const auto expected = integrated(surface, point, sky);
            const float scale = expected.specular.r;
            EXPECT_NEAR(lobes.specular.r, expected.specular.r, 0.015f * scale)
                << roughness << " " << n_v;
            EXPECT_NEAR(lobes.specular_grazing.g, expected.specular_grazing.g, 0.015f * scale);
            EXPECT_NEAR(lobes.diffuse_grazing.b, expected.diffuse_grazing.b, 0.015f * scale);
        }
}

/// Rays of a stretched lobe against the sum over all texels, which knows nothing of how they are
/// spread.
TEST(Reflections, OfAStretchedLobeAreItsIntegral) {
    // A gradient along one axis across the normal: what differs between the two roughnesses.
    const cubemap::CubeMap sky =
        scenes::times(scenes::smooth_environment(R), [](const glm::dvec3& w) {
            const auto along = static_cast<float>(w.x);
            return 0.1f + 4.0f * along * along;
        });
    const Reflections reflections(nothing(), 0.0f, 4096, sky, {});
    for (const float roughness : {0.35f, 0.6f})
        for (const float anisotropy : {0.4f, 0.9f})
            for (const float n_v : {1.0f, 0.6f, 0.3f})
                for (const glm::vec3 tangent : {glm::vec3(1.0f, 0.0f, 0.0f),
                                                {0.0f, 1.0f, 0.0f},
                                                glm::normalize(glm::vec3(1.0f, 2.0f, 0.5f))}) {
                    prt::Surface surface = metal(roughness);
                    surface.anisotropy = anisotropy;
                    surface.tangent = tangent;
                    const MirrorPoint point = seen_at(n_v);
                    const auto lobes = mirrored(reflections, surface, point);
                    const auto expected = integrated(surface, point, sky);
                    EXPECT_NEAR(lobes.specular.g, expected.specular.g, 0.015f * expected.specular.g)
                        << roughness << " " << anisotropy << " " << n_v << " " << tangent.x;
                }
}

TEST(Reflections, PhongHasNoEnergyToKeep) {
    const cubemap::CubeMap sky = scenes::smooth_environment(R);
    const Reflections reflections(nothing(), 0.0f, 4096, sky, {});
    const prt::Surface surface{.specular = glm::vec3(0.5f),
                               .highlight = prt::Highlight::BlinnPhong,
                               .roughness_or_exponent = 20.0f};
    const MirrorPoint point = seen_at(0.8f);
    const auto lobes = mirrored(reflections, surface, point);
    const auto expected = integrated(surface, point, sky);
    EXPECT_NEAR(lobes.specular.g, expected.specular.g, 0.02f * expected.specular.g);
}

TEST(Reflections, AWhiteSkyHasNoNoise) {
    const cubemap::CubeMap white(16, glm::vec3(1.0f));
    const Reflections reflections(nothing(), 0.0f, 16, white, {});
    for (const float roughness : {0.0f, 0.4f, 1.0f})
        for (const float n_v : {1.0f, 0.5f, 0.05f}) {
            const prt::Surface surface = metal(roughness);
            const MirrorPoint point = seen_at(n_v);
            const glm::vec3 sent =
                prt::reflect(surface, mirrored(reflections, surface, point), n_v);
            EXPECT_NEAR(sent.r, 1.0f, 0.01f) << roughness << " " << n_v;
            // A white sky gives the plaster 1.
            prt::Lobes<glm::vec3> lobes = mirrored(reflections, layered(roughness), point);
            lobes.diffuse = glm::vec3(1.0f);
            const float layers = prt::reflect(layered(roughness), lobes, n_v).r;
            EXPECT_GT(layers, 0.99f) << roughness << " " << n_v;
            EXPECT_LT(layers, 1.0f + 1e-5f) << roughness << " " << n_v;
        }
}

/// What neighbouring pixels find, whose rays are shifted against each other.
struct Grain {
    double mean = 0.0, deviation = 0.0;
};
Grain grain_of(const Reflections& reflections, const prt::Surface& surface, float n_v,
               const Reflections::Surfaces& surfaces) {
    double sum = 0.0, square = 0.0;
    constexpr std::uint32_t NumPixels = 200;
    for (std::uint32_t i = 0; i < NumPixels; ++i) {
        MirrorPoint point = seen_at(n_v);
        point.shift = ray_shift(i);
        const double found = mirrored(reflections, surface, point, surfaces).specular.g;
        sum += found / NumPixels;
        square += found * found / NumPixels;
    }
    return {sum, std::sqrt(std::max(square - sum * sum, 0.0))};
}

/// Neighbouring pixels find the same of a window in a dark room.
TEST(Reflections, AWindowHasNoGrain) {
    const cubemap::CubeMap room = scenes::sky_of(R, [](const glm::dvec3& w) {
        return w.z > 0.7 && std::abs(w.x + 0.2) < 0.15 && w.y > -0.1 ? 10.0f : 0.1f;
    });
    const Reflections reflections(nothing(), 1e-4f, 32, room, {});
    for (const float roughness : {0.3f, 0.4f, 0.6f}) {
        const Grain found = grain_of(reflections, metal(roughness), 0.95f, NoSurface);
        EXPECT_LT(found.deviation, 0.03 * found.mean) << roughness;
        const double expected = integrated(metal(roughness), seen_at(0.95f), room).specular.g;
        EXPECT_NEAR(found.mean, expected, 0.05 * expected) << roughness;
    }
}

/// A ray of the lobe's tail that is below the surface has most of its part above it.
TEST(Reflections, WhereverRaysAreTheTailIsThere) {
    const Reflections reflections(nothing(), 1e-4f, 16, scenes::smooth_environment(R), {});
    const prt::Surface paint = metal(0.3f);
    double least = 1.0, most = 0.0;
    for (std::uint32_t i = 0; i < 200; ++i) {
        MirrorPoint point = seen_at(0.6f);
        point.shift = ray_shift(i);
        const double whole = reflections.light(paint, point, 16, NoSurface).whole;
        least = std::min(least, whole);
        most = std::max(most, whole);
    }
    EXPECT_LT(most - least, 0.01);
}

/// All rays of a mirror look at one point of a metal. Together they find its highlight, which has
/// the edge of a bright half in it.
TEST(Reflections, AMetalInAMirrorHasNoGrain) {
    const cubemap::CubeMap room =
        scenes::sky_of(R, [](const glm::dvec3& w) { return w.y > 0.7 ? 10.0f : 0.1f; });
    const prt::RayScene wall(scenes::box({-2.0f, -1.0f, 0.5f}, {-1.0f, 1.0f, 2.0f}));
    const Reflections reflections(wall, 1e-4f, 16, room, {});
    const auto paint = [&](const MetSurface& met) {
        // Somewhere else, so that the wall hides nothing of the room.
        const glm::vec3 normal = glm::normalize(glm::vec3(0.8f, 0.4f, -0.6f));
        return reflections.in_mirror(met, metal(0.3f), glm::vec3(50.0f), normal, glm::vec3(0.0f),
                                     NoSurface);
    };
    const Grain found = grain_of(reflections, metal(0.0f), 0.6f, paint);
    EXPECT_LT(found.deviation, 0.035 * found.mean);
}

TEST(Reflections, AMirrorShowsWhatItLooksAt) {
    // A wall of radiance 3 stands where the mirror looks, and hides the sky.
    const prt::RayScene wall(scenes::box({-2.0f, -1.0f, 0.5f}, {-1.0f, 1.0f, 2.0f}));
    const Reflections reflections(wall, 1e-4f, 16, cubemap::CubeMap(16, glm::vec3(0.25f)), {});
    const auto bright = [&](const MetSurface& met) {
        EXPECT_LT(met.direction.x, 0.0f);
        EXPECT_NEAR(reflections.sky(met.direction, met.solid_angle).r, 0.25f, 1e-4f);
        return glm::vec3(3.0f);
    };
    const prt::Surface mirror = metal(0.0f);
    const auto seen = [&](const MirrorPoint& point) {
        return prt::reflect(mirror, mirrored(reflections, mirror, point, bright),
                            glm::dot(point.normal, point.to_eye))
            .r;
    };
    EXPECT_NEAR(seen(seen_at(0.6f)), 3.0f, 0.03f);
    EXPECT_NEAR(seen(seen_at(1.0f)), 0.25f, 0.01f) << "up, beside the wall";
    MirrorPoint away = seen_at(0.6f);
    away.to_eye = -away.to_eye;
    EXPECT_EQ(mirrored(reflections, mirror, away, bright).specular, glm::vec3(0.0f));
}

/// Whatever a surface mirrors, its questions stand for all rays of a fan.
TEST(Reflections, QuestionsStandForAllRays) {
    const prt::Hit hit{};
    const glm::vec3 direction(0.0f, 0.0f, -1.0f);
    for (const std::uint32_t num_rays : {1u, 16u, 32u, 64u, 256u})
        for (const float f0 : {0.0f, 0.04f, 0.1f, 0.25f, 1.0f}) {
            prt::Surface surface = metal(0.3f);
            surface.specular = glm::vec3(f0);
            std::uint32_t sum = 0, asked = 0;
            for (std::uint32_t ray = 0; ray < num_rays; ++ray) {
                const std::uint32_t count = asked_for({.hit = hit,
                                                       .direction = direction,
                                                       .ray = ray,
                                                       .num_rays = num_rays,
                                                       .fan_shift = {0.2f, 0.7f}},
                                                      surface);
                sum += count;
                asked += count > 0;
            }
            EXPECT_NEAR(sum, num_rays, num_rays / asked) << num_rays << " rays, F0 " << f0;
            if (f0 >= 0.25f)
                EXPECT_EQ(asked, num_rays) << "a metal is never guessed";
            else
                EXPECT_LE(asked, 16u) << num_rays << " rays, F0 " << f0;
        }
}

/// A surface that a mirror shows sends what it mirrors itself, sharp lights included.
TEST(Reflections, ASurfaceInAMirrorMirrorsTheSky) {
    cubemap::CubeMap sky = scenes::smooth_environment(R);
    const glm::vec3 to_eye = glm::normalize(glm::vec3(0.6f, 0.0f, 0.8f));
    const glm::vec3 way(-to_eye.x, 0.0f, to_eye.z);
    const prt::Hit hit{};
    const glm::vec3 direction = -to_eye;
    const MetSurface met{.hit = hit, .direction = direction, .solid_angle = 1e-4f};
    prt::Surface gold = metal(0.0f);
    gold.specular = {0.9f, 0.6f, 0.3f};
    const auto mirrored_twice = [&](const Reflections& reflections) {
        return reflections.in_mirror(met, gold, glm::vec3(0.0f), {0.0f, 0.0f, 1.0f},
                                     glm::vec3(0.0f), NoSurface);
    };
    const glm::vec3 reflected = prt::reflect(
        gold, lobes_of(gold, {.all = glm::vec3(1.0f), .grazing = glm::vec3(1.0f)}, 0.8f), 0.8f);
    const Reflections reflections(nothing(), 0.0f, 16, sky, {});
    const glm::vec3 expected = reflected * cubemap::sample(sky, way);
    EXPECT_LT(glm::distance(mirrored_twice(reflections), expected), 0.02f * glm::length(expected));

    // A light that is traced is not in the first mirror, and in the second.
    const cubemap::CubeMap all(R, glm::vec3(0.5f));
    const LightBinning binning(R);
    const prt::Cell cell{cubemap::Face::PositiveZ, 0, 0, 0};
    const SharpLight light{.cell = cell, .irradiance = binning.sum(all, cell)};
    const Reflections without(nothing(), 0.0f, 16, all, {&light, 1});
    EXPECT_LT(without.sky(way, 1e-4f).g, 0.1f);
    EXPECT_NEAR(mirrored_twice(without).g, 0.5f * reflected.g, 0.01f);
}

TEST(Reflections, LightsThatAreTracedAreNotMirrored) {
    cubemap::CubeMap sky(R, glm::vec3(0.5f));
    sky.at(cubemap::Face::PositiveZ, 20, 30) = glm::vec3(900.0f, 800.0f, 700.0f);
    const prt::Cell texel{cubemap::Face::PositiveZ, 6, 20, 30};
    const LightBinning binning(R);
    SharpLight light{.cell = texel, .irradiance = binning.sum(sky, texel)};
    const cubemap::CubeMap left = without_lights(sky, {&light, 1});
    EXPECT_LT(glm::length(left.at(cubemap::Face::PositiveZ, 20, 30)), 1e-3f);
    EXPECT_EQ(left.at(cubemap::Face::PositiveZ, 21, 30), glm::vec3(0.5f));
    // A light of a wider cell takes its part of the power.
    light.cell = {cubemap::Face::PositiveZ, 5, 10, 15};
    const cubemap::CubeMap wide = without_lights(sky, {&light, 1});
    const double before = glm::length(binning.sum(sky, light.cell).green);
    const double after = glm::length(binning.sum(wide, light.cell).green);
    EXPECT_NEAR(after, before - glm::length(light.irradiance.green), 1e-3 * before);
    EXPECT_GT(Reflections(nothing(), 0.0f, 16, sky, {&light, 1}).least_roughness(), 0.05f);
}

} // namespace
} // namespace relumine::relight
