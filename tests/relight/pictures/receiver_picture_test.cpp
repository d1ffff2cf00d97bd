#include "relight/pictures/receiver_picture.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/output_file.h"
#include "prt/precompute.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/receivers/texel_receivers.h"
#include "relight/pictures/picture_view.h"
#include "relight/reference/exact.h"
#include "relight/relighter.h"
#include "tests/prt/scenes.h"
#include "tests/relight/environments.h"

namespace relumine::relight {
namespace {

std::vector<std::uint32_t> all_of(const prt::Receivers& receivers) {
    std::vector<std::uint32_t> all(receivers.size());
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

float difference(const glm::vec3& a, const glm::vec3& b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

TEST(ReceiverPicture, EqualsADirectDrawOfTheSameRadiance) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const prt::RayScene rays(mesh);
    std::mt19937 random(3);
    std::vector<glm::vec3> colors;
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i)
        colors.push_back(glm::abs(scenes::random_direction(random)));
    const Camera camera{.eye = {4.0f, 3.0f, 5.0f}};
    const cubemap::CubeMap sky = scenes::smooth_environment(16);
    for (const std::uint32_t n : {1u, 3u}) {
        const prt::PixelReceivers pixels = prt::pixel_receivers(
            mesh, rays, {.camera = camera, .width = 64, .height = 48, .samples_per_axis = n});
        std::vector<glm::vec3> radiance;
        for (const prt::MeshPoint& point : pixels.receivers.points)
            radiance.push_back(prt::value_at(mesh, colors, point));
        const Picture composed = compose(pixels.layout, radiance, map_backdrop(sky));
        const Picture drawn =
            PictureView(mesh, rays, camera, {.width = 64, .height = 48, .samples_per_axis = n})
                .draw({.radiance = colors}, map_backdrop(sky));
        ASSERT_EQ(composed.pixels.size(), drawn.pixels.size());
        EXPECT_TRUE(composed.alpha.empty());
        // Samples beside an edge may lie in either triangle.
        for (std::size_t i = 0; i < drawn.pixels.size(); ++i)
            EXPECT_LT(difference(composed.pixels[i], drawn.pixels[i]), 1e-4f) << i;

        // Cut out and laid over the background alone, it is the same picture.
        const Picture cut_out = compose_cut_out(pixels.layout, radiance);
        const Picture empty = compose(prt::PixelLayout{.camera = camera, .width = 64, .height = 48},
                                      {}, map_backdrop(sky));
        for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
            const float alpha = cut_out.alpha[i];
            if (alpha == 1.0f || alpha == 0.0f) {
                const glm::vec3 over = cut_out.pixels[i] + (1.0f - alpha) * empty.pixels[i];
                EXPECT_LT(difference(over, drawn.pixels[i]), n == 1 ? 1e-4f : 1e-2f) << i;
            }
        }
    }
}

TEST(ReceiverPicture, APixelIsTheMeanOfItsSamples) {
    // Two pixels of four samples; the second has one receiver, the first three.
    const prt::PixelLayout layout{.camera = {.eye = {0, 0, 1}},
                                  .width = 2,
                                  .height = 1,
                                  .samples_per_axis = 2,
                                  .samples = {0, 1, 3, 6}};
    const std::vector<glm::vec3> radiance = {glm::vec3(1), glm::vec3(2), glm::vec3(3),
                                             glm::vec3(8)};
    const Backdrop grey = plain_backdrop(glm::vec3(0.5f));
    const Picture picture = compose(layout, radiance, grey);
    EXPECT_LT(difference(picture.pixels[0], glm::vec3(6.5f / 4.0f)), 1e-6f);
    EXPECT_LT(difference(picture.pixels[1], glm::vec3(9.5f / 4.0f)), 1e-6f);
    const Picture cut_out = compose_cut_out(layout, radiance);
    EXPECT_EQ(cut_out.alpha, (std::vector<float>{0.75f, 0.25f}));
    EXPECT_EQ(cut_out.pixels[0], glm::vec3(1.5f));
    EXPECT_EQ(cut_out.pixels[1], glm::vec3(2.0f));
    // A receiver that is half transparent shows half of what is behind it.
    const std::vector<glm::vec3> opacity = {glm::vec3(1.0f), glm::vec3(0.5f), glm::vec3(1.0f),
                                            glm::vec3(0.0f)};
    EXPECT_LT(difference(compose(layout, radiance, grey, opacity).pixels[0],
                         glm::vec3((1.0f + 1.0f + 0.25f + 0.5f + 3.0f) / 4.0f)),
              1e-6f);
    EXPECT_EQ(compose_cut_out(layout, radiance, opacity).alpha, (std::vector<float>{0.625f, 0.0f}));
    EXPECT_THROW(static_cast<void>(compose(layout, std::span(radiance).first(3), grey)),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(compose(layout, radiance, grey, std::span(opacity).first(3))),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(compose_cut_out(layout, {})), std::invalid_argument);
}

/// A box whose faces differ, seen from a corner, with and without its far side showing through.
mesh::TriangleMesh box_of_six_materials(bool is_thin) {
    mesh::TriangleMesh box = scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f));
    const mesh::Material material =
        is_thin ? mesh::Material{.alpha_mode = mesh::AlphaMode::Blend, .alpha = 0.25f}
                : mesh::Material{};
    box.materials.assign(6, material);
    for (std::uint32_t i = 0; i < box.num_triangles(); ++i) {
        const glm::vec3 normal = prt::face_normal(box, i);
        const glm::vec3 side = glm::abs(normal);
        const std::uint32_t axis = side.x > 0.5f ? 0u : side.y > 0.5f ? 1u : 2u;
        box.triangle_materials.push_back(2 * axis + (normal[static_cast<int>(axis)] > 0 ? 1u : 0u));
    }
    return box;
}

