// The building blocks: icosphere, lathe, box, grids, noise.
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "data_gen/icosphere.h"
#include "data_gen/lathe.h"
#include "data_gen/noise.h"
#include "data_gen/shapes.h"
#include "mesh_checks.h"

namespace relumine::data_gen {
namespace {

TEST(IcosphereTest, IsClosedAndEven) {
    for (const std::uint32_t frequency : {1u, 2u, 3u, 4u, 7u, 30u}) {
        const mesh::TriangleMesh sphere = icosphere(frequency);
        const std::size_t squared = std::size_t{frequency} * frequency;
        EXPECT_EQ(sphere.num_vertices(), 10 * squared + 2);
        EXPECT_EQ(sphere.num_triangles(), 20 * squared);
        EXPECT_EQ(num_open_edges(sphere), 0u);
        double shortest = 10.0;
        double longest = 0.0;
        for (const mesh::Triangle& t : sphere.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                const double length =
                    glm::distance(sphere.positions[t[k]], sphere.positions[t[(k + 1) % 3]]);
                shortest = std::min(shortest, length);
                longest = std::max(longest, length);
            }
        }
        EXPECT_LT(longest, 1.6 * shortest) << frequency;
    }
    EXPECT_NEAR(volumes(icosphere(60)).at(0), 4.0 / 3.0 * std::numbers::pi, 0.002);
    EXPECT_THROW((void)icosphere(0), std::invalid_argument);
}

TEST(IcosphereTest, FrequencyForACount) {
    EXPECT_EQ(icosphere_frequency(0), 1u);
    EXPECT_EQ(icosphere_frequency(12), 1u);
    EXPECT_EQ(icosphere_frequency(42), 2u);
    EXPECT_EQ(icosphere_frequency(10 * 250'000 + 2), 500u);
}

TEST(BoxTest, IsClosedWithSharpEdges) {
    mesh::TriangleMesh box;
    append_box(box, {-0.3, 0.1, -0.7}, {0.4, 0.77, 0.9}, 0.1);
    EXPECT_EQ(num_open_edges(box), 0u);
    EXPECT_NEAR(volumes(box).at(0), 0.7 * 0.67 * 1.6, 1e-6);
    EXPECT_NEAR(area(box), 2.0 * (0.7 * 0.67 + 0.67 * 1.6 + 0.7 * 1.6), 1e-6);
}

TEST(BoxTest, CopiesAreTurnedFromZTowardsX) {
    mesh::TriangleMesh box;
    append_box(box, {0.0, 0.0, 1.0}, {0.1, 0.1, 2.0}, 1.0);
    mesh::TriangleMesh copy;
    append_copy(copy, box, std::numbers::pi / 2.0, {10.0, 0.0, 0.0});
    const mesh::Bounds bounds = mesh::bounds(copy);
    EXPECT_NEAR(bounds.min.x, 11.0f, 1e-5f);
    EXPECT_NEAR(bounds.max.x, 12.0f, 1e-5f);
    EXPECT_NEAR(bounds.min.z, -0.1f, 1e-5f);
    EXPECT_NEAR(volumes(copy).at(0), volumes(box).at(0), 1e-6);
}

mesh::TriangleMesh cylinder(std::uint32_t num_around, const Flutes& flutes, Fill fill) {
    mesh::TriangleMesh mesh;
    append_disc(mesh, {.radius = 0.5, .num_around = num_around, .facing = Facing::Down});
    append_lathe(mesh, {line({0.5, 0.0}, {0.5, 3.0}, 0.05)}, num_around, flutes);
    append_disc(mesh, {.radius = 0.5, .height = 3.0, .num_around = num_around, .fill = fill});
    return mesh;
}

TEST(LatheTest, MakesAClosedCylinder) {
    for (const Fill fill : {Fill::Fan, Fill::Even}) {
        const mesh::TriangleMesh mesh = cylinder(120, {}, fill);
        EXPECT_EQ(num_open_edges(mesh), 0u);
        EXPECT_NEAR(volumes(mesh).at(0), std::numbers::pi * 0.25 * 3.0, 0.002);
    }
}

TEST(LatheTest, FlutesTakeTheirVolume) {
    const Flutes flutes{.count = 20, .depth = 0.01, .bottom = 0.5, .top = 2.5};
    const double plain = volumes(cylinder(600, {}, Fill::Fan)).at(0);
    const mesh::TriangleMesh fluted = cylinder(600, flutes, Fill::Fan);
    EXPECT_EQ(num_open_edges(fluted), 0u);
    // A parabola's mean is 2/3 of its depth; the ends are a little shallower.
    const double groove = 2.0 / 3.0 * 0.01 * 2.0 * std::numbers::pi * 0.5 * 2.0;
    EXPECT_NEAR((plain - volumes(fluted).at(0)) / groove, 1.0, 0.05);
}

TEST(LatheTest, ArcsEndWhereTheyShould) {
    const Curve quarter = arc(
        {.center = {2.0, 1.0}, .radii = {0.5, 0.25}, .begin_degrees = -90.0, .end_degrees = 0.0},
        0.1);
    EXPECT_NEAR(quarter.front().x, 2.0, 1e-12);
    EXPECT_NEAR(quarter.front().y, 0.75, 1e-12);
    EXPECT_NEAR(quarter.back().x, 2.5, 1e-12);
    EXPECT_NEAR(quarter.back().y, 1.0, 1e-12);
    EXPECT_GE(quarter.size(), 5u);
}

TEST(DiscTest, AnnulusFitsAroundADisc) {
    mesh::TriangleMesh mesh;
    append_disc(mesh, {.radius = 1.0, .num_around = 60, .fill = Fill::Even});
    const std::size_t num_inside = mesh.num_vertices();
    EXPECT_EQ(num_inside, 1u + 3u * 10u * 11u);
    append_disc(mesh, {.radius = 3.0,
                       .num_around = 180,
                       .fill = Fill::Even,
                       .inner_radius = 1.0,
                       .inner_num_around = 60});
    EXPECT_EQ(num_open_edges(mesh), 180u) << "only the outer rim is open";
    EXPECT_NEAR(area(mesh), std::numbers::pi * 9.0, 0.02);
    for (const mesh::Triangle& triangle : mesh.triangles) {
        ASSERT_GT(area_vector(mesh, triangle).y, 0.0);
    }
}

TEST(GroundTest, IsAFlatSquareFacingUp) {
    for (const std::size_t wish : {4u, 10u, 1'000u, 12'345u}) {
        mesh::TriangleMesh mesh;
        append_ground(mesh, 8.0, wish);
        EXPECT_NEAR(static_cast<double>(mesh.num_vertices()), static_cast<double>(wish),
                    0.6 * std::sqrt(double(wish)));
        EXPECT_NEAR(area(mesh), 64.0, 1e-4);
        for (const mesh::Triangle& triangle : mesh.triangles) {
            ASSERT_GT(area_vector(mesh, triangle).y, 0.0);
        }
    }
}

TEST(NoiseTest, IsSmoothBoundedAndZeroOnTheLattice) {
    EXPECT_EQ(gradient_noise({3.0, -2.0, 5.0}), 0.0);
    double sum = 0.0;
    double largest = 0.0;
    for (int i = 0; i < 20'000; ++i) {
        const glm::dvec3 p(0.137 * i, -0.071 * i, 0.011 * i);
        const double value = gradient_noise(p, 7);
        sum += value;
        largest = std::max(largest, std::abs(value));
        ASSERT_LT(std::abs(gradient_noise(p + glm::dvec3(1e-5), 7) - value), 1e-4);
    }
    EXPECT_LT(largest, 1.1);
    EXPECT_GT(largest, 0.6);
    EXPECT_LT(std::abs(sum / 20'000.0), 0.01);
    EXPECT_NE(gradient_noise({0.3, 0.4, 0.5}, 1), gradient_noise({0.3, 0.4, 0.5}, 2));
}

TEST(NoiseTest, OctavesAddUp) {
    const glm::dvec3 p(0.3, 1.4, -2.5);
    EXPECT_EQ(fractal_noise(p, {.num_octaves = 0}), 0.0);
    EXPECT_EQ(fractal_noise(p, {.num_octaves = 1, .seed = 5}), gradient_noise(p, 5));
    EXPECT_NE(fractal_noise(p, {.num_octaves = 2, .seed = 5}), gradient_noise(p, 5));
}

} // namespace
} // namespace relumine::data_gen
