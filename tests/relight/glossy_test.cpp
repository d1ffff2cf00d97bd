// Glossy relighting against closed forms and exact integration.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/glossy/brdf.h"
#include "relight/kernels/glossy_kernels.h"
#include "relight/light_pyramid.h"
#include "relight/reference/exact.h"
#include "relight/relighter.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/every_target.h"
#include "tests/relight/arrays.h"
#include "tests/relight/environments.h"
#include "tests/relight/glossy_scene.h"

namespace relumine::relight {
namespace {

using scenes::expect_close;
using scenes::glossy_scene;

double relative_l2(const scenes::GlossyScene& scene, const Relighter& relighter) {
    const std::vector<std::uint32_t> all = all_of(scene.receivers.size());
    const std::vector<glm::dvec3> exact =
        exact_radiance(scene.receivers, all, scene.diffuse.rays, relighter.environment(),
                       {.bias = scene.options.bias});
    return compare(all, exact, relighter.radiance()).relative_l2;
}

/// A sphere of GGX seen from far along +Z.
prt::Receivers shiny_sphere(float roughness, std::size_t n) {
    prt::Receivers receivers;
    std::mt19937 random(7);
    while (receivers.size() < n) {
        const glm::vec3 normal = scenes::random_direction(random);
        if (normal.z < 0.1f)
            continue;
        receivers.positions.push_back(normal);
        receivers.normals.push_back(normal);
        receivers.to_eye.emplace_back(0.0f, 0.0f, 1.0f);
        receivers.surfaces.push_back({.albedo = glm::vec3(0.0f),
                                      .specular = glm::vec3(1.0f, 0.7f, 0.3f),
                                      .highlight = prt::Highlight::Ggx,
                                      .roughness_or_exponent = roughness});
    }
    return receivers;
}

prt::Transfer glossy_transfer(const prt::Receivers& receivers, float tolerance,
                              std::uint32_t face_resolution) {
    const scenes::AnalyticBlockers nothing = scenes::no_blockers();
    prt::Transfer transfer =
        prt::precompute(receivers, nothing, {.face_resolution = face_resolution});
    transfer.glossy = prt::precompute_glossy(
        receivers, nothing, transfer, {.tolerance = tolerance, .face_resolution = face_resolution});
    prt::set_surfaces(transfer, receivers);
    return transfer;
}

// One texel of light: B = F D V n.w L dw, the highlight in closed form.
TEST(GlossyRelighting, HighlightOfASmallLightOnASphere) {
    constexpr std::uint32_t R = 128;
    cubemap::CubeMap map(R);
    const prt::Cell at{cubemap::Face::PositiveX, 7, 80, 50};
    map.at(at.face, at.x, at.y) = glm::vec3(1000.0f, 800.0f, 600.0f);
    const glm::vec3 w = cubemap::texel_direction(at.face, at.x, at.y, R);
    const double dw =
        cubemap::solid_angle(at.x / 128.0, at.y / 128.0, (at.x + 1) / 128.0, (at.y + 1) / 128.0);
    for (const float roughness : {0.25f, 0.5f, 0.9f}) {
        const prt::Receivers receivers = shiny_sphere(roughness, 600);
        const prt::Transfer transfer = glossy_transfer(receivers, 0.02f, R);
        const std::vector<glm::vec3> radiance = relight(transfer, map);
        double squares = 0.0;
        double error_squares = 0.0;
        for (std::size_t i = 0; i < receivers.size(); ++i) {
            // As glTF 2.0 has it, in double and apart from the library's own code.
            const double a2 = std::pow(static_cast<double>(roughness), 4.0);
            const glm::dvec3 n(receivers.normals[i]);
            const glm::dvec3 v(0.0, 0.0, 1.0);
            const glm::dvec3 l(w);
            const glm::dvec3 h = glm::normalize(v + l);
            const double n_l = glm::dot(n, l);
            const double n_v = glm::dot(n, v);
            glm::dvec3 expected(0.0);
            if (n_l > 0.0) {
                const double n_h = glm::dot(n, h);
                const double d =
                    a2 / (std::numbers::pi * std::pow(n_h * n_h * (a2 - 1.0) + 1.0, 2.0));
                const double g = 0.5 / (n_l * std::sqrt(n_v * n_v * (1.0 - a2) + a2) +
                                        n_v * std::sqrt(n_l * n_l * (1.0 - a2) + a2));
                const glm::dvec3 f0(1.0, 0.7, 0.3);
                const glm::dvec3 f = f0 + (1.0 - f0) * std::pow(1.0 - glm::dot(v, h), 5.0);
                expected = f * d * g * n_l * dw * glm::dvec3(1000.0, 800.0, 600.0);
            }
            squares += glm::dot(expected, expected);
            const glm::dvec3 error = glm::dvec3(radiance[i]) - expected;
            error_squares += glm::dot(error, error);
        }
        EXPECT_LT(std::sqrt(error_squares / squares), 0.04) << "roughness " << roughness;
    }
}

// A white sky: what the lobe's albedo leaves of it, which evaluate_lobes() integrated over a fine
// grid gives.
TEST(GlossyRelighting, WhiteFurnaceOfARoughPlane) {
    prt::Receivers receivers;
    for (int i = 0; i < 8; ++i) {
        receivers.positions.emplace_back(0.01f * static_cast<float>(i), 0.0f, 0.0f);
        receivers.normals.emplace_back(0.0f, 1.0f, 0.0f);
        const double angle = 0.19 * i;
        receivers.to_eye.emplace_back(std::sin(angle), std::cos(angle), 0.0);
        receivers.surfaces.push_back({.albedo = glm::vec3(0.8f),
                                      .specular = glm::vec3(0.04f),
                                      .highlight = prt::Highlight::Ggx,
                                      .roughness_or_exponent = 0.5f});
    }
    const prt::Transfer transfer = glossy_transfer(receivers, 0.02f, 256);
    cubemap::CubeMap white(16);
    white.texels.assign(white.texels.size(), glm::vec3(1.0f));
    const std::vector<glm::vec3> radiance = relight(transfer, white);
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        prt::Lobes<double> sums;
        constexpr int N = 400;
        for (int a = 0; a < N; ++a)
            for (int b = 0; b < 2 * N; ++b) {
                // Even in cos^2 of the angle to the normal, so that each sample stands for pi / (N
                // 2N) of the projected hemisphere.
                const double cosine = std::sqrt((a + 0.5) / N);
                const double sine = std::sqrt(1.0 - cosine * cosine);
                const double azimuth = std::numbers::pi * (b + 0.5) / N;
                const glm::vec3 w(sine * std::cos(azimuth), cosine, sine * std::sin(azimuth));
                const prt::Lobes<float> lobes = prt::evaluate_lobes(
                    receivers.surfaces[i], receivers.normals[i], receivers.to_eye[i], w);
                const double dw = std::numbers::pi / (2.0 * N * N) / cosine;
                sums.diffuse += static_cast<double>(lobes.diffuse) * dw;
                sums.diffuse_grazing += static_cast<double>(lobes.diffuse_grazing) * dw;
                sums.specular += static_cast<double>(lobes.specular) * dw;
                sums.specular_grazing += static_cast<double>(lobes.specular_grazing) * dw;
            }
        const auto in_float = [](double value) {
            return glm::vec3(static_cast<float>(value));
        };
        const glm::vec3 expected =
            prt::reflect(receivers.surfaces[i],
                         {.diffuse = in_float(sums.diffuse),
                          .diffuse_grazing = in_float(sums.diffuse_grazing),
                          .specular = in_float(sums.specular),
                          .specular_grazing = in_float(sums.specular_grazing)},
                         glm::dot(receivers.normals[i], receivers.to_eye[i]));
        EXPECT_NEAR(radiance[i].g, expected.g, 0.01f) << i;
        EXPECT_LT(radiance[i].g, 1.0f);
    }
}

// A white sky over white surfaces that keep their energy: nothing is lost, at any roughness.
TEST(GlossyRelighting, WhiteFurnaceOfWholeGgx) {
    prt::Receivers receivers;
    for (int i = 0; i < 24; ++i) {
        receivers.positions.emplace_back(0.01f * static_cast<float>(i), 0.0f, 0.0f);
        receivers.normals.emplace_back(0.0f, 1.0f, 0.0f);
        const double angle = 0.19 * (i % 8);
        receivers.to_eye.emplace_back(std::sin(angle), std::cos(angle), 0.0);
        const float metallic = i % 2 == 0 ? 0.0f : 1.0f;
        receivers.surfaces.push_back({.albedo = glm::vec3(1.0f - metallic),
                                      .specular = glm::vec3(0.04f + 0.96f * metallic),
                                      .highlight = prt::Highlight::GgxWhole,
                                      .roughness_or_exponent = i < 8    ? 0.3f
                                                               : i < 16 ? 0.6f
                                                                        : 1.0f,
                                      .metallic = metallic});
    }
    const prt::Transfer transfer = glossy_transfer(receivers, 0.02f, 256);
    cubemap::CubeMap white(16);
    white.texels.assign(white.texels.size(), glm::vec3(1.0f));
    const std::vector<glm::vec3> radiance = relight(transfer, white);
    for (std::size_t i = 0; i < receivers.size(); ++i)
        EXPECT_NEAR(radiance[i].g, 1.0f, 0.01f) << i;
}

TEST(GlossyRelighting, CloseToExactIntegration) {
    for (const float roughness : {0.2f, 0.4f, 0.8f}) {
        const scenes::GlossyScene scene(0.05f, roughness, 64);
        Relighter relighter(scene.transfer, scene.shadow_rays());
        relighter.set_environment(scenes::smooth_environment(64));
        EXPECT_LT(relative_l2(scene, relighter), 0.01) << roughness;
        relighter.set_environment(scenes::random_environment(64, 9));
        EXPECT_LT(relative_l2(scene, relighter), 0.03) << roughness;
    }
}

TEST(GlossyRelighting, AFinerToleranceIsMoreExact) {
    const cubemap::CubeMap map = scenes::random_environment(64, 11);
    double last = 1.0;
    for (const float tolerance : {0.4f, 0.1f, 0.025f}) {
        const scenes::GlossyScene scene(tolerance);
        Relighter relighter(scene.transfer, scene.shadow_rays());
        relighter.set_environment(map);
        const double error = relative_l2(scene, relighter);
        EXPECT_LT(error, last);
        last = error;
    }
    EXPECT_LT(last, 0.015);
}

TEST(GlossyRelighting, ASharpSunIsTracedWithItsHighlight) {
    cubemap::CubeMap map = scenes::smooth_environment(64);
    map.at(cubemap::Face::PositiveY, 40, 20) = glm::vec3(30000.0f);
    const scenes::GlossyScene& scene = glossy_scene();
    Relighter relighter(scene.transfer, scene.shadow_rays());
    const UpdateReport times = relighter.set_environment(map);
    EXPECT_GT(times.num_sharp_lights, 0u);
    EXPECT_LT(relative_l2(scene, relighter), 0.005);
}

TEST(GlossyRelighting, LambertWithAnAlbedoIsGeometryRelightingTimesIt) {
    const scenes::RelitScene& diffuse = scenes::relit_scene();
    prt::Receivers receivers = diffuse.receivers;
    receivers.to_eye.assign(receivers.size(), glm::vec3(0.0f, 1.0f, 0.0f));
    receivers.surfaces.assign(receivers.size(), {.albedo = {0.5f, 0.25f, 1.0f}});
    prt::Transfer transfer = diffuse.transfer;
    transfer.glossy = prt::precompute_glossy(receivers, diffuse.rays, transfer);
    prt::set_surfaces(transfer, receivers);
    const cubemap::CubeMap map = scenes::random_environment(32, 2);
    std::vector<glm::vec3> expected = relight(diffuse.transfer, map);
    for (glm::vec3& b : expected)
        b *= glm::vec3(0.5f, 0.25f, 1.0f);
    EXPECT_EQ(relight(transfer, map), expected);
}

TEST(GlossyRelighting, UpdatesEqualAFullRelighting) {
    const scenes::GlossyScene& scene = glossy_scene();
    cubemap::CubeMap map = scenes::random_environment(64, 4);
    Relighter relighter(scene.transfer, scene.shadow_rays());
    relighter.set_environment(map);
    const TexelRectangle rectangle{
        .face = cubemap::Face::PositiveY, .x0 = 10, .y0 = 20, .x1 = 17, .y1 = 31};
    const std::vector<glm::vec3> patch(7 * 11, glm::vec3(3.0f, 2.0f, 0.5f));
    update_region(relighter, rectangle, patch);
    Relighter full(scene.transfer, scene.shadow_rays());
    full.set_environment(relighter.environment());
    expect_close(relighter.radiance(), full.radiance(), 1e-5);
    relighter.resum();
    EXPECT_EQ(copy(relighter.radiance()), copy(full.radiance()));
}

TEST(GlossyRelighting, FramesEqualFullRelightings) {
    const scenes::GlossyScene& scene = glossy_scene();
    Relighter relighter(scene.transfer, scene.shadow_rays());
    EnvironmentBinner binner(scene.transfer, scene.shadow_rays().tolerance);
    cubemap::CubeMap map = scenes::random_environment(32, 6);
    for (std::uint32_t frame = 0; frame < 3; ++frame) {
        map.at(cubemap::Face::PositiveZ, 3 + frame, 7) = glm::vec3(40.0f);
        relighter.set_frame(binner.bin(map));
        Relighter full(scene.transfer, scene.shadow_rays());
        full.set_environment(map);
        expect_close(relighter.radiance(), full.radiance(), 1e-5);
    }
}

TEST(GlossyRelighting, LightListsTracedAreExact) {
    const scenes::GlossyScene& scene = glossy_scene();
    const glm::dvec3 w = glm::normalize(glm::dvec3(0.3, 0.8, 0.2));
    const lights::DistantLight light{.direction = w, .irradiance = {3.0, 2.0, 1.0}};
    Relighter relighter(scene.transfer, scene.shadow_rays());
    relighter.set_lights({&light, 1});
    for (std::size_t i = 0; i < scene.receivers.size(); ++i) {
        const glm::vec3& normal = scene.receivers.normals[i];
        const glm::vec3 origin =
            prt::ray_origin(scene.receivers.positions[i], normal, scene.options.bias);
        glm::vec3 expected(0.0f);
        if (glm::dot(normal, glm::vec3(w)) > 0.0f &&
            !scene.diffuse.rays.occluded(origin, glm::vec3(w))) {
            const prt::Lobes<float> lobes = prt::evaluate_lobes(scene.receivers.surfaces[i], normal,
                                                                scene.receivers.to_eye[i], w);
            const glm::vec3 e(light.irradiance);
            expected = prt::reflect(scene.receivers.surfaces[i],
                                    {.diffuse = lobes.diffuse * e,
                                     .diffuse_grazing = lobes.diffuse_grazing * e,
                                     .specular = lobes.specular * e,
                                     .specular_grazing = lobes.specular_grazing * e},
                                    glm::dot(normal, scene.receivers.to_eye[i]));
        }
        EXPECT_LT(glm::distance(relighter.radiance()[i], expected),
                  1e-4f * (1.0f + glm::length(expected)));
    }
}

TEST(GlossyRelighting, TheKernelIsThePlainSumOnEveryTarget) {
    const prt::GlossyTransfer& glossy = *glossy_scene().transfer.glossy;
    LightPyramid pyramid(glossy.deepest_level());
    const cubemap::CubeMap map = scenes::random_environment(64, 8);
    pyramid.set(map, LightBinning(64), {});
    scenes::on_every_target([&] {
        const prt::LobeCuts& cuts = glossy.lobes[0];
        for (std::size_t block = 0; block + 1 < cuts.begin.size(); ++block) {
            BlockRadiance radiance;
            light_block(cuts, block, pyramid.light(), radiance);
            for (std::size_t i = 0; i < prt::BlockSize; ++i) {
                glm::dvec3 expected(0.0);
                for (std::size_t entry = cuts.begin[block]; entry < cuts.begin[block + 1];
                     ++entry) {
                    const double root = cuts.values[entry * prt::BlockSize + i];
                    const float* light =
                        pyramid.light().data() + std::size_t{3} * cuts.cells[entry];
                    expected += root * root * static_cast<double>(cuts.scales[entry]) *
                                glm::dvec3(light[0], light[1], light[2]);
                }
                EXPECT_LT(glm::length(glm::dvec3(radiance.of(i)) - expected),
                          1e-5 * glm::length(expected) + 1e-12);
            }
        }
    });
}

} // namespace
} // namespace relumine::relight
