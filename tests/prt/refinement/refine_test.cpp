#include "prt/refinement/refine.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/cube_map.h"
#include "files/parallel.h"
#include "mesh/edge_uses.h"
#include "mesh/normals.h"
#include "prt/precompute.h"
#include "prt/refinement/coarse_transfer.h"
#include "prt/refinement/lit_backs.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "prt/visibility/twin_triangles.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// A box on a floor of two triangles.
mesh::TriangleMesh box_on_floor() {
    return scenes::joined(scenes::box({-0.5f, 0.001f, -0.5f}, {0.5f, 1.0f, 0.5f}),
                          scenes::floor_grid(2, 6.0f));
}

mesh::TriangleMesh refined(const mesh::TriangleMesh& mesh, const RefineOptions& options,
                           RefineReport* report = nullptr) {
    return refine(mesh, RayScene(mesh), options, {}, report);
}

/// A wall without end at x = 0: nothing from x > 0 reaches points left of it, below a height.
class Wall final : public Blockers {
public:
    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                         std::uint32_t active) const override {
        std::uint32_t blocked = 0;
        for (std::uint32_t i = 0; i < PacketSize; ++i)
            if ((origin.x < 0.0f) != (directions.x[i] < 0.0f))
                blocked |= 1u << i;
        return blocked & active;
    }
};

TEST(CoarseDirections, WhatReachesAPointOverAnEmptyFloor) {
    const CoarseDirections directions;
    const mesh::TriangleMesh floor = scenes::floor_grid(2, 1.0f);
    const RayScene rays(floor);
    const Progress progress{Work()};
    const auto bits = directions.trace(vertex_receivers(floor), rays, 1e-4f, progress);
    ASSERT_EQ(bits.size(), 4u);
    std::size_t count = 0;
    for (const std::uint64_t word : bits[0])
        count += static_cast<std::size_t>(std::popcount(word));
    EXPECT_EQ(count, 6u * 16u * 16u / 2u) << "the upper half";
}

/// A point on each side of the wall, both ends of an edge, and one between them on the right.
struct BesideTheWall {
    Receivers points;
    std::vector<CoarseDirections::Bits> bits;
    std::array<CoarseDirections::Point, 2> ends;

    explicit BesideTheWall(const CoarseDirections& directions) {
        points.positions = {{-1, 0, 0}, {1, 0, 0}, {0.5f, 0, 0}};
        points.normals.assign(3, glm::vec3(0, 1, 0));
        bits = directions.trace(points, Wall(), 0.0f, Progress(Work()));
        for (std::size_t i = 0; i < ends.size(); ++i)
            ends[i] = {points.normals[i], &bits[i], 0.5f};
    }
};

TEST(CoarseDirections, TheDifferenceAtAWallIsTheClosedForm) {
    // On one side of the wall half of the sky is seen, on the other the other half. The middle
    // differs from the mean by half of its T everywhere: RMS^2 = 1/(4 pi) Int_hemisphere
    // (cos / 2 pi)^2 = 1 / (24 pi^2).
    const CoarseDirections directions;
    const BesideTheWall beside(directions);
    const auto& [points, bits, ends] = beside;
    EXPECT_NEAR(directions.difference({points.normals[2], &bits[2]}, ends),
                std::sqrt(1.0 / 24.0) / 3.14159265, 3e-4);
    const std::array only = {CoarseDirections::Point{points.normals[0], &bits[0]}};
    EXPECT_EQ(directions.difference({points.normals[0], &bits[0]}, only), 0.0f);
    // Other normals, all of them slow: the same sum by the plain way.
    const glm::vec3 slanted = glm::normalize(glm::vec3(0.3f, 1.0f, 0.2f));
    double sum = 0.0, mean = 0.0, sum_of_sizes = 0.0, all = 0.0;
    for (std::size_t p = 0; p < CoarseDirections::NumEvenPatches; ++p)
        for (std::size_t j = 0; j < DirectionPatch::Size; ++j) {
            const glm::vec3 w = directions.patches()[p].direction(j);
            const double place = std::max({std::abs(w.x), std::abs(w.y), std::abs(w.z)});
            const double share = place * place * place; // of the texel's solid angle
            const bool a = (bits[0][p] >> j & 1u) != 0, m = (bits[2][p] >> j & 1u) != 0;
            const double difference =
                (m ? glm::dot(slanted, w) : 0.0f) - (a ? glm::dot(points.normals[0], w) : 0.0f);
            sum += share * difference * difference;
            mean += share * difference;
            sum_of_sizes += share * std::abs(difference);
            all += share;
        }
    const auto expected = [&](double of_all) {
        return std::sqrt(sum / all + 20.0 * of_all * of_all / (all * all)) / 3.14159265;
    };
    const CoarseDirections::Point there{slanted, &bits[2]};
    EXPECT_NEAR(directions.difference(there, only), expected(mean), 1e-4);
    EXPECT_NEAR(directions.difference(there, only, CoarseDirections::Signs::Dropped),
                expected(sum_of_sizes), 1e-4);
    EXPECT_GT(expected(sum_of_sizes), 1.05 * expected(mean));
}

