#include "relight/pictures/eye_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "mesh/floor.h"
#include "tests/prt/scenes.h"

namespace relumine::relight {
namespace {

/// What ray by ray finds, and how far the samples of all tiles differ from it.
struct Difference {
    std::size_t num_hits = 0, num_others = 0;
    float farthest = 0.0f;
};

/// `ring` pixels around each tile are looked at, too.
Difference difference_from_rays(const mesh::TriangleMesh& mesh, const prt::Camera& camera,
                                std::uint32_t ring, std::size_t max_bytes = 0) {
    const prt::RayScene rays(mesh);
    const PictureTiles tiles{.width = 70, .height = 45};
    const prt::PictureRays grid(camera, tiles.width, tiles.height, 3);
    const SeenMesh seen_mesh(mesh, rays, {}, camera.eye);
    const EyeSamples samples(seen_mesh, rays, camera.eye, grid, tiles, max_bytes, {});
    Difference difference;
    for (std::uint32_t tile = 0; tile < tiles.count(); ++tile) {
        const SampleRectangle seen = samples.of(tile, ring);
        for (std::uint32_t y = seen.pixels().top; y < seen.pixels().bottom; ++y)
            for (std::uint32_t x = seen.pixels().left; x < seen.pixels().right; ++x)
                for (std::uint32_t i = 0; i < 9; ++i) {
                    const EyeSample& found = seen.pixel(x, y)[i];
                    const std::optional<prt::Hit> hit =
                        rays.closest_hit(camera.eye, grid.direction(x, y, i), prt::RayOf::Eye);
                    difference.num_hits += hit ? 1 : 0;
                    if (hit.has_value() != found.hits()) {
                        ++difference.num_others;
                        continue;
                    }
                    if (!hit)
                        continue;
                    // Neighbours share their edges: the place counts.
                    const glm::vec3 at =
                        prt::value_at(mesh, mesh.positions,
                                      {.triangle = hit->triangle, .barycentric = hit->barycentric});
                    const float distance =
                        glm::distance(at, prt::value_at(mesh, mesh.positions, found.point()));
                    if (distance > 1e-3f * glm::distance(at, camera.eye))
                        ++difference.num_others;
                    else
                        difference.farthest = std::max(difference.farthest, distance);
                }
    }
    return difference;
}

const prt::Camera Above{
    .eye = {2.5f, 2.0f, 3.5f}, .target = {0.0f, 0.4f, 0.0f}, .fov_degrees = 40.0f};

TEST(EyeSamples, SeeWhatRaysSee) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    for (const std::uint32_t ring : {0u, 1u, PictureTiles::LargestRing}) {
        const Difference difference = difference_from_rays(mesh, Above, ring);
        EXPECT_GT(difference.num_hits, 10'000u);
        EXPECT_LE(difference.num_others, difference.num_hits / 5'000) << ring;
        EXPECT_LT(difference.farthest, 2e-3f);
    }
    EXPECT_LE(difference_from_rays(mesh, Above, 0, 1u << 30).num_others, 10u);
}

TEST(EyeSamples, SeeTrianglesThatReachBehindTheEye) {
    // Walls all around and a floor below: most triangles cross the plane of the eye.
    const mesh::TriangleMesh mesh =
        scenes::joined(scenes::box({-3, -1, -2}, {5, 2, 6}), scenes::triangle_soup(400, 7));
    const prt::Camera inside{
        .eye = {0.3f, 0.2f, 0.1f}, .target = {1.0f, 0.0f, 2.0f}, .fov_degrees = 95};
    const Difference difference = difference_from_rays(mesh, inside, 1);
    EXPECT_GT(difference.num_hits, 28'000u); // the box is closed
    EXPECT_LE(difference.num_others, difference.num_hits / 1'000);
}

TEST(EyeSamples, LeaveNoHolesBetweenTriangles) {
    // From its middle, a sphere is seen in all directions.
    const mesh::TriangleMesh mesh = scenes::icosphere(4, 1.0f, glm::vec3(0.0f));
    const prt::Camera inside{
        .eye = {0.01f, 0.02f, 0.0f}, .target = {1, 0.2f, 0.3f}, .fov_degrees = 90};
    const Difference difference = difference_from_rays(mesh, inside, 0);
    EXPECT_EQ(difference.num_hits, 70u * 45u * 9u);
    EXPECT_EQ(difference.num_others, 0u);
}

TEST(EyeSamples, PassBacksOfSingleSidedTriangles) {
    mesh::TriangleMesh mesh = scenes::joined(scenes::box({-1, -1, -1}, {1, 1, 1}),
                                             scenes::icosphere(2, 0.5f, glm::vec3(0.0f)));
    mesh.materials.resize(2);
    mesh.materials[0].is_double_sided = false;
    mesh.triangle_materials.assign(mesh.num_triangles(), 1);
    std::fill_n(mesh.triangle_materials.begin(), 12, 0u);
    // From inside of the box its walls are not seen, but for the sphere.
    const prt::Camera inside{.eye = {0.0f, 0.0f, 0.9f}, .target = {0, 0, 0}, .fov_degrees = 60};
    const Difference difference = difference_from_rays(mesh, inside, 0);
    EXPECT_GT(difference.num_hits, 3'000u);
    EXPECT_LT(difference.num_hits, 25'000u);
    EXPECT_LE(difference.num_others, 3u);
}

TEST(EyeSamples, SeeTheFrontOfSurfacesThatAreThereTwice) {
    mesh::TriangleMesh mesh = scenes::floor_grid(9, 2.0f);
    mesh::TriangleMesh below = mesh;
    for (mesh::Triangle& triangle : below.triangles)
        std::swap(triangle[1], triangle[2]);
    mesh = scenes::joined(below, mesh);
    const prt::RayScene rays(mesh);
    const PictureTiles tiles{.width = 40, .height = 30};
    const prt::PictureRays grid(Above, tiles.width, tiles.height, 2);
    const SeenMesh seen_mesh(mesh, rays, {}, Above.eye);
    const EyeSamples samples(seen_mesh, rays, Above.eye, grid, tiles, 0, {});
    std::size_t num_hits = 0;
    for (std::uint32_t tile = 0; tile < tiles.count(); ++tile) {
        const SampleRectangle seen = samples.of(tile, 0);
        for (std::uint32_t y = seen.pixels().top; y < seen.pixels().bottom; ++y)
            for (std::uint32_t x = seen.pixels().left; x < seen.pixels().right; ++x)
                for (const EyeSample& sample : seen.pixel(x, y))
                    if (sample.hits()) {
                        ++num_hits;
                        EXPECT_GT(prt::face_normal(mesh, sample.triangle).y, 0.0f);
                    }
    }
    EXPECT_GT(num_hits, 500u);
}

/// What the samples of a picture of 70 x 45 pixels see.
std::vector<EyeSample> seen_samples(const mesh::TriangleMesh& mesh, const prt::Camera& camera,
                                    const FadingFloor& floor) {
    const prt::RayScene rays(mesh);
    const PictureTiles tiles{.width = 70, .height = 45};
    const prt::PictureRays grid(camera, tiles.width, tiles.height, 3);
    const SeenMesh seen_mesh(mesh, rays, floor, camera.eye);
    const EyeSamples samples(seen_mesh, rays, camera.eye, grid, tiles, 0, {});
    std::vector<EyeSample> result;
    for (std::uint32_t tile = 0; tile < tiles.count(); ++tile) {
        const SampleRectangle seen = samples.of(tile, 0);
        for (std::uint32_t y = seen.pixels().top; y < seen.pixels().bottom; ++y)
            for (std::uint32_t x = seen.pixels().left; x < seen.pixels().right; ++x)
                for (const EyeSample& sample : seen.pixel(x, y))
                    if (sample.hits())
                        result.push_back(sample);
    }
    return result;
}

TEST(EyeSamples, OfSurfacesInOnePlaneTheFirstIsSeenEverywhere) {
    mesh::TriangleMesh mesh =
        scenes::joined(scenes::floor_grid(29, 3.0f), scenes::floor_grid(7, 1.7f));
    const glm::vec3 slope(0.13f, 0.0f, 0.29f);
    for (glm::vec3& at : mesh.positions)
        at.y += glm::dot(slope, at);
    const auto of_second = [&](const mesh::TriangleMesh& of, std::uint32_t first) {
        const std::vector<EyeSample> seen = seen_samples(of, Above, {});
        EXPECT_GT(seen.size(), 1000u);
        return std::count_if(seen.begin(), seen.end(),
                             [&](const EyeSample& sample) { return sample.triangle >= first; });
    };
    EXPECT_EQ(of_second(mesh, 2 * 28 * 28), 0);
    // The order of the triangles decides, not their size.
    mesh = scenes::joined(scenes::floor_grid(7, 1.7f), scenes::floor_grid(29, 3.0f));
    const auto num_open = of_second(mesh, 2 * 6 * 6);
    mesh = scenes::joined(scenes::floor_grid(7, 1.7f, 1e-4f), scenes::floor_grid(29, 3.0f));
    EXPECT_EQ(of_second(mesh, 2 * 6 * 6), num_open);
}

TEST(EyeSamples, NoGapIsSeenBetweenABoxAndItsFloor) {
    mesh::TriangleMesh mesh = scenes::box({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f});
    mesh::append_floor(mesh, 25);
    const FadingFloor with_gap{.first_vertex = 8},
        without{.first_vertex = 8, .gap = mesh::floor_gap(mesh, 8)};
    ASSERT_GT(without.gap, 0.0f);
    const prt::Camera near{
        .eye = {0.9f, 0.05f, 1.1f}, .target = {0.0f, 0.0f, 0.4f}, .fov_degrees = 8.0f};
    const auto num_under = [&](const FadingFloor& floor) {
        const std::vector<EyeSample> seen = seen_samples(mesh, near, floor);
        return std::count_if(seen.begin(), seen.end(), [&](const EyeSample& sample) {
            const glm::vec3 at = prt::value_at(mesh, mesh.positions, sample.point());
            return mesh.triangles[sample.triangle][0] >= 8 &&
                   std::max(std::abs(at.x), std::abs(at.z)) < 0.499f;
        });
    };
    EXPECT_GT(num_under(with_gap), 0);
    EXPECT_EQ(num_under(without), 0);
}

} // namespace
} // namespace relumine::relight