TEST(ReceiverPicture, ReceiversOfEdgesShowWhatEachSampleWouldShow) {
    const Backdrop grey = plain_backdrop(glm::vec3(0.5f));
    const Camera camera{.eye = {3.1f, 2.2f, 4.3f}, .fov_degrees = 50.0f};
    for (const bool is_thin : {false, true}) {
        const mesh::TriangleMesh mesh = box_of_six_materials(is_thin);
        const prt::RayScene rays(mesh);
        const auto seen = [&](std::optional<std::uint32_t> n) {
            return prt::pixel_receivers(
                mesh, rays, {.camera = camera, .width = 40, .height = 30, .samples_per_axis = n});
        };
        const auto radiance = [&](const prt::PixelReceivers& pixels) {
            std::vector<glm::vec3> result;
            for (const prt::MeshPoint& point : pixels.receivers.points) {
                const auto face = static_cast<float>(mesh.triangle_materials[point.triangle]);
                result.emplace_back(1.0f + face, 7.0f - face, 0.5f * face);
            }
            return result;
        };
        const prt::PixelReceivers all = seen(4), few = seen({});
        EXPECT_TRUE(all.layout.shares.empty());
        ASSERT_EQ(few.layout.shares.size(), few.receivers.size());
        EXPECT_TRUE(few.layout.have_shares_that_fit());
        EXPECT_LT(few.receivers.size(), all.receivers.size() / 6);
        EXPECT_EQ(prt::num_places_taken(few.layout), prt::num_places_taken(all.layout));
        const Picture expected = compose(all.layout, radiance(all), grey, {}, all.receivers.veils);
        const Picture picture = compose(few.layout, radiance(few), grey, {}, few.receivers.veils);
        for (std::size_t i = 0; i < picture.pixels.size(); ++i)
            EXPECT_LT(difference(picture.pixels[i], expected.pixels[i]), 1e-5f) << i;

        // The transpose: <weights, picture> = <transpose, radiance>.
        std::mt19937 random(5);
        std::vector<glm::vec3> weights;
        for (std::size_t i = 0; i < picture.pixels.size(); ++i)
            weights.push_back(scenes::random_direction(random));
        const Picture cut_out = compose_cut_out(few.layout, radiance(few), {}, few.receivers.veils);
        const std::vector<glm::vec3> back =
            cut_out_transpose(few.layout, weights, few.receivers.veils);
        double left = 0.0, right = 0.0;
        for (std::size_t i = 0; i < weights.size(); ++i)
            left += static_cast<double>(glm::dot(weights[i], cut_out.pixels[i]));
        for (std::size_t i = 0; i < back.size(); ++i)
            right += static_cast<double>(glm::dot(back[i], radiance(few)[i]));
        EXPECT_NEAR(left, right, 1e-3);
    }
}