TEST(CoarseDirections, TheLightOfAnEnvironmentCounts) {
    // All light comes from one small place on the right, at half of the height: there the middle
    // has cos and the mean half of it. Under even light the gain on the right makes up for the loss
    // on the left.
    cubemap::CubeMap sun(128);
    sun.at(cubemap::Face::PositiveX, 64, 32) = glm::vec3(1e5f);
    const CoarseDirections directions(&sun);
    EXPECT_EQ(directions.patches().size(), CoarseDirections::NumEvenPatches + 1);
    const glm::vec3 w = glm::vec3(cubemap::texel_direction(cubemap::Face::PositiveX, 64, 32, 128));
    for (std::size_t j = 0; j < DirectionPatch::Size; ++j)
        EXPECT_LT(glm::distance(directions.patches().back().direction(j), w), 0.02f);
    const BesideTheWall beside(directions);
    const auto& [points, bits, ends] = beside;
    EXPECT_NEAR(directions.difference({points.normals[2], &bits[2]}, ends),
                std::sqrt(1.0 / 24.0 + 4.0 * double{w.y * w.y} / 4.0) / 3.14159265, 1e-3);
    // Light without power and light from everywhere are no reason for patches.
    const cubemap::CubeMap black(64), white(64, glm::vec3(1.0f));
    for (const cubemap::CubeMap* map : {&black, &white})
        EXPECT_EQ(CoarseDirections(map).patches().size(), CoarseDirections::NumEvenPatches);
}

/// Counts the rays that are asked for.
class CountingBlockers final : public Blockers {
public:
    explicit CountingBlockers(const Blockers& blockers) : blockers_(blockers) {}
    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                         std::uint32_t active) const override {
        num_rays_ += static_cast<std::uint64_t>(std::popcount(active));
        return blockers_.occluded(origin, directions, active);
    }
    [[nodiscard]] std::uint64_t num_rays() const { return num_rays_; }

private:
    const Blockers& blockers_;
    mutable std::atomic<std::uint64_t> num_rays_ = 0;
};

/// Small triangles, 0.2 and more above the ground.
mesh::TriangleMesh leaves() {
    mesh::TriangleMesh mesh = scenes::triangle_soup(600, 1);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        const glm::vec3 corner = mesh.positions[i / 3 * 3];
        if (i % 3 != 0)
            mesh.positions[i] = corner + 0.15f * (mesh.positions[i] - corner);
    }
    for (glm::vec3& position : mesh.positions)
        position.y = 0.7f + 0.4f * position.y;
    mesh.normals.assign(mesh.num_vertices(), glm::vec3(0, 1, 0));
    return mesh;
}

