#include "prt/receivers/pixel_receivers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "tests/prt/scenes.h"
#include "tests/prt/textured_square.h"

namespace relumine::prt {
namespace {

PixelReceivers seen(const mesh::TriangleMesh& mesh, const PixelView& view) {
    return pixel_receivers(mesh, RayScene(mesh), view);
}

/// Facets of a map that would mirror the eye's ray into the surface turn until they do not.
TEST(PixelReceivers, MappedNormalsMirrorTheEyeToTheOutside) {
    const Camera camera{.eye = {0, -3, 1}, .target = {0, 0, 0}, .fov_degrees = 20.0f};
    const auto receivers = [&](const std::array<std::uint8_t, 3>& color) {
        mesh::TriangleMesh mesh = scenes::mapped_square(color);
        mesh.materials[0].model = mesh::MaterialModel::MetallicRoughness;
        return seen(mesh, {.camera = camera, .width = 8, .height = 8}).receivers;
    };
    const Receivers flat = receivers({128, 127, 255}), steep = receivers({128, 255, 64});
    const Receivers gentle = receivers({128, 100, 255});
    ASSERT_EQ(flat.size(), steep.size());
    for (std::size_t i = 0; i < flat.size(); ++i) {
        EXPECT_EQ(flat.normals[i], glm::vec3(0, 0, 1));
        const auto mirrored = [&](const glm::vec3& normal) {
            return -glm::reflect(flat.to_eye[i], normal);
        };
        EXPECT_GT(mirrored(gentle.normals[i]).z, 0.1f);
        EXPECT_NEAR(gentle.normals[i].y, -27.0f / std::sqrt(27.0f * 27.0f + 127.0f * 127.0f),
                    1e-2f);
        EXPECT_NEAR(mirrored(steep.normals[i]).z, 0.1f, 1e-4f);
        EXPECT_NEAR(glm::length(steep.normals[i]), 1.0f, 1e-6f);
        EXPECT_GT(steep.normals[i].y, 0.05f) << "still the side of the map's";
    }
}

TEST(PixelReceivers, CoverASpheresSilhouette) {
    const mesh::TriangleMesh sphere = scenes::icosphere(5, 1.0f, {0.3f, -0.2f, 0.1f});
    const Camera camera{
        .eye = {0.3f, -0.2f, 4.1f}, .target = {0.3f, -0.2f, 0.1f}, .fov_degrees = 40.0f};
    const PixelReceivers pixels =
        seen(sphere, {.camera = camera, .width = 150, .height = 100, .samples_per_axis = 3});
    // A cone of half-angle asin(1/4) cuts a circle out of the picture's plane.
    const double radius =
        std::tan(std::asin(0.25)) / std::tan(20.0 * std::numbers::pi / 180.0) * 50.0;
    const double expected = std::numbers::pi * radius * radius;
    EXPECT_NEAR(static_cast<double>(pixels.receivers.size()) / 9.0, expected, 0.01 * expected);
    EXPECT_EQ(pixels.layout.num_samples(), 150u * 100u * 9u);

    const Receivers& receivers = pixels.receivers;
    ASSERT_EQ(receivers.normals.size(), receivers.size());
    ASSERT_EQ(receivers.to_eye.size(), receivers.size());
    ASSERT_EQ(receivers.points.size(), receivers.size());
    ASSERT_EQ(pixels.layout.samples.size(), receivers.size());
    EXPECT_TRUE(std::is_sorted(pixels.layout.samples.begin(), pixels.layout.samples.end(),
                               std::less_equal<>())); // strictly
    const PictureRays rays(camera, 150, 100, 3);
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const glm::vec3 outward = receivers.positions[i] - camera.target;
        EXPECT_NEAR(glm::length(outward), 1.0f, 2e-3f);
        EXPECT_GT(glm::dot(receivers.normals[i], glm::normalize(outward)), 0.999f);
        EXPECT_NEAR(glm::length(receivers.normals[i]), 1.0f, 1e-5f);
        // The sample's ray goes where the receiver is.
        const std::uint32_t sample = pixels.layout.samples[i];
        const glm::vec3 ray = rays.direction(sample / 9 % 150, sample / 9 / 150, sample % 9);
        EXPECT_LT(glm::length(ray + receivers.to_eye[i]), 1e-4f);
        const glm::vec3 flat = value_at(sphere, sphere.positions, receivers.points[i]);
        EXPECT_NEAR(glm::distance(receivers.positions[i], flat), 0.0f, 2e-3f);
        EXPECT_GE(glm::length(outward) + 1e-6f, glm::length(flat - camera.target));
    }
}

/// A silhouette has no stairs: each pixel of a sphere's outline knows its covered part to a
/// sixteenth, and what is inside costs one receiver.
TEST(PixelReceivers, PixelsOfAnOutlineKnowWhatIsCovered) {
    const mesh::TriangleMesh sphere = scenes::icosphere(5, 1.0f, glm::vec3(0.0f));
    const Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 40.0f};
    const PixelReceivers pixels = seen(
        sphere, {.camera = camera, .width = 100, .height = 100, .samples_per_axis = std::nullopt});
    const double radius =
        std::tan(std::asin(0.25)) / std::tan(20.0 * std::numbers::pi / 180.0) * 50.0;
    std::vector<double> covered(100 * 100);
    std::size_t num_whole = 0;
    for (std::size_t i = 0; i < pixels.receivers.size(); ++i) {
        covered[pixels.layout.samples[i] / 16] +=
            static_cast<double>(pixels.layout.num_shown(i)) / 16.0;
        num_whole += pixels.layout.num_shown(i) == 16 ? 1 : 0;
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < covered.size(); ++i) {
        const double x = static_cast<double>(i % 100) - 49.5,
                     y = static_cast<double>(i / 100) - 49.5;
        const double inside = radius - std::hypot(x, y); // pixels from the outline
        if (std::abs(inside) > 0.8) {
            EXPECT_EQ(covered[i], inside > 0.0 ? 1.0 : 0.0) << i;
        } else { // an edge whose normal is (x, y) cuts the pixel
            EXPECT_NEAR(covered[i], std::clamp(0.5 + inside, 0.0, 1.0), 0.2) << i;
        }
        sum += covered[i];
    }
    EXPECT_NEAR(sum, std::numbers::pi * radius * radius, 0.005 * sum);
    EXPECT_GT(num_whole, static_cast<std::size_t>(0.85 * sum));
    EXPECT_LT(pixels.receivers.size(), static_cast<std::size_t>(1.25 * sum));
}

