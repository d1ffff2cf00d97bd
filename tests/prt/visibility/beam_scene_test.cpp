#include "prt/visibility/beam_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "mesh/floor.h"
#include "mesh/load.h"
#include "prt/clusters/lattice.h"
#include "prt/precompute.h"
#include "prt/receivers/receiver_order.h"
#include "prt/visibility/lazy_beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/every_target.h"
#include "tests/prt/leaf_card.h"
#include "tests/prt/same_transfer.h"
#include "tests/prt/scenes.h"
#include "tests/real_data.h"

namespace relumine::prt {
namespace {

/// Directions of a lattice of n x n points on a cell's face, as the clustering makes them.
DirectionPatch lattice_patch(const Cell& cell, std::uint32_t n) {
    DirectionPatch patch;
    for (std::uint32_t i = 0; i < n * n; ++i) {
        const double s = (cell.x + static_cast<double>(i % n) / (n - 1)) * cell.size();
        const double t = (cell.y + static_cast<double>(i / n) / (n - 1)) * cell.size();
        patch.add(glm::vec3(glm::normalize(cubemap::cube_point(cell.face, s, t))));
    }
    return patch;
}

DirectionPatch random_patch(std::mt19937& random, float spread) {
    const glm::vec3 axis = scenes::random_direction(random);
    std::uniform_int_distribution<int> size(1, DirectionPatch::Size);
    DirectionPatch patch;
    for (int n = size(random); n > 0; --n)
        patch.add(glm::normalize(axis + spread * scenes::random_direction(random)));
    return patch;
}

DirectionPatch any_patch(std::mt19937& random) {
    if (random() % 2 == 0)
        return random_patch(random, std::pow(10.0f, -0.5f * static_cast<float>(random() % 8)));
    const auto level = static_cast<std::uint8_t>(random() % 8);
    return lattice_patch({.face = cubemap::AllFaces[random() % 6],
                          .level = level,
                          .x = static_cast<std::uint32_t>(random()) % (1u << level),
                          .y = static_cast<std::uint32_t>(random()) % (1u << level)},
                         2 + static_cast<std::uint32_t>(random() % 7));
}

std::uint64_t all_of(const DirectionPatch& patch) {
    return patch.full() ? ~std::uint64_t{0} : (std::uint64_t{1} << patch.num_directions) - 1;
}

struct Tally {
    std::size_t num_rays = 0;
    std::size_t num_blocked = 0;
};

/// Groups of receivers of all sizes through patches of all widths, patch by patch and direction by
/// direction: the very bits of the ray tracer.
Tally compare(const mesh::TriangleMesh& mesh, const std::vector<glm::vec3>& origins,
              const std::vector<glm::vec3>& normals, std::uint32_t seed, int rounds) {
    const RayScene rays(mesh);
    const BeamScene beams(mesh, rays);
    const BeamScene by_direction(mesh, rays, 0);
    const LazyBeamScene lazy(mesh, rays);
    std::mt19937 random(seed);
    Tally tally;
    for (int round = 0; round < rounds; ++round) {
        const std::size_t size =
            std::min<std::size_t>(origins.size(), 1 + random() % ReceiverGroup::MaxSize);
        const std::size_t first = random() % (origins.size() - size + 1);
        const glm::vec3 hint = round % 5 == 0 ? glm::vec3(0.0f) : normals[first];
        const DirectionPatch patch = any_patch(random);
        std::vector<std::uint64_t> asked(size);
        for (std::size_t i = 0; i < size; ++i)
            for (std::size_t j = 0; j < patch.num_directions; ++j)
                if (glm::dot(normals[first + i], patch.direction(j)) > 0.0f)
                    asked[i] |= std::uint64_t{1} << j;
        const ReceiverGroup group{std::span(origins).subspan(first, size), hint};
        const auto lit = [&](const Blockers& blockers) {
            std::vector<std::uint64_t> result = asked;
            blockers.clear_blocked(group, patch, result);
            return result;
        };
        const std::vector<std::uint64_t> expected = lit(rays);
        EXPECT_EQ(lit(beams), expected) << "round " << round << " of seed " << seed;
        EXPECT_EQ(lit(by_direction), expected) << "round " << round << " of seed " << seed;
        EXPECT_EQ(lit(lazy), expected) << "round " << round << " of seed " << seed;
        if (round == rounds / 2)
            lazy.prepare(std::uint64_t{1} << 40);
        for (std::size_t i = 0; i < size; ++i) {
            tally.num_rays += static_cast<std::size_t>(std::popcount(asked[i]));
            tally.num_blocked += static_cast<std::size_t>(std::popcount(asked[i] & ~expected[i]));
        }
        if (testing::Test::HasFailure())
            break;
    }
    return tally;
}

Tally compare_at_vertices(const mesh::TriangleMesh& mesh, std::uint32_t seed, int rounds) {
    const Receivers receivers = vertex_receivers(mesh);
    const float bias = automatic_bias(mesh);
    std::vector<glm::vec3> origins, normals;
    for (const std::uint32_t i : spatial_order(receivers)) {
        normals.push_back(receivers.normals[i]);
        origins.push_back(ray_origin(receivers.positions[i], receivers.normals[i], bias));
    }
    return compare(mesh, origins, normals, seed, rounds);
}

/// A fine floor, which becomes two triangles, with things on it that touch and pierce it.
mesh::TriangleMesh things_on_a_floor() {
    mesh::TriangleMesh mesh = scenes::joined(
        scenes::floor_grid(33, 4.0f), scenes::icosphere(3, 0.5f, glm::vec3(0.2f, 0.4f, -0.1f)));
    mesh = scenes::joined(
        mesh, scenes::box(glm::vec3(-1.0f, 0.0f, 0.25f), glm::vec3(-0.5f, 1.0f, 0.75f)));
    return scenes::joined(mesh, scenes::icosphere(1, 0.3f, glm::vec3(1.0f, 1.0f, 1.0f)));
}

/// A plane of squares whose right edge goes over into a bent sheet: the flat part merges, the seam
/// has T-junctions.
mesh::TriangleMesh flat_sheet_that_bends() {
    mesh::TriangleMesh mesh = scenes::floor_grid(17, 2.0f);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        glm::vec3& p = mesh.positions[i];
        if (p.x > 0.01f)
            p.y += 0.3f * p.x * p.x + 0.01f * std::sin(7.0f * p.z);
    }
    return mesh;
}

TEST(BeamScene, AnswersAsTheRayTracerDoes) {
    scenes::on_every_target([] {
        const Tally tally = compare_at_vertices(things_on_a_floor(), 1, 1500);
        EXPECT_GT(tally.num_blocked, 100000u);
        EXPECT_GT(tally.num_rays - tally.num_blocked, 500000u);
    });
    compare_at_vertices(scenes::sphere_and_box_on_floor(), 2, 1500);
}

TEST(BeamScene, AnswersAsTheRayTracerDoesBehindLeaves) {
    const auto check = [](const mesh::TriangleMesh& mesh, std::uint32_t seed) {
        const Tally tally = compare_at_vertices(mesh, seed, 600);
        EXPECT_GT(tally.num_blocked, 20000u);
        EXPECT_GT(tally.num_rays - tally.num_blocked, 100000u);
    };
    scenes::on_every_target([&] {
        check(scenes::with_card(things_on_a_floor(), scenes::leaf_card(16, 2.0f, 1.2f)), 3);
    });
    // Nothing opaque is left.
    mesh::TriangleMesh all = things_on_a_floor();
    all.materials = scenes::leaf_card(1, 1.0f, 0.0f).materials;
    all.textures = scenes::leaf_card(1, 1.0f, 0.0f).textures;
    all.triangle_materials.assign(all.num_triangles(), 1);
    for (const glm::vec3& p : all.positions)
        all.uvs.emplace_back(5.0f * p.x, 5.0f * p.z);
    compare_at_vertices(all, 4, 600);
}

TEST(BeamScene, AnswersAsTheRayTracerDoesAmongRandomTriangles) {
    scenes::on_every_target([] {
        for (const std::size_t num_triangles : {1u, 15u, 16u, 17u, 300u, 3000u}) {
            const mesh::TriangleMesh soup = scenes::triangle_soup(num_triangles, 3);
            std::mt19937 random(4);
            std::uniform_real_distribution<float> coordinate(-1.5f, 1.5f);
            std::vector<glm::vec3> origins, normals;
            glm::vec3 centre(0.0f);
            for (int i = 0; i < 1000; ++i) { // in clouds, as groups are
                if (i % 50 == 0)
                    centre = {coordinate(random), coordinate(random), coordinate(random)};
                origins.push_back(centre + 0.05f * scenes::random_direction(random));
                normals.push_back(scenes::random_direction(random));
            }
            compare(soup, origins, normals, 5, 200);
        }
    });
}

TEST(BeamScene, AnswersAsTheRayTracerDoesWhereSurfacesMeet) {
    compare_at_vertices(flat_sheet_that_bends(), 6, 2000);
    compare_at_vertices(
        scenes::joined(flat_sheet_that_bends(),
                       scenes::box(glm::vec3(-0.9f, 0.0f, -0.9f), glm::vec3(0.0f, 0.5f, 0.0f))),
        7, 2000);
    // From the vertices themselves, without a lift: every ray starts on the edges of six triangles.
    const mesh::TriangleMesh mesh = things_on_a_floor();
    compare(mesh, mesh.positions, mesh.normals, 8, 1500);
}

TEST(BeamScene, AnswersAsTheRayTracerDoesAtAnyScaleAndPlace) {
    const mesh::TriangleMesh mesh = things_on_a_floor();
    for (const float scale : {1e-30f, 1e-12f, 1e-3f, 1e6f, 1e15f})
        compare_at_vertices(scenes::transformed(mesh, scale, glm::vec3(0.0f)), 9, 300);
    compare_at_vertices(scenes::transformed(mesh, 1.0f, glm::vec3(1e4f, -2e4f, 3e4f)), 10, 500);
    compare_at_vertices(scenes::transformed(mesh, 1.0f, glm::vec3(1e6f, 0.0f, 0.0f)), 11,
                        500); // floats are 1/16 apart
}

TEST(BeamScene, TreatsDegenerateTrianglesAsTheRayTracerDoes) {
    mesh::TriangleMesh mesh = things_on_a_floor();
    const auto n = static_cast<std::uint32_t>(mesh.num_vertices());
    mesh.positions.insert(
        mesh.positions.end(),
        {{0, 1, 0}, {1, 2, 1}, {0.5f, 1.5f, 0.5f}, {0, 1, 0}, {0.5f, 1.5f, 0.50001f}});
    mesh.normals.resize(mesh.positions.size(), glm::vec3(0, 1, 0));
    for (const mesh::Triangle& triangle : {mesh::Triangle{n, n, n},
                                           {n, n + 1, n},
                                           {n, n + 1, n + 2},
                                           {n, n + 3, n + 1},
                                           {n, n + 1, n + 4}})
        mesh.triangles.push_back(triangle);
    compare_at_vertices(mesh, 12, 1000);
}

TEST(LazyBeamScene, MakesBeamsOnceTheyPay) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const RayScene rays(mesh);
    const LazyBeamScene lazy(mesh, rays);
    lazy.prepare(mesh.num_triangles());
    EXPECT_FALSE(lazy.has_beams());
    lazy.prepare(100 * mesh.num_triangles());
    EXPECT_TRUE(lazy.has_beams());
}