TEST(CoarseDirections, MiddlesOfFineEdgesHaveTheErrorOfThePlainWay) {
    const mesh::TriangleMesh mesh = scenes::floor_grid(250, 3.0f);
    const mesh::TriangleMesh shaded = scenes::joined(mesh, leaves());
    const RayScene rays(shaded);
    const BeamScene beams(shaded, rays);
    const CountingBlockers counted(rays);
    const CoarseDirections directions;
    const Progress progress{Work()};
    const float bias = automatic_bias(shaded);
    const auto at_vertices = directions.trace(vertex_receivers(mesh), beams, bias, progress);
    Receivers middles;
    std::vector<CoarseDirections::Neighbours> ends;
    std::vector<mesh::EdgeUse> edges;
    mesh::for_each_edge(mesh::edge_uses(mesh.triangles), [&](std::span<const mesh::EdgeUse> edge) {
        const auto& [low, high] = std::pair(edge[0].low, edge[0].high);
        if (edge.size() != 2 || (low + high) % 7 != 0)
            return;
        edges.push_back(edge[0]);
        middles.positions.push_back(0.5f * (mesh.positions[low] + mesh.positions[high]));
        middles.normals.push_back(glm::normalize(mesh.normals[low] + mesh.normals[high]));
        ends.push_back({&at_vertices[low], &at_vertices[high]});
    });
    const auto plain = directions.trace(middles, counted, bias, progress);
    const std::uint64_t num_plain = counted.num_rays();
    const auto narrowed = directions.trace(middles, counted, bias, progress, ends);
    EXPECT_LT(counted.num_rays() - num_plain, num_plain / 20);
    double squares = 0.0, largest_error = 0.0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto [low, high] = std::pair(edges[i].low, edges[i].high);
        const std::array<CoarseDirections::Point, 2> both = {
            CoarseDirections::Point{mesh.normals[low], &at_vertices[low], 0.5f},
            CoarseDirections::Point{mesh.normals[high], &at_vertices[high], 0.5f}};
        const auto error = [&](const CoarseDirections::Bits& bits) {
            return double{directions.difference({middles.normals[i], &bits}, both)};
        };
        const double off = error(plain[i]) - error(narrowed[i]);
        squares += off * off / static_cast<double>(edges.size());
        largest_error = std::max(largest_error, error(plain[i]));
    }
    // Leaves are a few edges wide; their corners hide between the ends of edges.
    constexpr double Allowed = 0.01; // RefineOptions::error
    EXPECT_GT(largest_error, 3.0 * Allowed);
    EXPECT_LT(std::sqrt(squares), 0.4 * Allowed);
}

TEST(Refine, ABoxOnTwoTrianglesGetsItsShadow) {
    const mesh::TriangleMesh mesh = box_on_floor();
    RefineReport report;
    const mesh::TriangleMesh fine = refined(mesh, {.error = 0.0f, .max_vertices = 2000}, &report);
    EXPECT_LE(fine.num_vertices(), 2000u);
    EXPECT_GT(fine.num_vertices(), 1950u) << "up to the limit";
    EXPECT_TRUE(report.is_at_limit);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        EXPECT_EQ(fine.positions[i], mesh.positions[i]);
        EXPECT_EQ(fine.normals[i], mesh.normals[i]);
    }
    // Most vertices are near the box, and none of the box's own: it is convex.
    std::size_t num_near = 0;
    for (std::size_t i = mesh.num_vertices(); i < fine.num_vertices(); ++i) {
        const glm::vec3& p = fine.positions[i];
        num_near += std::max(std::abs(p.x), std::abs(p.z)) < 1.5f ? 1 : 0;
    }
    EXPECT_GT(num_near, 1200u) << "in a quarter of the floor";
    // Without gaps.
    mesh::for_each_edge(mesh::edge_uses(fine.triangles), [&](std::span<const mesh::EdgeUse> edge) {
        EXPECT_LE(edge.size(), 2u);
        if (edge.size() == 1) {
            const glm::vec3 middle =
                0.5f * (fine.positions[edge[0].low] + fine.positions[edge[0].high]);
            EXPECT_FLOAT_EQ(std::max(std::abs(middle.x), std::abs(middle.z)), 3.0f);
        }
    });
}

TEST(Refine, TheShadowOfANamedSunIsFound) {
    const mesh::TriangleMesh mesh = box_on_floor();
    const RayScene rays(mesh);
    cubemap::CubeMap light(128, glm::vec3(0.1f));
    light.at(cubemap::Face::PositiveX, 70, 30) = glm::vec3(1e6f);
    const glm::vec3 sun =
        glm::vec3(cubemap::texel_direction(cubemap::Face::PositiveX, 70, 30, 128));
    const auto lit = [&](const glm::vec3& p) {
        return rays.occluded(p + glm::vec3(0, 1e-3f, 0), sun) ? 0.0f : 1.0f;
    };
    // Mean error of the floor's sun, at the middles of triangles, by area.
    const auto error = [&](const RefineOptions& options) {
        const mesh::TriangleMesh fine = refined(mesh, options);
        double sum = 0.0;
        for (const auto& [a, b, c] : fine.triangles) {
            const std::array<glm::vec3, 3> p = {fine.positions[a], fine.positions[b],
                                                fine.positions[c]};
            if (std::max({p[0].y, p[1].y, p[2].y}) > 0.0f)
                continue;
            const float area = 0.5f * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
            const float mean = (lit(p[0]) + lit(p[1]) + lit(p[2])) / 3.0f;
            sum += double{area * std::abs(mean - lit((p[0] + p[1] + p[2]) / 3.0f))};
        }
        return sum;
    };
    const double any = error({.error = 0.0f, .max_vertices = 1500});
    const double named = error({.error = 0.0f, .max_vertices = 1500, .light = light});
    EXPECT_LT(named, 0.4 * any);
    EXPECT_GT(named, 0.0);
}