TEST(PixelReceivers, TellTheirProgressAndStop) {
    const mesh::TriangleMesh sphere = scenes::icosphere(2, 1.0f, glm::vec3(0.0f));
    const RayScene rays(sphere);
    const PixelView view{
        .camera = {.eye = {0, 0, 4}, .target = glm::vec3(0)}, .width = 8, .height = 1000};
    std::vector<double> told;
    const auto pixels = pixel_receivers(sphere, rays, view, {.on_progress = [&](double fraction) {
                                            told.push_back(fraction);
                                        }});
    EXPECT_EQ(pixels.layout.samples, seen(sphere, view).layout.samples);
    EXPECT_GT(told.size(), 4u);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_EQ(told.back(), 1.0);

    std::stop_source stop;
    const Work work{.stop = stop.get_token(), .on_progress = [&](double) {
                        stop.request_stop();
                    }};
    EXPECT_THROW(static_cast<void>(pixel_receivers(sphere, rays, view, work)), Cancelled);
}

TEST(PixelReceivers, FacetsDoNotShadeACoarseSphereWhereLightGrazes) {
    const mesh::TriangleMesh sphere = scenes::icosphere(2, 1.0f, glm::vec3(0.0f));
    const RayScene rays(sphere);
    const PixelReceivers pixels =
        pixel_receivers(sphere, rays, {.camera = {.eye = {0, 0, 6}}, .width = 60, .height = 60});
    const glm::vec3 light = glm::normalize(glm::vec3(1.0f, 0.13f, 0.07f));
    std::size_t num_grazed = 0, num_shaded = 0, num_shaded_flat = 0;
    for (std::size_t i = 0; i < pixels.receivers.size(); ++i) {
        const glm::vec3& normal = pixels.receivers.normals[i];
        const float cosine = glm::dot(normal, light);
        if (cosine < 0.03f || cosine > 0.3f)
            continue;
        const auto is_shaded = [&](const glm::vec3& position) {
            return rays.occluded(ray_origin(position, normal, 1e-4f), light) ? 1u : 0u;
        };
        ++num_grazed;
        num_shaded += is_shaded(pixels.receivers.positions[i]);
        num_shaded_flat +=
            is_shaded(value_at(sphere, sphere.positions, pixels.receivers.points[i]));
    }
    EXPECT_GT(num_grazed, 100u);
    EXPECT_GT(num_shaded_flat, num_grazed / 15) << "the fault that is mended";
    EXPECT_LT(num_shaded, num_grazed / 100);
}

