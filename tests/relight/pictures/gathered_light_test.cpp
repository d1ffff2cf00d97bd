#include "relight/pictures/gathered_light.h"

#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "prt/receivers/mesh_point.h"

namespace relumine::relight {
namespace {

constexpr std::uint32_t Width = 90, Height = 70;

/// A floor from x = 0 on, and at x = 0 a wall of height 1 that is long enough to be endless.
mesh::TriangleMesh floor_and_wall() {
    mesh::TriangleMesh mesh;
    mesh.positions = {{0.0f, 0.0f, -2.0f}, {0.0f, 0.0f, 2.0f},   {3.0f, 0.0f, 2.0f},
                      {3.0f, 0.0f, -2.0f}, {0.0f, 0.0f, -90.0f}, {0.0f, 1.0f, -90.0f},
                      {0.0f, 1.0f, 90.0f}, {0.0f, 0.0f, 90.0f}};
    mesh.normals.assign(4, {0.0f, 1.0f, 0.0f});
    mesh.normals.resize(8, {1.0f, 0.0f, 0.0f});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    return mesh;
}

/// The part of a floor's light that comes from the wall, by its form factor.
float of_wall(float x) {
    return 0.5f * (1.0f - x / std::sqrt(x * x + 1.0f));
}

/// What is gathered of a wall of radiance 1 and a sky at the floor that pixels show.
struct Gathered {
    std::vector<glm::vec3> positions, light;
};

Gathered gathered(const glm::vec3& sky_radiance, const glm::vec3& replaced) {
    const mesh::TriangleMesh mesh = floor_and_wall();
    const prt::RayScene rays(mesh);
    const prt::Camera camera{.eye = {2.5f, 2.0f, 0.3f}, .target = {1.0f, 0.0f, 0.0f}};
    const prt::PictureRays grid(camera, Width, Height, 1);
    const FadingFloor floor;
    const SeenMesh seen(mesh, rays, floor, camera.eye);
    const prt::TwinTriangles twins(mesh);
    std::vector<glm::vec3> sent(4, glm::vec3(0.0f));
    sent.resize(8, glm::vec3(1.0f));
    const std::vector<glm::vec3> of_vertices(8, replaced);
    cubemap::CubeMap map(2);
    map.texels.assign(map.texels.size(), sky_radiance);
    const Reflections sky(rays, 0.0f, 0, map, {});
    const MeshLight light{
        .radiance = sent, .sent = sent, .replaced = of_vertices, .sky = &sky, .bias = 1e-4f};
    const GatheredLight all({mesh, rays, seen, twins, floor, camera.eye, grid, Width, Height},
                            light, {});
    Gathered result;
    for (std::uint32_t y = 0; y < Height; ++y)
        for (std::uint32_t x = 0; x < Width; ++x) {
            const auto hit = rays.closest_hit(camera.eye, grid.direction(x, y, 0));
            if (!hit || hit->triangle > 1)
                continue;
            const prt::MeshPoint at{hit->triangle, hit->barycentric};
            result.positions.push_back(prt::value_at(mesh, mesh.positions, at));
            result.light.push_back(all.change(x, y, at));
        }
    return result;
}

TEST(GatheredLight, IsTheFormFactorOfAWallAndTheRestOfTheSky) {
    const glm::vec3 sky(0.0f, 0.5f, 2.0f);
    const Gathered found = gathered(sky, glm::vec3(0.0f));
    ASSERT_GT(found.light.size(), Width * Height / 2);
    double squares = 0.0;
    for (std::size_t i = 0; i < found.light.size(); ++i) {
        const float wall = of_wall(found.positions[i].x);
        const glm::vec3 expected = wall + (1.0f - wall) * sky;
        // Closer to the wall than records lie, they are averaged.
        if (found.positions[i].x < 0.15f)
            continue;
        const glm::vec3 error = (found.light[i] - expected) / (0.1f + expected);
        squares += glm::dot(error, error) / 3.0;
        EXPECT_LT(glm::length(error), 0.1f) << found.positions[i].x;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(found.light.size())), 0.012);
}

TEST(GatheredLight, TakesThePlaceOfTheVertices) {
    const Gathered found = gathered(glm::vec3(1.0f), glm::vec3(0.25f));
    double mean = 0.0;
    for (const glm::vec3& change : found.light)
        mean += change.r / static_cast<double>(found.light.size());
    EXPECT_NEAR(mean, 0.75, 0.002) << "wall and sky have radiance 1";
}

TEST(GatheredLight, IsTheSameForAnyNumberOfThreads) {
    const Gathered all = gathered(glm::vec3(1.0f, 2.0f, 3.0f), glm::vec3(0.0f));
    tbb::task_arena(1).execute([&] {
        EXPECT_EQ(gathered(glm::vec3(1.0f, 2.0f, 3.0f), glm::vec3(0.0f)).light, all.light);
    });
}

} // namespace
} // namespace relumine::relight