TEST(Refine, OnlyEdgesWhoseEndsDifferAreAskedInTheMiddle) {
    const mesh::TriangleMesh mesh = scenes::joined(
        scenes::box({-0.2f, 0.001f, -0.2f}, {0.2f, 0.3f, 0.2f}), scenes::floor_grid(60, 6.0f));
    RefineReport report;
    const mesh::TriangleMesh fine = refined(mesh, {.error = 0.02f}, &report);
    EXPECT_GT(fine.num_vertices(), mesh.num_vertices() + 100);
    EXPECT_LT(report.num_points, 9 * fine.num_vertices() / 4)
        << "there are three times as many edges";
    refined(mesh, {.error = 0.0f, .max_vertices = mesh.num_vertices() + 500}, &report);
    EXPECT_LT(report.num_points, 9 * fine.num_vertices() / 4);
}

TEST(Refine, TheErrorHoldsInTheEnd) {
    const mesh::TriangleMesh mesh = box_on_floor();
    RefineReport loose, fine;
    const std::size_t few = refined(mesh, {.error = 0.02f}, &loose).num_vertices();
    const std::size_t many = refined(mesh, {.error = 0.01f}, &fine).num_vertices();
    EXPECT_GT(few, mesh.num_vertices());
    EXPECT_GT(many, few);
    EXPECT_EQ(loose.largest_error, 0.0f) << "none that may still be split";
    EXPECT_FALSE(fine.is_at_limit);
}

TEST(Refine, NothingIsSplitWithoutLightOrWithoutChange) {
    // Below a plane that covers all: no light at all.
    mesh::TriangleMesh dark = scenes::floor_grid(4, 1.0f);
    for (glm::vec3& normal : dark.normals)
        normal = -normal;
    const mesh::TriangleMesh both = scenes::joined(dark, scenes::floor_grid(2, 50.0f, -0.01f));
    const mesh::TriangleMesh fine = refined(both, {.error = 0.0f, .max_vertices = 5000});
    std::size_t num_above = 0;
    for (const glm::vec3& p : fine.positions)
        num_above += p.y > -0.005f ? 1 : 0;
    EXPECT_EQ(num_above, 16u) << "the side that looks down at the floor";
    const mesh::TriangleMesh flat = scenes::floor_grid(2, 1.0f);
    EXPECT_EQ(refined(flat, {.error = 0.0f}).triangles, flat.triangles);
    const mesh::TriangleMesh sphere = scenes::icosphere(4, 1.0f, glm::vec3(0.0f));
    EXPECT_EQ(refined(sphere, {.error = 0.02f}).triangles, sphere.triangles);
}

TEST(Refine, LimitsOfLength) {
    const mesh::TriangleMesh floor = scenes::floor_grid(2, 1.0f);
    const auto longest = [](const mesh::TriangleMesh& mesh) {
        float result = 0.0f;
        for (const mesh::EdgeUse& use : mesh::edge_uses(mesh.triangles))
            result =
                std::max(result, glm::distance(mesh.positions[use.low], mesh.positions[use.high]));
        return result;
    };
    const mesh::TriangleMesh even = refined(floor, {.error = {}, .max_edge = 0.1f});
    EXPECT_LE(longest(even), 0.1f);
    EXPECT_GT(longest(even), 0.05f);
    RefineReport report;
    const mesh::TriangleMesh limited =
        refined(floor, {.error = {}, .max_edge = 0.01f, .max_vertices = 500}, &report);
    EXPECT_LE(limited.num_vertices(), 500u);
    EXPECT_TRUE(report.is_at_limit);
    const mesh::TriangleMesh coarse = refined(box_on_floor(), {.error = 0.0f, .min_edge = 0.5f});
    for (const mesh::EdgeUse& use : mesh::edge_uses(coarse.triangles))
        EXPECT_GE(glm::distance(coarse.positions[use.low], coarse.positions[use.high]), 0.2f)
            << "no half is shorter, and an edge to a corner across hardly, or to a vertex that "
               "left "
               "the box";
}