/// A floor of 9 x 9 vertices a unit apart, with a wall beside it. No texel's centre lies behind the
/// wall's very edge, as seen from a vertex.
mesh::TriangleMesh floor_and_wall() {
    mesh::TriangleMesh wall;
    wall.positions = {{5, 0, -4.13f}, {5, 0, 4.17f}, {5, 3.91f, -4.13f}, {5, 3.91f, 4.17f}};
    wall.normals.assign(4, glm::vec3(-1, 0, 0));
    wall.triangles = {{0, 1, 3}, {0, 3, 2}};
    return scenes::joined(scenes::floor_grid(9, 8.0f), wall);
}

TEST(ReceiverPicture, PixelsOnVerticesAreLitAsTheVertices) {
    const mesh::TriangleMesh mesh = floor_and_wall();
    const prt::RayScene rays(mesh);
    // From above, nine pixels a side, a unit each: all their centres are vertices.
    const float fov = 2.0f * std::atan(4.5f / 20.0f) * 180.0f / std::numbers::pi_v<float>;
    const prt::PixelReceivers pixels = prt::pixel_receivers(
        mesh, rays, {.camera = {.eye = {0, 20, 0}, .fov_degrees = fov}, .width = 9, .height = 9});
    const cubemap::CubeMap sky = scenes::smooth_environment(16);
    const ExactOptions exact{.bias = prt::automatic_bias(mesh)};
    // On the rim, vertices would look from a little inside.
    const prt::Receivers vertices{.positions = mesh.positions, .normals = mesh.normals};
    const std::vector<glm::dvec3> of_vertices =
        exact_radiance(vertices, all_of(vertices), rays, sky, exact);
    const std::vector<glm::dvec3> of_pixels =
        exact_radiance(pixels.receivers, all_of(pixels.receivers), rays, sky, exact);
    const prt::PrecomputeOptions options{
        .tolerance = 0.005f, .face_resolution = 64, .bias = exact.bias};
    const std::vector<glm::vec3> relit_vertices =
        relight(prt::precompute(vertices, rays, options), sky);
    const std::vector<glm::vec3> relit_pixels =
        relight(prt::precompute(pixels.receivers, rays, options), sky);
    std::size_t num_compared = 0;
    for (std::size_t i = 0; i < pixels.receivers.size(); ++i)
        for (std::size_t v = 0; v < 81; ++v)
            if (glm::length(pixels.receivers.positions[i] - mesh.positions[v]) < 1e-3f) {
                ++num_compared;
                EXPECT_LT(glm::length(of_pixels[i] - of_vertices[v]),
                          1e-2 * glm::length(of_vertices[v]))
                    << v;
                EXPECT_LT(glm::length(relit_pixels[i] - relit_vertices[v]),
                          0.02f * glm::length(relit_vertices[v]))
                    << v;
            }
    EXPECT_GE(num_compared, 49u); // those on the floor's border may be missed
}

TEST(ReceiverPicture, RelitSphereEqualsTheDrawnOne) {
    const mesh::TriangleMesh sphere = scenes::icosphere(4, 1.0f, glm::vec3(0.0f));
    const prt::RayScene rays(sphere);
    const prt::PrecomputeOptions options{
        .tolerance = 0.01f, .face_resolution = 64, .bias = prt::automatic_bias(sphere)};
    const cubemap::CubeMap sky = scenes::smooth_environment(16);
    const Camera camera{.eye = {1.0f, 2.0f, 4.0f}};
    const prt::PixelReceivers pixels =
        prt::pixel_receivers(sphere, rays, {.camera = camera, .width = 40, .height = 40});
    const Picture composed =
        compose(pixels.layout, relight(prt::precompute(pixels.receivers, rays, options), sky),
                map_backdrop(sky));
    const std::vector<glm::vec3> of_vertices =
        relight(prt::precompute(prt::vertex_receivers(sphere), rays, options), sky);
    const Picture drawn =
        PictureView(sphere, rays, camera, {.width = 40, .height = 40, .samples_per_axis = 1})
            .draw({.radiance = of_vertices}, map_backdrop(sky));
    double error = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
        const glm::vec3 d = composed.pixels[i] - drawn.pixels[i];
        error += static_cast<double>(glm::dot(d, d));
        sum += static_cast<double>(glm::dot(drawn.pixels[i], drawn.pixels[i]));
    }
    EXPECT_LT(std::sqrt(error / sum), 0.01);
}