TEST(BeamScene, NoTrianglesBlockNothing) {
    const mesh::TriangleMesh nothing;
    const auto exact = scenes::no_blockers();
    const BeamScene beams(nothing, exact, nullptr);
    const std::vector<glm::vec3> origins(5, glm::vec3(0.0f));
    const DirectionPatch patch = lattice_patch({.level = 3}, 8);
    std::vector<std::uint64_t> rays(5, all_of(patch));
    beams.clear_blocked({origins, {}}, patch, rays);
    EXPECT_EQ(rays, std::vector<std::uint64_t>(5, all_of(patch)));
}

/// The part of rays from above a floor that beams leave to the ray tracer.
double asked_part(const mesh::TriangleMesh& mesh, std::size_t crowded_shaft) {
    const RayScene rays(mesh);
    const scenes::CountingBlockers counting(rays);
    const BeamScene beams(mesh, counting, rays.see_through(), crowded_shaft);
    std::mt19937 random(13);
    std::size_t num_rays = 0;
    for (int round = 0; round < 300; ++round) {
        const std::vector<glm::vec3> origins(mesh.positions.begin() +
                                                 static_cast<std::ptrdiff_t>(random() % 900),
                                             mesh.positions.begin() + 1000);
        std::vector<glm::vec3> lifted;
        for (std::size_t i = 0; i < std::min(origins.size(), ReceiverGroup::MaxSize); ++i)
            lifted.push_back(origins[i] + glm::vec3(0.0137f, 0.001f, 0.0071f)); // off the edges
        const DirectionPatch patch = lattice_patch({.face = cubemap::Face::PositiveY,
                                                    .level = 4,
                                                    .x = static_cast<std::uint32_t>(random() % 16),
                                                    .y = static_cast<std::uint32_t>(random() % 16)},
                                                   8);
        std::vector<std::uint64_t> lit(lifted.size(), all_of(patch));
        num_rays += 64 * lifted.size();
        beams.clear_blocked({lifted, {0, 1, 0}}, patch, lit);
    }
    EXPECT_GT(num_rays, 1000000u);
    return static_cast<double>(counting.rays().size()) / static_cast<double>(num_rays);
}