TEST(PixelReceivers, BackFacesTurnTheirNormals) {
    const mesh::TriangleMesh floor = scenes::floor_grid(4, 2.0f);
    for (const float side : {1.0f, -1.0f}) {
        const PixelReceivers pixels =
            seen(floor, {.camera = {.eye = {0.1f, 3.0f * side, 0.2f}}, .width = 8, .height = 8});
        for (const glm::vec3& normal : pixels.receivers.normals)
            EXPECT_EQ(normal, glm::vec3(0.0f, side, 0.0f));
    }
    // Triangles the other way round do not make vertex normals wrong.
    mesh::TriangleMesh turned = floor;
    for (mesh::Triangle& triangle : turned.triangles)
        std::swap(triangle[1], triangle[2]);
    const PixelReceivers pixels =
        seen(turned, {.camera = {.eye = {0.1f, 3.0f, 0.2f}}, .width = 8, .height = 8});
    for (const glm::vec3& normal : pixels.receivers.normals)
        EXPECT_EQ(normal, glm::vec3(0.0f, 1.0f, 0.0f));
}

TEST(PixelReceivers, AnEyeInsideSeesAllAround) {
    const mesh::TriangleMesh sphere = scenes::icosphere(3, 2.0f, glm::vec3(0.0f));
    const PixelReceivers pixels = seen(
        sphere,
        {.camera = {.eye = {0.1f, 0.2f, 0.0f}, .target = {1, 1, 1}}, .width = 20, .height = 10});
    EXPECT_EQ(pixels.receivers.size(), 200u);
    for (std::size_t i = 0; i < 200; ++i)
        EXPECT_GT(glm::dot(pixels.receivers.normals[i], pixels.receivers.to_eye[i]), 0.0f);
}

TEST(PixelReceivers, NormalsThatCancelAreTheFaces) {
    mesh::TriangleMesh mesh;
    mesh.positions = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 0}};
    mesh.normals.assign(3, glm::vec3(0.0f));
    mesh.triangles = {{0, 1, 2}};
    const PixelReceivers pixels =
        seen(mesh, {.camera = {.eye = {0.0f, 3.0f, 0.0f}}, .width = 16, .height = 16});
    for (const glm::vec3& normal : pixels.receivers.normals)
        EXPECT_EQ(normal, glm::vec3(0.0f, 1.0f, 0.0f));
}

TEST(PixelReceivers, TheSameForAnyNumberOfThreads) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const PixelView view{
        .camera = {.eye = {4, 3, 5}}, .width = 60, .height = 40, .samples_per_axis = 2};
    const PixelReceivers all = seen(mesh, view);
    const files::ThreadLimit one(1);
    const PixelReceivers alone = seen(mesh, view);
    EXPECT_EQ(all.receivers.positions, alone.receivers.positions);
    EXPECT_EQ(all.receivers.normals, alone.receivers.normals);
    EXPECT_EQ(all.receivers.to_eye, alone.receivers.to_eye);
    EXPECT_EQ(all.receivers.points, alone.receivers.points);
    EXPECT_EQ(all.layout, alone.layout);
}

TEST(PixelReceivers, RefusesViewsOfNothing) {
    const mesh::TriangleMesh floor = scenes::floor_grid(4, 2.0f);
    EXPECT_THROW(
        static_cast<void>(seen(
            floor, {.camera = {.eye = {0, 3, 0}, .target = {0, 4, 0}}, .width = 8, .height = 8})),
        std::invalid_argument);
    EXPECT_THROW(static_cast<void>(seen(floor, {.camera = {}, .width = 8, .height = 8})),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(seen(floor, {.camera = {.eye = {0, 3, 0}},
                                                .width = MaxPictureSize,
                                                .height = MaxPictureSize,
                                                .samples_per_axis = 2})),
                 std::invalid_argument);
}

} // namespace
} // namespace relumine::prt