TEST(ReceiverPicture, ALightmapHoldsTheExactIrradiance) {
    mesh::TriangleMesh mesh = floor_and_wall();
    for (const glm::vec3& p : mesh.positions)
        mesh.uvs.emplace_back(0.1f * p.x + 0.5f, 0.5f - 0.1f * p.z);
    for (std::size_t i = 81; i < 85; ++i)
        mesh.uvs[i] = glm::vec2(0.0f); // the wall only casts its shadow
    const prt::RayScene rays(mesh);
    const prt::TexelReceivers texels = prt::texel_receivers(mesh, {.width = 20, .height = 20});
    EXPECT_EQ(texels.receivers.size(), 16u * 16u);
    const cubemap::CubeMap sky = scenes::smooth_environment(32);
    const float bias = prt::automatic_bias(mesh);
    const Picture lightmap = compose(
        texels.layout,
        relight(prt::precompute(texels.receivers, rays,
                                {.tolerance = 0.005f, .face_resolution = 128, .bias = bias}),
                sky),
        2);
    prt::Receivers places;
    std::vector<std::size_t> pixels;
    for (std::uint32_t y = 2; y < 18; ++y)
        for (std::uint32_t x = 2; x < 18; ++x) {
            places.positions.emplace_back((static_cast<float>(x) + 0.5f) * 0.5f - 5.0f, 0.0f,
                                          (static_cast<float>(y) + 0.5f) * 0.5f - 5.0f);
            places.normals.emplace_back(0.0f, 1.0f, 0.0f);
            pixels.push_back(std::size_t{y} * 20 + x);
        }
    const std::vector<glm::dvec3> exact =
        exact_radiance(places, all_of(places), rays, sky, {.bias = bias});
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        EXPECT_EQ(lightmap.alpha[pixels[i]], 1.0f);
        EXPECT_LT(glm::length(glm::dvec3(lightmap.pixels[pixels[i]]) - exact[i]),
                  0.02 * glm::length(exact[i]))
            << i;
    }
    // The gutter reaches the atlas's border here, and only alpha tells it from the chart.
    EXPECT_EQ(lightmap.alpha[0], 0.0f);
    EXPECT_GT(lightmap.pixels[0].g, 0.0f);
}

TEST(ReceiverPicture, TheGutterGrowsRingByRing) {
    const prt::TexelLayout layout{.width = 7, .height = 5, .texels = {2 * 7 + 1, 2 * 7 + 6}};
    const std::vector<glm::vec3> radiance = {{1, 0, 0}, {0, 4, 0}};
    const Picture none = compose(layout, radiance, 0);
    for (std::uint32_t i = 0; i < 35; ++i) {
        const bool chart = i == 15 || i == 20;
        EXPECT_EQ(none.alpha[i], chart ? 1.0f : 0.0f);
        EXPECT_EQ(none.pixels[i] != glm::vec3(0.0f), chart);
    }
    const Picture two = compose(layout, radiance, 2);
    const auto at = [&](std::uint32_t x, std::uint32_t y) {
        return two.pixels[std::size_t{y} * 7 + x];
    };
    EXPECT_EQ(at(0, 1), glm::vec3(1, 0, 0));
    EXPECT_EQ(at(3, 0), glm::vec3(1, 0, 0));
    EXPECT_EQ(at(5, 3), glm::vec3(0, 4, 0));
    EXPECT_EQ(at(4, 4), glm::vec3(0, 4, 0));
    EXPECT_EQ(at(1, 2), glm::vec3(1, 0, 0));
    EXPECT_EQ(two.alpha, none.alpha);
    const Picture much = compose(layout, radiance, 10000);
    for (const glm::vec3& pixel : much.pixels)
        EXPECT_NE(pixel, glm::vec3(0.0f));
    EXPECT_THROW(static_cast<void>(compose(layout, {})), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