// Otherwise the tests above would prove little.
TEST(BeamScene, AsksTheRayTracerOnlyWhereItMust) {
    EXPECT_LT(asked_part(things_on_a_floor(), BeamScene::CrowdedShaft), 0.01);
    EXPECT_LT(asked_part(things_on_a_floor(), 0), 0.01);
    EXPECT_LT(asked_part(scenes::with_card(things_on_a_floor(), scenes::leaf_card(16, 2.0f, 1.2f)),
                         BeamScene::CrowdedShaft),
              0.01);
}

// What the doubts of a fine mesh far from its receivers are: triangles a thousand times smaller
// than their distance.
TEST(BeamScene, AsksTheRayTracerRarelyOnFineMeshes) {
    const mesh::TriangleMesh fine =
        scenes::icosphere(6, 1.0f, glm::vec3(0.0f, 0.0f, 20.0f)); // edges of 0.02
    const RayScene rays(fine);
    const scenes::CountingBlockers counting(rays);
    const BeamScene beams(fine, counting, rays.see_through(), 0);
    std::mt19937 random(14);
    std::vector<glm::vec3> origins;
    for (std::size_t i = 0; i < ReceiverGroup::MaxSize; ++i)
        origins.push_back(0.05f * scenes::random_direction(random));
    std::size_t num_blocked = 0;
    for (int round = 0; round < 20; ++round) {
        DirectionPatch patch;
        while (!patch.full())
            patch.add(
                glm::normalize(glm::vec3(0.0f, 0.0f, 20.0f) + scenes::random_direction(random)));
        std::vector<std::uint64_t> lit(origins.size(), all_of(patch)), expected = lit;
        beams.clear_blocked({origins, {0, 0, 1}}, patch, lit);
        rays.clear_blocked({origins, {0, 0, 1}}, patch, expected);
        EXPECT_EQ(lit, expected);
        for (const std::uint64_t word : lit)
            num_blocked += static_cast<std::size_t>(64 - std::popcount(word));
    }
    EXPECT_GT(num_blocked, 100000u);
    EXPECT_LT(static_cast<double>(counting.rays().size()), 0.05 * static_cast<double>(num_blocked));
}