TEST(Refine, SmallThingsInTheMiddleOfALargeTriangleAreFound) {
    // Far from all edges of the floor.
    const mesh::TriangleMesh mesh = scenes::joined(
        scenes::box({0.9f, 0.01f, -1.6f}, {1.4f, 0.5f, -1.1f}), scenes::floor_grid(2, 8.0f));
    const mesh::TriangleMesh fine = refined(mesh, {.error = 0.0f, .max_vertices = 400});
    std::size_t num_near = 0;
    for (const glm::vec3& p : fine.positions)
        num_near += glm::distance(p, glm::vec3(1.15f, 0, -1.35f)) < 1.0f ? 1 : 0;
    EXPECT_GT(num_near, 150u);
}

/// A wall of one triangle, its sides under beams and its centre behind a box: a gable. Light falls
/// between them.
mesh::TriangleMesh gable() {
    mesh::TriangleMesh wall;
    wall.positions = {{-3, 0, 0}, {3, 0, 0}, {0, 3, 0}};
    wall.normals.assign(3, {0, 0, 1});
    wall.triangles = {{0, 1, 2}};
    const glm::vec3 centre(0, 1, 0);
    mesh::TriangleMesh result = wall;
    const auto add = [&](const glm::vec3& middle) {
        result = scenes::joined(result, scenes::box(middle - 0.2f, middle + 0.2f));
    };
    for (std::size_t k = 0; k < 3; ++k)
        for (int i = 0; i < 16; ++i)
            add(glm::mix(wall.positions[k], wall.positions[(k + 1) % 3],
                         static_cast<float>(i) / 16.0f));
    add(centre);
    return result;
}

TEST(Refine, LightIsFoundOnATriangleThatIsDarkAtItsSidesAndItsCentre) {
    RefineReport report;
    const mesh::TriangleMesh mesh = gable();
    const mesh::TriangleMesh fine =
        refined(mesh, {.coarse_edge = 3.0f, .min_edge = 0.05f}, &report);
    std::size_t num_lit = 0;
    const RayScene rays(mesh);
    for (std::size_t i = mesh.num_vertices(); i < fine.num_vertices(); ++i) {
        DirectionPacket ahead;
        ahead.set(0, {0, 0, 1});
        ahead.num_directions = 1;
        num_lit +=
            rays.occluded(fine.positions[i] + glm::vec3(0, 0, 1e-3f), ahead, 1u) == 0 ? 1 : 0;
    }
    EXPECT_GT(num_lit, 30u);
}

TEST(Refine, TrianglesThatAreNotCoarseStayAndCostNothing) {
    const mesh::TriangleMesh mesh = box_on_floor();
    RefineReport report;
    const mesh::TriangleMesh same = refined(mesh, {.coarse_edge = 100.0f}, &report);
    EXPECT_EQ(same.positions, mesh.positions);
    EXPECT_EQ(same.triangles, mesh.triangles);
    EXPECT_EQ(report.num_points, 0u);
    // The box has sides of 1, the floor of 6.
    const mesh::TriangleMesh fine = refined(mesh, {.coarse_edge = 3.0f, .min_edge = 0.1f}, &report);
    EXPECT_GT(report.num_added, 100u);
    EXPECT_EQ(report.num_added, fine.num_vertices() - mesh.num_vertices());
    for (std::size_t i = mesh.num_vertices(); i < fine.num_vertices(); ++i)
        EXPECT_EQ(fine.positions[i].y, 0.0f) << i;
}

TEST(Refine, NewVerticesLeaveTheSolidThatHidesThem) {
    // A wall runs through a box. Beside the box the wall is half lit, at once.
    const mesh::TriangleMesh mesh =
        scenes::joined(scenes::floor_grid(2, 8.0f), scenes::box({-1, -1, -1}, {1, 1, 1}));
    const mesh::TriangleMesh fine = refined(mesh, {.coarse_edge = 4.0f, .min_edge = 0.25f});
    const auto is_hidden = [](const glm::vec3& at) {
        return std::max(std::abs(at.x), std::abs(at.z)) < 0.99f;
    };
    double dark = 0.0;
    for (const mesh::Triangle& triangle : fine.triangles) {
        glm::vec3 centre(0.0f);
        int num_hidden = 0;
        for (const std::uint32_t vertex : triangle) {
            if (vertex >= 4 && vertex < mesh.num_vertices())
                break; // of the box
            centre += fine.positions[vertex] / 3.0f;
            num_hidden += is_hidden(fine.positions[vertex]) ? 1 : 0;
        }
        if (triangle[0] >= 4 && triangle[0] < mesh.num_vertices())
            continue;
        const double area =
            0.5 *
            glm::length(glm::cross(fine.positions[triangle[1]] - fine.positions[triangle[0]],
                                   fine.positions[triangle[2]] - fine.positions[triangle[0]]));
        if (!is_hidden(centre))
            dark += area * num_hidden / 3.0;
    }
    // Triangles of half a unit around eight units of border: 1.3 where they stay.
    EXPECT_LT(dark, 0.4);
}

