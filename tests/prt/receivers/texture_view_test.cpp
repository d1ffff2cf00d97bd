#include "prt/receivers/texture_view.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/textured_square.h"

namespace relumine::prt {
namespace {

/// The square is 2 wide. At distance 4 and a field of view of 2 atan(1/4), it fills the picture.
constexpr float Fov = 28.072487f;

TEST(TextureView, FootprintsOfASquareThatFillsThePicture) {
    const mesh::TriangleMesh mesh = scenes::textured_square();
    const mesh::MipMaps maps(mesh.textures);
    const Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = Fov};
    const TextureView view(maps, camera.eye, PictureRays(camera, 10, 10, 2));
    for (const MeshPoint& at : {MeshPoint{.triangle = 0, .barycentric = {0.2f, 0.7f}},
                                MeshPoint{.triangle = 1, .barycentric = {0.1f, 0.1f}}}) {
        const mesh::Footprint step = view.footprint(mesh, at, 0);
        EXPECT_NEAR(step.right.x, 0.05f, 1e-5f) << "two samples a pixel, ten pixels";
        EXPECT_NEAR(step.right.y, 0.0f, 1e-6f);
        EXPECT_NEAR(step.down.x, 0.0f, 1e-6f);
        EXPECT_NEAR(step.down.y, -0.05f, 1e-5f);
    }
    EXPECT_EQ(view.footprint(mesh, {.triangle = 0, .barycentric = {0.2f, 0.7f}}, 1).right,
              glm::vec2(0.0f))
        << "no second uvs";
}

/// The footprint is where the neighbours' rays meet the plane, to the first order.
TEST(TextureView, FootprintsOfATiltedPlane) {
    const mesh::TriangleMesh mesh = scenes::textured_square();
    const mesh::MipMaps maps(mesh.textures);
    const Camera camera{.eye = {0.5f, -3, 1}, .target = {0, 0, 0}, .fov_degrees = 20};
    const PictureRays rays(camera, 1000, 1000, 1);
    const TextureView view(maps, camera.eye, rays);
    const auto uv = [&](std::uint32_t x, std::uint32_t y) {
        const glm::vec3 direction = rays.direction(x, y, 0);
        const glm::vec3 hit = camera.eye - camera.eye.z / direction.z * direction;
        return glm::vec2(0.5f + 0.5f * hit.x, 0.5f + 0.5f * hit.y);
    };
    const glm::vec2 middle = uv(500, 500);
    // In the first triangle, (0, 0), (1, 0), (1, 1) in uv.
    const MeshPoint at{.triangle = 0, .barycentric = {middle.x - middle.y, middle.y}};
    const mesh::Footprint step = view.footprint(mesh, at, 0);
    const glm::vec2 right = uv(501, 500) - middle, down = uv(500, 501) - middle;
    EXPECT_LT(glm::distance(step.right, right), 0.01f * glm::length(right));
    EXPECT_LT(glm::distance(step.down, down), 0.01f * glm::length(down));
    // Behind the eye, and a triangle that the eye lies in the plane of.
    const Camera away{.eye = {0, -3, 1}, .target = {0, -6, 1}},
        flat{.eye = {0, -3, 0}, .target = {}};
    for (const Camera& from : {away, flat})
        EXPECT_EQ(
            TextureView(maps, from.eye, PictureRays(from, 10, 10, 1)).footprint(mesh, at, 0).right,
            glm::vec2(0.0f));
}

/// Normals that turn evenly vary by a twelfth of the square of all their turn.
TEST(TextureView, NormalsOfABentSurfaceDifferWithinAPixel) {
    mesh::TriangleMesh square = scenes::textured_square();
    const Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = Fov};
    const MeshPoint at{.triangle = 0, .barycentric = {0.4f, 0.3f}};
    const auto spread = [&](std::uint32_t size, std::uint32_t samples) {
        return TextureView(camera.eye, PictureRays(camera, size, size, samples))
            .normal_spread(square, at);
    };
    EXPECT_EQ(spread(10, 3), 0.0f) << "it is flat";
    constexpr float Bend = 0.1f; // of the normal, over a length of 1
    for (std::size_t i = 0; i < square.num_vertices(); ++i)
        square.normals[i] = glm::vec3(Bend * square.positions[i].x, 0.0f, 1.0f);
    const auto turn = [](std::uint32_t along) { // of places in the picture
        return Bend * 2.0f / static_cast<float>(along);
    };
    const float of_pixel = turn(100) * turn(100) / 12.0f;
    EXPECT_NEAR(spread(100, 3), of_pixel, 1e-3f * of_pixel) << "samples share the pixel's rays";
    const float of_sample = turn(6) * turn(6) / 12.0f;
    EXPECT_NEAR(spread(2, 3), of_sample, 1e-3f * of_sample) << "each sample has its own";
}

TEST(SeenNormal, IsTheMeanOfTheMapAndHowMuchItDiffers) {
    const mesh::TriangleMesh square = scenes::striped_square();
    const mesh::MipMaps maps(square.textures);
    const Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = Fov};
    const MeshPoint at{.triangle = 0, .barycentric = {0.2f, 0.7f}};
    const MappedNormal there = seen_normal(square, at, nullptr);
    EXPECT_EQ(there.direction, mapped_normal(square, at));
    EXPECT_EQ(there.spread, 0.0f);
    const TextureView near(maps, camera.eye, PictureRays(camera, 1000, 1000, 2));
    EXPECT_LT(glm::distance(seen_normal(square, at, &near).direction, there.direction), 1e-5f);
    EXPECT_EQ(seen_normal(square, at, &near).spread, 0.0f);
    // Three stripes a sample
    const TextureView far(maps, camera.eye, PictureRays(camera, 10, 10, 2));
    const MappedNormal mean = seen_normal(square, at, &far);
    EXPECT_LT(glm::distance(mean.direction, glm::vec3(0, 0, 1)), 1e-3f);
    EXPECT_NEAR(mean.spread, 0.5f, 1e-3f) << "they differ by 45 degrees from their mean";
    const mesh::TriangleMesh flat = scenes::mapped_square({127, 128, 255});
    const mesh::MipMaps of_flat(flat.textures);
    const TextureView of_all(of_flat, camera.eye, PictureRays(camera, 1, 1, 1));
    EXPECT_EQ(seen_normal(flat, at, &of_all).direction, glm::vec3(0, 0, 1));
    EXPECT_EQ(seen_normal(flat, at, &of_all).spread, 0.0f);
}

} // namespace
} // namespace relumine::prt