// From inside a fine sphere the shaft of a wide patch holds many triangles, and each direction few.
TEST(BeamScene, TracesCrowdedPatchesByDirectionHoweverWide) {
    const mesh::TriangleMesh fine = scenes::icosphere(6, 1.0f, glm::vec3(0.0f));
    const RayScene rays(fine);
    const scenes::CountingBlockers counting(rays);
    const BeamScene beams(fine, counting, rays.see_through(), 0);
    DirectionPatch patch;
    for (int i = 0; i < 64; ++i)
        patch.add(glm::normalize(
            glm::vec3(static_cast<float>(i % 8) - 3.5f, 8.0f, static_cast<float>(i / 8) - 3.5f)));
    std::mt19937 random(15);
    std::vector<glm::vec3> origins;
    for (std::size_t i = 0; i < ReceiverGroup::MaxSize; ++i)
        origins.push_back(0.01f * scenes::random_direction(random));
    std::vector<std::uint64_t> lit(origins.size(), all_of(patch)), expected = lit;
    beams.clear_blocked({origins, {0, 1, 0}}, patch, lit);
    EXPECT_LT(counting.rays().size(), origins.size() * 64 / 20);
    rays.clear_blocked({origins, {0, 1, 0}}, patch, expected);
    EXPECT_EQ(lit, expected);
}

TEST(BeamScene, ChangesNoTransfer) {
    const auto same = [](const mesh::TriangleMesh& mesh, const std::string& name) {
        const RayScene rays(mesh);
        const PrecomputeOptions options{
            .tolerance = 0.08f, .face_resolution = 64, .bias = automatic_bias(mesh)};
        const Transfer a = precompute(vertex_receivers(mesh), rays, options);
        for (const std::size_t crowded_shaft : {BeamScene::CrowdedShaft, std::size_t{0}}) {
            const BeamScene beams(mesh, rays, crowded_shaft);
            const Transfer b = precompute(vertex_receivers(mesh), beams, options);
            SCOPED_TRACE(name);
            expect_same(a, b);
        }
    };
    same(things_on_a_floor(), "things on a floor");
    const std::filesystem::path ugly = real_data("meshes/ugly");
    if (ugly.empty())
        GTEST_SKIP() << absent_data("meshes/ugly");
    int num_meshes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(ugly)) {
        mesh::TriangleMesh mesh;
        try {
            mesh = mesh::load(entry.path(), {.normals = mesh::NormalSource::Smooth});
        } catch (const std::exception&) {
            continue; // the reader's business
        }
        if (mesh.num_vertices() > 4000 || mesh.num_triangles() == 0)
            continue; // for time
        mesh::append_floor(mesh, 17, 3.0f);
        same(mesh, entry.path().filename().string());
        ++num_meshes;
    }
    EXPECT_GT(num_meshes, 15);
}

} // namespace
} // namespace relumine::prt