TEST(Refine, APostWhoseEndsOtherSolidsHideIsLitBetweenThem) {
    // It is small in the scene, and no corner of it is lit.
    const mesh::TriangleMesh post =
        mesh::with_creases(scenes::box({-0.2f, 0.5f, -0.2f}, {0.2f, 2.5f, 0.2f}), 40.0f);
    mesh::TriangleMesh mesh = scenes::joined(post, scenes::box({-1, 0.1f, -1}, {1, 1, 1}));
    mesh = scenes::joined(mesh, scenes::box({-1, 2, -1}, {1, 3, 1}));
    mesh = scenes::joined(mesh, scenes::floor_grid(2, 100.0f));
    const mesh::TriangleMesh fine =
        refined(mesh, {.coarse_edge = 1.9f, .min_edge = 0.1f, .max_vertices = 4000});
    EXPECT_TRUE(std::equal(mesh.positions.begin(), mesh.positions.end(), fine.positions.begin()));
    const std::vector<CoarseDirections::Bits> bits = CoarseDirections().trace(
        vertex_receivers(fine), RayScene(mesh), automatic_bias(mesh), Progress{Work()});
    int num_between = 0;
    for (const mesh::Triangle& triangle : fine.triangles) {
        const glm::vec3 centre = (fine.positions[triangle[0]] + fine.positions[triangle[1]] +
                                  fine.positions[triangle[2]]) /
                                 3.0f;
        if (std::max(std::abs(centre.x), std::abs(centre.z)) > 0.25f || centre.y < 1.05f ||
            centre.y > 1.95f)
            continue;
        ++num_between;
        for (const std::uint32_t vertex : triangle)
            EXPECT_FALSE(CoarseDirections::is_hidden(bits[vertex])) << fine.positions[vertex].y;
    }
    EXPECT_GT(num_between, 8 * 4) << "of four sides";
}

TEST(Refine, CurvedVerticesLieOnTheBall) {
    const mesh::TriangleMesh coarse = scenes::icosphere(1, 1.0f, glm::vec3(0.0f));
    const mesh::TriangleMesh fine =
        refined(coarse, {.error = {}, .max_edge = 0.2f, .curved = true});
    ASSERT_GT(fine.num_vertices(), 300u);
    for (std::size_t i = 0; i < fine.num_vertices(); ++i) {
        EXPECT_NEAR(glm::length(fine.positions[i]), 1.0f, 0.01f);
        if (i < coarse.num_vertices()) {
            EXPECT_EQ(fine.positions[i], coarse.positions[i]);
        }
    }
}

TEST(Refine, SameBytesForAnyNumberOfThreads) {
    const auto expect_same = [](const mesh::TriangleMesh& mesh, const RefineOptions& options) {
        mesh::TriangleMesh one;
        {
            const files::ThreadLimit single(1);
            one = refined(mesh, options);
        }
        const mesh::TriangleMesh many = refined(mesh, options);
        EXPECT_GT(many.num_vertices(), mesh.num_vertices() + 500);
        EXPECT_EQ(one.positions, many.positions);
        EXPECT_EQ(one.normals, many.normals);
        EXPECT_EQ(one.triangles, many.triangles);
    };
    expect_same(scenes::sphere_and_box_on_floor(), {.error = 0.005f, .max_vertices = 3000});
    // The ball's edges are fine in its scene.
    expect_same(scenes::joined(scenes::icosphere(4, 0.3f, {0.0f, 0.32f, 0.0f}),
                               scenes::floor_grid(2, 8.0f)),
                {.error = 0.0f, .min_edge = 0.0f, .max_vertices = 4500});
}

TEST(Refine, NewVerticesOfARoundMeshLookFromItsSmoothSurface) {
    const mesh::TriangleMesh ball = scenes::icosphere(1, 1.0f, {0.0f, 0.0f, 0.0f});
    const mesh::TriangleMesh fine = refined(ball, {.error = 0.005f, .max_vertices = 1000});
    ASSERT_GT(fine.num_vertices(), 200u);
    ASSERT_EQ(fine.lifts.size(), fine.num_vertices());
    const Receivers receivers = vertex_receivers(fine);
    for (std::size_t i = 0; i < fine.num_vertices(); ++i) {
        // The shape stays, the flat triangles lie inside of the ball.
        EXPECT_LE(glm::length(fine.positions[i]), 1.0001f);
        EXPECT_GE(glm::length(receivers.positions[i]), 0.9999f);
        EXPECT_LE(glm::length(receivers.positions[i]), 1.06f);
    }
    // Nothing stands before a ball.
    const RayScene rays(ball);
    for (const CoarseDirections::Bits& bits :
         CoarseDirections().trace(receivers, rays, automatic_bias(ball), Progress{Work()}))
        EXPECT_GT(CoarseDirections::num_lit(bits), 740) << "of the 768 above its horizon";
    // A flat mesh has no lifts, and a second refinement keeps those of the first.
    EXPECT_TRUE(refine(scenes::floor_grid(2, 8.0f), Wall(), {.max_vertices = 500}).lifts.empty());
    const mesh::TriangleMesh twice =
        refine(fine, rays, {.error = 0.003f, .max_vertices = fine.num_vertices() + 50});
    EXPECT_TRUE(std::equal(fine.lifts.begin(), fine.lifts.end(), twice.lifts.begin()));
}

TEST(Refine, AFewVerticesHaveAnErrorOfTheirOwn) {
    const mesh::TriangleMesh mesh = box_on_floor();
    const RefineOptions few{.error = 1.0f, .error_of_few = 0.001f, .few = 100};
    const std::size_t num_added = refined(mesh, few).num_vertices() - mesh.num_vertices();
    EXPECT_GT(num_added, 90u);
    EXPECT_LE(num_added, 100u);
}

TEST(LitBacks, OpenSurfacesGetThoseThatLightReaches) {
    mesh::TriangleMesh box = scenes::box({-1, 0, -1}, {1, 1, 1});
    const auto backs = [](const mesh::TriangleMesh& mesh) {
        return with_lit_backs(mesh, RayScene(mesh), automatic_bias(mesh));
    };
    EXPECT_EQ(backs(box).triangles, box.triangles) << "closed";
    std::erase_if(box.triangles, [&](const mesh::Triangle& triangle) {
        return std::all_of(triangle.begin(), triangle.end(),
                           [&](std::uint32_t vertex) { return box.positions[vertex].y == 1.0f; });
    });
    const mesh::TriangleMesh open = backs(box);
    ASSERT_EQ(open.num_triangles(), 2 * box.num_triangles());
    EXPECT_TRUE(std::equal(box.triangles.begin(), box.triangles.end(), open.triangles.begin()));
    for (std::size_t i = 0; i < box.num_triangles(); ++i) {
        const mesh::Triangle& back = open.triangles[box.num_triangles() + i];
        EXPECT_EQ(open.positions[back[0]], box.positions[box.triangles[i][0]]);
        EXPECT_EQ(open.positions[back[1]], box.positions[box.triangles[i][2]]);
        EXPECT_EQ(open.normals[back[0]], -box.normals[box.triangles[i][0]]);
    }
    EXPECT_EQ(backs(open).num_triangles(), open.num_triangles()) << "both sides are there";
}

TEST(LitBacks, LightThroughASmallHoleOfALargeSurfaceIsFound) {
    // The floor of a box, under a thick lid with a hole away from the middle.
    mesh::TriangleMesh mesh = scenes::floor_grid(2, 10.0f);
    for (mesh::Triangle& triangle : mesh.triangles)
        std::swap(triangle[1], triangle[2]);
    for (glm::vec3& normal : mesh.normals)
        normal = -normal;
    const auto add = [&](glm::vec2 min, glm::vec2 max, float low, float high) {
        mesh = scenes::joined(mesh, scenes::box({min.x, low, min.y}, {max.x, high, max.y}));
    };
    for (const float side : {-5.5f, 5.5f}) {
        add({side - 0.49f, -6}, {side + 0.49f, 6}, -0.5f, 0.3f);
        add({-6, side - 0.49f}, {6, side + 0.49f}, -0.5f, 0.3f);
    }
    add({-6, -6}, {6, 0.8f}, 0.05f, 0.6f);
    add({-6, 1.8f}, {6, 6}, 0.05f, 0.6f);
    add({-6, 0.7f}, {2.5f, 1.9f}, 0.05f, 0.6f);
    add({3.5f, 0.7f}, {6, 1.9f}, 0.05f, 0.6f);
    const mesh::TriangleMesh both = with_lit_backs(mesh, RayScene(mesh), automatic_bias(mesh));
    EXPECT_EQ(both.num_triangles() - mesh.num_triangles(), 1u);
}

TEST(LitBacks, ALeafIsLitFromBothSides) {
    mesh::TriangleMesh leaf = scenes::floor_grid(2, 1.0f);
    leaf.triangles.pop_back();
    const mesh::TriangleMesh both = with_lit_backs(leaf, RayScene(leaf), automatic_bias(leaf));
    EXPECT_EQ(both.num_triangles(), 2u);
    EXPECT_EQ(both.num_vertices(), leaf.num_vertices() + 3);
}

/// An eye that sees through a surface meets one of its sides, not both.
TEST(LitBacks, WhatIsSeenThroughHasOneSideEach) {
    mesh::TriangleMesh pane = scenes::floor_grid(2, 1.0f);
    pane.triangle_materials = {0, 0};
    const auto with = [&](const mesh::Material& material) {
        pane.materials = {material};
        return with_lit_backs(pane, RayScene(pane), automatic_bias(pane));
    };
    const mesh::TriangleMesh veil = with({.alpha_mode = mesh::AlphaMode::Blend, .alpha = 0.5f});
    EXPECT_EQ(veil.num_triangles(), 4u);
    EXPECT_FALSE(veil.materials[0].is_double_sided);
    for (const float height : {-1.0f, 1.0f}) {
        std::vector<RayScene::Layer> layers;
        RayScene(veil).layers({0.1f, height, 0.2f}, {0.0f, -height, 0.0f}, layers);
        ASSERT_EQ(layers.size(), 1u) << height;
        EXPECT_EQ(layers[0].hit.triangle < 2, height > 0.0f);
    }
    EXPECT_TRUE(with({}).materials[0].is_double_sided) << "opaque";
    EXPECT_EQ(with({.transmission = 1.0f, .thickness = 1.0f}).num_triangles(), 2u) << "a body";
}

TEST(LitBacks, WhatPassesLightOnGetsThemByItself) {
    mesh::TriangleMesh leaf = scenes::floor_grid(2, 1.0f);
    EXPECT_EQ(with_backs_of_sheets(leaf).num_triangles(), 2u) << "no material";
    leaf.materials = {{.name = "leaf", .diffuse_transmission = 0.5f}};
    leaf.triangle_materials = {0, 0};
    leaf.lifts.assign(4, glm::vec3(0.0f, 0.1f, 0.0f));
    EXPECT_EQ(with_lit_backs(leaf, RayScene(leaf), automatic_bias(leaf)).num_triangles(), 2u)
        << "its backs come when its front is refined";
    const mesh::TriangleMesh both = with_backs_of_sheets(leaf);
    ASSERT_EQ(both.num_triangles(), 4u);
    EXPECT_EQ(both.num_vertices(), 8u);
    EXPECT_EQ(both.triangle_materials.back(), 0u);
    EXPECT_EQ(both.lifts[3], leaf.lifts[3]);
    EXPECT_EQ(both.lifts[7], glm::vec3(0.0f)) << "a lift leads to the front's side";
    EXPECT_EQ(with_backs_of_sheets(both).num_triangles(), 4u) << "both sides are there";
    const TwinTriangles twins(both);
    const std::optional<Hit> other = twins.other_side({1, {0.25f, 0.5f}});
    ASSERT_TRUE(other);
    EXPECT_EQ(other->triangle, 3u);
    EXPECT_EQ(other->barycentric, glm::vec2(0.5f, 0.25f)) << "its corners run the other way round";
}

TEST(Refine, OptionsOutOfRangeAreRefused) {
    const mesh::TriangleMesh mesh = box_on_floor();
    const auto refuse = [](const mesh::TriangleMesh& what, const RefineOptions& options) {
        EXPECT_THROW(static_cast<void>(refined(what, options)), std::invalid_argument);
    };
    refuse(mesh, {.error = -1.0f});
    refuse(mesh, {.error = std::numeric_limits<float>::quiet_NaN()});
    refuse(mesh, {.max_edge = 0.0f});
    refuse(mesh, {.max_edge = 1.0f, .min_edge = 2.0f});
    refuse(mesh, {.min_edge = -1.0f});
    refuse(mesh, {.max_vertices = 5});
    refuse(mesh, {.light = cubemap::CubeMap()});
    mesh::TriangleMesh flat = mesh;
    flat.triangles = {{0, 0, 1}, {1, 1, 1}};
    refuse(flat, {});
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(static_cast<void>(refine(mesh, RayScene(mesh), {}, {.stop = stop.get_token()})),
                 Cancelled);
}

} // namespace
} // namespace relumine::prt
