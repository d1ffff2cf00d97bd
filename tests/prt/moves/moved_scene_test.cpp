// After a move, the counts are those of a fresh precompute with the same clusters, bit by bit.
#include "prt/moves/moved_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/normals.h"
#include "prt/bounces/bounce_precompute.h"
#include "prt/bounces/bounce_sampler.h"
#include "prt/moves/met_boxes.h"
#include "prt/moves/resampled_bounces.h"
#include "prt/precompute.h"
#include "prt/precompute_context.h"
#include "prt/scene/absent_groups.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/bias.h"
#include "prt/visibility/ray_scene.h"
#include "tests/own_folder.h"
#include "tests/prt/same_transfer.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

constexpr std::uint32_t Crate = 3;

/// A floor, a wall, a ball, a crate and a slab above, a group each.
mesh::TriangleMesh things() {
    mesh::TriangleMesh mesh;
    const auto add = [&](const std::string& name, const mesh::TriangleMesh& part) {
        mesh.triangle_groups.resize(mesh.num_triangles() + part.num_triangles(),
                                    static_cast<std::uint32_t>(mesh.groups.size()));
        mesh.groups.push_back(name);
        const std::vector<std::string> groups = mesh.groups;
        const std::vector<std::uint32_t> of_triangles = mesh.triangle_groups;
        mesh = scenes::joined(mesh, part);
        mesh.groups = groups;
        mesh.triangle_groups = of_triangles;
    };
    add("floor", scenes::floor_grid(17, 6.0f));
    add("wall", scenes::box({-3.3f, 0.0f, -3.4f}, {3.1f, 2.0f, -3.1f}));
    add("ball", scenes::icosphere(2, 0.5f, {1.0f, 0.6f, 0.5f}));
    add("crate", scenes::icosphere(1, 0.4f, {-1.0f, 0.5f, 0.5f}));
    add("slab", scenes::box({-1.5f, 1.5f, -1.0f}, {0.5f, 1.6f, 1.0f}));
    return mesh;
}

RecountOptions recount_options(const Scene& scene) {
    return {.face_resolution = 32, .bias = scene.settings.bias};
}

PrecomputeOptions options_of(const Scene& scene) {
    return {.tolerance = 0.05f, .min_level = 2, .face_resolution = 32, .bias = scene.settings.bias};
}

/// Calls `use` with what blocks the light of a scene: beams, which ask Embree.
void with_beams(const Scene& scene, const std::function<void(const Blockers&)>& use) {
    const RayScene rays(scene.blocking_mesh());
    use(BeamScene(scene.blocking_mesh(), rays));
}

Scene scene_of(mesh::TriangleMesh mesh) {
    Scene scene;
    scene.mesh = std::move(mesh);
    scene.receivers = vertex_receivers(scene.mesh);
    scene.settings = {.tolerance = 0.05f,
                      .min_level = 2,
                      .face_resolution = 32,
                      .bias = automatic_bias(scene.mesh),
                      .is_movable = true};
    with_beams(scene, [&](const Blockers& blockers) {
        scene.transfer = precompute(scene.receivers, blockers, options_of(scene));
    });
    return scene;
}

/// Makes a change of a group and returns what undoes it. `follow(group)`, called once it stands
/// there, returns what blocks the light.
template<typename Follow>
SceneChange make(Scene& scene, SceneChange change, const Follow& follow,
                 RecountStatistics* statistics = nullptr) {
    exchange(scene, change);
    const Blockers& blockers = follow(change.groups.front());
    CountsPatch counts = recounted(scene.receivers, blockers, scene.transfer, change.difference,
                                   recount_options(scene), {}, statistics);
    exchange(scene.transfer.counts, counts);
    change.counts = std::move(counts);
    return change;
}
SceneChange move(Scene& scene, std::uint32_t group, const glm::dmat4& matrix,
                 RecountStatistics* statistics = nullptr) {
    std::optional<RayScene> rays;
    std::optional<BeamScene> beams;
    const auto follow = [&](std::uint32_t) -> const Blockers& {
        rays.emplace(scene.blocking_mesh());
        return beams.emplace(scene.blocking_mesh(), *rays);
    };
    return make(scene, moved(scene, group, matrix), follow, statistics);
}

/// The transfer that a precompute of the scene finds for its clusters.
Transfer fresh(const Scene& scene) {
    Transfer result;
    with_beams(scene, [&](const Blockers& blockers) {
        result = precompute(scene.receivers, blockers, options_of(scene), {},
                            {.given = &scene.transfer, .has_clusters = true});
    });
    return result;
}

glm::dvec3 middle_of(const mesh::TriangleMesh& mesh, std::uint32_t group) {
    glm::dvec3 sum(0.0);
    double count = 0.0;
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        if (mesh.triangle_groups[i] == group)
            for (const std::uint32_t vertex : mesh.triangles[i]) {
                sum += glm::dvec3(mesh.positions[vertex]);
                count += 1.0;
            }
    return sum / count;
}

/// Turns a group about its middle and moves it.
glm::dmat4 motion(const Scene& scene, std::uint32_t group, const glm::dvec3& by,
                  double radians = 0.0, const glm::dvec3& axis = {0.0, 1.0, 0.0}) {
    const glm::dvec3 middle = middle_of(scene.mesh, group);
    const glm::dmat4 back = glm::translate(glm::dmat4(1.0), -middle);
    return glm::translate(glm::dmat4(1.0), middle + by) *
           glm::rotate(glm::dmat4(1.0), radians, axis) * back;
}

/// Small steps, jumps across the scene, turns, into contact with the floor, through each other.
glm::dmat4 random_motion(const Scene& scene, std::uint32_t group, std::mt19937& random) {
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    const double length = std::array{0.01, 0.2, 2.0, 6.0}[random() % 4];
    glm::dvec3 by = length * glm::dvec3(any(random), 0.3 * any(random), any(random));
    if (random() % 4 == 0) // sinks into the floor
        by.y = -middle_of(scene.mesh, group).y;
    if (random() % 4 == 0) // into another
        by = middle_of(scene.mesh, 1 + random() % 4) - middle_of(scene.mesh, group);
    return motion(scene, group, by, random() % 2 == 0 ? 0.0 : 3.0 * any(random),
                  glm::dvec3(scenes::random_direction(random)));
}

/// Moves things of a scene by accelerators that follow, and compares all counts each time.
void expect_fresh_counts(Scene scene, int num_moves) {
    RayScene rays(scene.mesh, RayScene::Packets::Narrow, RayScene::Groups::Move);
    BeamScene beams(scene.mesh, rays);
    std::mt19937 random(5);
    for (int i = 0; i < num_moves; ++i) {
        const auto group = static_cast<std::uint32_t>(1 + random() % 4);
        const glm::dmat4 matrix = random_motion(scene, group, random);
        RecountStatistics statistics;
        static_cast<void>(make(
            scene, moved(scene, group, matrix),
            [&](std::uint32_t moved) -> const Blockers& {
                rays.follow(scene.mesh, moved);
                beams.follow(scene.mesh, moved);
                return beams;
            },
            &statistics));
        EXPECT_LE(statistics.num_changed, statistics.num_pairs);
        SCOPED_TRACE(testing::Message() << "move " << i << " of group " << group);
        expect_same(scene.transfer, fresh(scene));
        if (testing::Test::HasFailure())
            return;
    }
}

TEST(MovedScene, CountsAreThoseOfAPrecomputeWithTheSameClusters) {
    expect_fresh_counts(scene_of(things()), 50);
}

TEST(MovedScene, CountsBehindWhatIsThinAreThoseOfAPrecompute) {
    mesh::TriangleMesh mesh = things();
    mesh.materials = {{.name = "stone"},
                      {.name = "veil", .alpha_mode = mesh::AlphaMode::Blend, .alpha = 0.4f}};
    for (const std::uint32_t group : mesh.triangle_groups)
        mesh.triangle_materials.push_back(group == Crate ? 1 : 0);
    expect_fresh_counts(scene_of(std::move(mesh)), 12);
}

TEST(MovedScene, RaysThatFollowAnswerAsNewOnesDo) {
    Scene scene = scene_of(things());
    RayScene rays(scene.mesh, RayScene::Packets::Narrow, RayScene::Groups::Move);
    std::mt19937 random(3);
    for (int i = 0; i < 8; ++i) {
        const auto group = static_cast<std::uint32_t>(1 + random() % 4);
        SceneChange change = moved(scene, group, random_motion(scene, group, random));
        exchange(scene, change);
        rays.follow(scene.mesh, group);
        const RayScene anew(scene.mesh);
        std::size_t num_hits = 0;
        for (int k = 0; k < 3000; ++k) {
            const glm::vec3 origin = 2.0f * scenes::random_direction(random);
            const glm::vec3 direction = scenes::random_direction(random);
            const auto hit = rays.closest_hit(origin, direction);
            const auto expected = anew.closest_hit(origin, direction);
            ASSERT_EQ(hit.has_value(), expected.has_value());
            EXPECT_EQ(rays.occluded(origin, direction), hit.has_value());
            if (!hit)
                continue;
            ++num_hits;
            EXPECT_EQ(hit->triangle, expected->triangle);
            EXPECT_EQ(hit->distance, expected->distance);
        }
        EXPECT_GT(num_hits, 500u);
    }
}

TEST(MetBoxes, ManyDirectionsAnswerAsOneDoes) {
    std::mt19937 random(8);
    std::size_t num_met = 0;
    for (int i = 0; i < 200; ++i) {
        std::vector<mesh::Bounds> boxes(random() % 5);
        for (mesh::Bounds& box : boxes) {
            box.min = 2.0f * scenes::random_direction(random);
            box.max = box.min + 2.0f * glm::abs(scenes::random_direction(random));
        }
        const glm::vec3 place = scenes::random_direction(random);
        const MetBoxes met(boxes, {place, place + 0.1f});
        InverseDirections many;
        std::vector<glm::vec3> directions;
        for (int k = 0; k < 100; ++k) {
            directions.push_back(k < 4 ? glm::vec3(k == 0, k == 1, k == 2 ? -1.0f : 0.0f)
                                       : scenes::random_direction(random));
            many.add(directions.back());
        }
        ASSERT_EQ(many.words().size(), 2u);
        const std::uint64_t asked = many.bits(1) & ~std::uint64_t{4};
        const std::array found = {met.meeting(many.words()[0], many.bits(0)),
                                  met.meeting(many.words()[1], asked)};
        for (std::size_t k = 0; k < directions.size(); ++k) {
            const bool is_met = (found[k / 64] >> k % 64 & 1u) != 0;
            EXPECT_EQ(is_met, k != 66 && met.meets(inverse(directions[k])));
            const float nearest = met.nearest(inverse(directions[k]));
            EXPECT_EQ(std::isfinite(nearest), met.meets(inverse(directions[k])));
            // Just before it there is no box.
            for (const mesh::Bounds& box : boxes)
                if (std::isfinite(nearest) && nearest > 0.01f) {
                    const glm::vec3 before = place + 0.99f * nearest * directions[k];
                    EXPECT_FALSE(glm::min(before, box.min) == box.min &&
                                 glm::max(before, box.max) == box.max);
                }
            num_met += is_met ? 1 : 0;
        }
        EXPECT_EQ(found[1] & ~asked, 0u);
    }
    EXPECT_GT(num_met, 500u);
}

TEST(MovedScene, WhatIsUnlitStaysUnlit) {
    Scene scene = scene_of(things());
    scene.receivers.surfaces.resize(scene.receivers.size());
    for (std::size_t i = 0; i < scene.mesh.num_triangles(); ++i)
        if (scene.mesh.groups[scene.mesh.triangle_groups[i]] == "ball")
            for (const std::uint32_t vertex : scene.mesh.triangles[i])
                scene.receivers.surfaces[vertex] = {.albedo = glm::vec3(0.0f),
                                                    .emission = glm::vec3(1.0f)};
    leave_unlit_out(scene.receivers);
    const std::vector<glm::vec3> normals = scene.receivers.normals;
    ASSERT_NE(normals, scene.mesh.normals);
    with_beams(scene, [&](const Blockers& blockers) {
        scene.transfer = precompute(scene.receivers, blockers, options_of(scene));
    });
    static_cast<void>(move(scene, Crate, motion(scene, Crate, {0.0, 0.0, 0.3})));
    for (std::size_t i = 0; i < normals.size(); ++i)
        EXPECT_EQ(scene.receivers.normals[i] == glm::vec3(0.0f), normals[i] == glm::vec3(0.0f));
    expect_same(scene.transfer, fresh(scene));
}

TEST(MovedScene, FewPairsAreCountedAnewAndThoseThatMustBe) {
    Scene scene = scene_of(things());
    const VisibleCounts before = scene.transfer.counts;
    RecountStatistics statistics;
    static_cast<void>(move(scene, Crate, motion(scene, Crate, {0.0, 0.0, 0.3}), &statistics));
    const std::uint64_t all = before.num_blocks() * before.num_leaves;
    EXPECT_LT(statistics.num_pairs, all / 2);
    EXPECT_GT(statistics.num_changed, 0u);
    EXPECT_NE(before.counts, scene.transfer.counts.counts);
}

TEST(MovedScene, ASecondExchangeUndoesAMoveBitByBit) {
    Scene scene = scene_of(things());
    const Transfer before = scene.transfer;
    const std::vector<glm::vec3> positions = scene.mesh.positions,
                                 of_receivers = scene.receivers.positions;
    SceneChange change = move(scene, Crate, motion(scene, Crate, {0.7, 0.0, 0.1}, 1.0));
    const Transfer after = scene.transfer;
    exchange(scene, change);
    expect_same(scene.transfer, before);
    EXPECT_EQ(scene.mesh.positions, positions);
    EXPECT_EQ(scene.receivers.positions, of_receivers);
    EXPECT_FALSE(scene.settings.rim_step.has_value());
    exchange(scene, change);
    expect_same(scene.transfer, after);
}

/// The crate's vertices where it bends: the higher, the farther it leans and turns.
std::vector<glm::dvec3> bent(const Scene& scene, double by) {
    std::vector<glm::dvec3> result;
    for (const std::uint32_t vertex : moved(scene, Crate, glm::dmat4(1.0)).vertices) {
        const glm::dvec3 at(scene.mesh.positions[vertex]);
        result.push_back(at + by * glm::dvec3(at.y, 0.0, 0.3 * at.y * at.y));
    }
    return result;
}

TEST(MovedScene, APoseHasTheCountsOfAPrecompute) {
    for (const bool has_blockers : {false, true}) {
        Scene scene = scene_of(things());
        if (has_blockers)
            scene.blockers = things();
        const Scene before = scene;
        std::optional<RayScene> rays;
        std::optional<BeamScene> beams;
        const auto follow = [&](std::uint32_t) -> const Blockers& {
            rays.emplace(scene.blocking_mesh());
            return beams.emplace(scene.blocking_mesh(), *rays);
        };
        SceneChange change = make(scene, posed(scene, Crate, bent(scene, 0.7)), follow);
        expect_same(scene.transfer, fresh(scene));
        EXPECT_EQ(scene.blocking_mesh().positions, scene.mesh.positions);
        // Receivers stand where those of such a mesh do.
        const Receivers expected = vertex_receivers(scene.mesh, *scene.settings.rim_step);
        EXPECT_EQ(scene.receivers.positions, expected.positions);
        EXPECT_EQ(scene.receivers.normals, scene.mesh.normals);
        const std::vector<glm::vec3> smooth = mesh::smooth_normals(scene.mesh);
        std::size_t num_turned = 0;
        for (std::size_t i = 0; i < smooth.size(); ++i)
            if (scene.mesh.normals[i] != before.mesh.normals[i]) {
                ++num_turned;
                EXPECT_GT(glm::dot(smooth[i], scene.mesh.normals[i]), 0.95f);
                EXPECT_NEAR(glm::length(scene.mesh.normals[i]), 1.0f, 1e-6f);
            }
        EXPECT_GT(num_turned, 20u);
        exchange(scene, change);
        expect_same(scene.transfer, before.transfer);
        EXPECT_EQ(scene.mesh.positions, before.mesh.positions);
        EXPECT_EQ(scene.mesh.normals, before.mesh.normals);
    }
}

TEST(MovedScene, AStiffPoseIsAMove) {
    const Scene scene = scene_of(things());
    const glm::dmat4 matrix = motion(scene, Crate, {0.5, 0.2, -0.4}, 0.5, {0.3, 1.0, 0.2});
    const SceneChange move = moved(scene, Crate, matrix);
    std::vector<glm::dvec3> vertices;
    for (const std::uint32_t vertex : move.vertices)
        vertices.emplace_back(matrix * glm::dvec4(scene.mesh.positions[vertex], 1.0));
    const SceneChange pose = posed(scene, Crate, vertices);
    EXPECT_EQ(pose.vertices, move.vertices);
    EXPECT_EQ(pose.positions, move.positions);
    EXPECT_EQ(pose.receivers, move.receivers);
    for (std::size_t i = 0; i < move.normals.size(); ++i)
        EXPECT_GT(glm::dot(pose.normals[i], move.normals[i]), 0.9f) << "round as it is";
}

TEST(MovedScene, RefusesPosesOfOtherMeshes) {
    Scene scene = scene_of(things());
    const auto refusal = [&](const std::vector<glm::dvec3>& vertices) -> std::string {
        try {
            static_cast<void>(posed(scene, Crate, vertices));
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    };
    std::vector<glm::dvec3> vertices = bent(scene, 0.5);
    EXPECT_EQ(refusal(vertices), "");
    const std::vector<glm::vec3> normals(vertices.size(), glm::vec3(0.0f, 1.0f, 0.0f));
    EXPECT_EQ(posed(scene, Crate, vertices, normals).receiver_normals, normals);
    EXPECT_THROW(static_cast<void>(posed(scene, Crate, vertices, std::span(normals).first(3))),
                 std::invalid_argument);
    vertices.pop_back();
    EXPECT_THAT(refusal(vertices), testing::HasSubstr("expected the 42 vertices of crate, got 41"));
    vertices = bent(scene, std::numeric_limits<double>::quiet_NaN());
    EXPECT_THAT(refusal(vertices), testing::HasSubstr("expected coordinates within"));
    vertices = bent(scene, 0.5);
    scene.blockers = things();
    scene.blockers->positions[scene.blockers->triangles.front()[0]].x += 1.0f;
    EXPECT_EQ(refusal(vertices), "") << "another group was refined";
    for (std::size_t i = 0; i < scene.blockers->num_triangles(); ++i)
        if (scene.blockers->triangle_groups[i] == Crate)
            scene.blockers->positions[scene.blockers->triangles[i][0]].x += 1.0f;
    EXPECT_THAT(refusal(vertices), testing::HasSubstr("got crate, which was refined"));
}

TEST(MovedScene, BlockersOfARefinedMeshMoveWithIt) {
    Scene scene = scene_of(things());
    scene.blockers = things();
    scene.blockers->normals.clear();
    static_cast<void>(move(scene, Crate, motion(scene, Crate, {0.5, 0.2, -0.4}, 0.5)));
    EXPECT_EQ(scene.blockers->positions, scene.mesh.positions);
    expect_same(scene.transfer, fresh(scene));
}

TEST(MovedScene, PointsStayAndSeeWhatMoves) {
    Scene scene;
    scene.mesh = things();
    for (int i = 0; i < 300; ++i)
        scene.receivers.positions.emplace_back(static_cast<float>(i % 10) - 4.5f,
                                               0.3f + static_cast<float>(i / 100),
                                               static_cast<float>(i / 10 % 10) - 4.5f);
    scene.receivers.normals.resize(300, glm::vec3(0.0f));
    scene.receivers.have_no_surface = true;
    PointLayout layout{.count = 300};
    for (std::uint32_t i = 0; i < 300; ++i)
        layout.indices.push_back(i);
    scene.layout = layout;
    scene.settings.bias = automatic_bias(scene.mesh);
    with_beams(scene, [&](const Blockers& blockers) {
        scene.transfer = precompute(scene.receivers, blockers, options_of(scene));
    });
    const VisibleCounts before = scene.transfer.counts;
    static_cast<void>(move(scene, Crate, motion(scene, Crate, {1.5, 0.0, 0.4})));
    EXPECT_NE(before.counts, scene.transfer.counts.counts);
    expect_same(scene.transfer, fresh(scene));
}

TEST(MovedScene, FarFromTheOriginAndFarOutside) {
    Scene scene = scene_of(scenes::transformed(things(), 1.0f, {500.0f, -300.0f, 800.0f}));
    scene.mesh.groups = things().groups;
    scene.mesh.triangle_groups = things().triangle_groups;
    static_cast<void>(move(scene, Crate, motion(scene, Crate, {0.5, 0.0, 0.5}, 1.0)));
    expect_same(scene.transfer, fresh(scene));
    static_cast<void>(move(scene, Crate, motion(scene, Crate, {90.0, 0.0, 0.0})));
    expect_same(scene.transfer, fresh(scene));
}

/// A scene of things whose light bounces, half of every hemisphere taken for open.
Scene bouncing_scene(const std::vector<float>& open) {
    Scene scene = scene_of(things());
    const RayScene rays(scene.mesh);
    const std::vector<ProbeRadiance> dark(open.size());
    std::vector<BounceSamples> samples;
    samples.push_back(sample_bounces(scene.mesh, scene.receivers, scene.transfer,
                                     {.open_parts = open, .values = dark, .index = {}}, rays,
                                     {.is_kept = true, .bias = scene.settings.bias}));
    scene.bounces = join_bounces(scene.receivers, scene.transfer, std::move(samples));
    return scene;
}

/// The matrix is what the samples that it has make.
void expect_joined(const Scene& scene, const std::vector<float>& open) {
    const BounceMatrix& own = *scene.bounces;
    std::vector<std::uint32_t> all(open.size());
    std::iota(all.begin(), all.end(), 0u);
    std::vector<BounceSamples> samples;
    samples.push_back({.open_parts = open,
                       .distances = own.rays.distances,
                       .num_directions = own.rays.num_directions,
                       .num_hits = own.rays.num_hits,
                       .emitters = own.emitters,
                       .averaged = shared_samples(scene.receivers, scene.transfer, 0, all.size(),
                                                  own.rays.distances, all)});
    const BounceMatrix joined = join_bounces(scene.receivers, scene.transfer, std::move(samples));
    EXPECT_EQ(own.averaged, joined.averaged);
    EXPECT_EQ(own.weights, joined.weights);
    EXPECT_NEAR(own.spectral_radius, joined.spectral_radius, 0.01f * joined.spectral_radius);
}

TEST(MovedScene, RowsOfBouncesAreThoseOfAllRays) {
    const std::vector<float> open(things().num_vertices(), 0.5f);
    Scene scene = bouncing_scene(open);
    ASSERT_TRUE(ResampledBounces::are_possible(scene));
    const BounceMatrix first = *scene.bounces;
    std::mt19937 random(9);
    std::size_t num_changed = 0;
    for (int i = 0; i < 8; ++i) {
        SCOPED_TRACE(testing::Message() << "move " << i);
        const auto group = static_cast<std::uint32_t>(2 + random() % 3);
        SceneChange change = i == 3   ? taken_away(scene, Crate)
                             : i == 4 ? brought_back(scene, Crate)
                                      : moved(scene, group, random_motion(scene, group, random));
        exchange(scene, change);
        CountsPatch counts;
        with_beams(scene, [&](const Blockers& blockers) {
            counts = recounted(scene.receivers, blockers, scene.transfer, change.difference,
                               recount_options(scene));
        });
        exchange(scene, change);
        const RayScene before(scene.mesh);
        ResampledBounces resampled({scene, open, before}, change.difference, counts, {});
        exchange(scene, change);
        exchange(scene.transfer.counts, counts);
        const RayScene now(scene.mesh);
        const BounceMatrix matrix_before = *scene.bounces;
        BouncesPatch patch = resampled.update(*scene.bounces, {scene, open, now}, {});
        const BounceMatrix updated = *scene.bounces;
        exchange(*scene.bounces, patch);
        EXPECT_TRUE(*scene.bounces == matrix_before);
        exchange(*scene.bounces, patch);
        EXPECT_TRUE(*scene.bounces == updated);
        expect_joined(scene, open);

        const BounceOptions options{.bias = scene.settings.bias};
        const BounceProbes probes{.open_parts = open, .values = {}, .index = {}};
        const BounceSampler sampler(scene.mesh, scene.receivers, scene.transfer, probes, now,
                                    options);
        const BounceRays& rays = scene.bounces->rays;
        for (std::size_t place = 0; place < open.size(); ++place) {
            RayHits hits;
            sampler.look({.place = place, .index = place}, rays.num_directions[place], hits);
            std::vector<std::uint32_t> row = hits.halves[0];
            row.insert(row.end(), hits.halves[1].begin(), hits.halves[1].end());
            EXPECT_EQ(rays.num_hits[place], row.size());
            std::erase(row, NoEmitter);
            std::ranges::sort(row);
            ASSERT_TRUE(std::ranges::equal(scene.bounces->emitters[place], row)) << place;
            num_changed += std::ranges::equal(first.emitters[place], row) ? 0 : 1;
            RayHits look;
            sampler.look({.place = place, .index = place}, options.min_directions, look);
            const float distance = look.num_hits() == 0 ? 0.0f : look.distance();
            EXPECT_NEAR(rays.distances[place], distance, 1e-3f * distance);
        }
    }
    EXPECT_GT(num_changed, 100u);
}

/// A scene whose groups are taken away and brought back, with what traces its rays.
class Vanishing {
public:
    explicit Vanishing(Scene scene) : scene_(std::move(scene)) {}

    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] Transfer transfer() const { return scene_.transfer; }
    SceneChange take_away(std::uint32_t group) { return make(taken_away(scene_, group)); }
    SceneChange bring_back(std::uint32_t group) { return make(brought_back(scene_, group)); }
    void undo(SceneChange change) {
        exchange(scene_, change);
        static_cast<void>(followed(change.groups.front()));
    }
    /// The transfer of the mesh that has not these triangles at all, for the same receivers.
    [[nodiscard]] Transfer of_rest(const std::vector<std::uint32_t>& groups) const {
        Scene rest = scene_;
        rest.blockers.reset();
        rest.mesh = things();
        std::vector<mesh::Triangle> triangles;
        for (std::size_t i = 0; i < rest.mesh.num_triangles(); ++i)
            if (!std::ranges::count(groups, rest.mesh.triangle_groups[i]))
                triangles.push_back(rest.mesh.triangles[i]);
        rest.mesh.triangles = triangles;
        rest.mesh.triangle_groups.clear();
        return fresh(rest);
    }

private:
    SceneChange make(SceneChange change) {
        return prt::make(scene_, std::move(change),
                         [&](std::uint32_t group) -> const Blockers& { return followed(group); });
    }
    const Blockers& followed(std::uint32_t group) {
        rays_.follow(scene_.mesh, group);
        beams_.follow(scene_.mesh, group);
        return beams_;
    }

    Scene scene_;
    RayScene rays_{scene_.mesh, RayScene::Packets::Narrow, RayScene::Groups::Move};
    BeamScene beams_{scene_.mesh, rays_};
};

TEST(MovedScene, WhatIsTakenAwayHidesNothingAndComesBack) {
    Vanishing own(scene_of(things()));
    const Transfer before = own.transfer();
    const std::vector<mesh::Triangle> triangles = own.scene().mesh.triangles;
    own.take_away(Crate);
    const Transfer without = own.transfer();
    EXPECT_NE(without.counts.counts, before.counts.counts);
    expect_same(without, fresh(own.scene()));
    expect_same(without, own.of_rest({Crate}));
    SceneChange of_ball = own.take_away(2);
    expect_same(own.transfer(), own.of_rest({Crate, 2}));
    EXPECT_THAT(absent_names(own.scene()), testing::ElementsAre("crate", "ball"));
    own.undo(std::move(of_ball));
    expect_same(own.transfer(), without);
    EXPECT_THAT(absent_names(own.scene()), testing::ElementsAre("crate"));
    own.bring_back(Crate);
    expect_same(own.transfer(), before);
    EXPECT_EQ(own.scene().mesh.triangles, triangles);
    EXPECT_TRUE(own.scene().absent.empty());
}

TEST(MovedScene, BlockersOfARefinedMeshGoAwayWithIt) {
    Scene scene = scene_of(things());
    scene.blockers = things();
    scene.blockers->normals.clear();
    std::optional<RayScene> rays;
    std::optional<BeamScene> beams;
    const auto follow = [&](std::uint32_t) -> const Blockers& {
        rays.emplace(*scene.blockers);
        return beams.emplace(*scene.blockers, *rays);
    };
    const Transfer before = scene.transfer;
    static_cast<void>(make(scene, taken_away(scene, Crate), follow));
    EXPECT_NE(scene.transfer.counts.counts, before.counts.counts);
    expect_same(scene.transfer, fresh(scene));
    EXPECT_EQ(scene.blockers->triangles, scene.mesh.triangles);
    static_cast<void>(make(scene, brought_back(scene, Crate), follow));
    expect_same(scene.transfer, before);
    EXPECT_EQ(scene.blockers->triangles, things().triangles);
}

using MovedSceneFile = tests::FolderTest;

TEST_F(MovedSceneFile, KeepsWhatIsAway) {
    const std::filesystem::path path = folder_ / "away.prt";
    Scene scene = scene_of(things());
    scene.blockers = things();
    Vanishing first(scene);
    first.take_away(Crate);
    save_scene(path, first.scene());
    Vanishing own(load_scene(path));
    EXPECT_EQ(own.scene().mesh.triangles, first.scene().mesh.triangles);
    EXPECT_EQ(own.scene().receivers.positions, scene.receivers.positions);
    expect_same(own.transfer(), first.transfer());
    own.bring_back(Crate);
    expect_same(own.transfer(), scene.transfer);
    EXPECT_EQ(own.scene().mesh.triangles, scene.mesh.triangles);
    EXPECT_EQ(own.scene().blockers->triangles, scene.blockers->triangles);
}

TEST_F(MovedSceneFile, KeepsThePlace) {
    Scene scene = scene_of(things());
    static_cast<void>(move(scene, Crate, motion(scene, Crate, {20.0, 0.0, 0.1}, 1.0)));
    const std::filesystem::path path = folder_ / "moved.prt";
    save_scene(path, scene);
    Scene loaded = load_scene(path);
    EXPECT_EQ(loaded.mesh.groups, scene.mesh.groups);
    EXPECT_EQ(loaded.mesh.triangle_groups, scene.mesh.triangle_groups);
    EXPECT_EQ(loaded.receivers.positions, scene.receivers.positions);
    expect_same(loaded.transfer, fresh(loaded));
    static_cast<void>(move(loaded, Crate, motion(loaded, Crate, {-20.0, 0.0, 0.0})));
    expect_same(loaded.transfer, fresh(loaded));
    // Who does not ask gets no groups.
    scene.settings.is_movable = false;
    scene.settings.rim_step = {};
    save_scene(path, scene);
    EXPECT_TRUE(load_scene(path).mesh.groups.empty());
}

TEST(MovedScene, RefusesToMoveWhatIsAway) {
    Vanishing own(scene_of(things()));
    const auto refusal = [&](auto change_of) -> std::string {
        try {
            static_cast<void>(change_of(own.scene(), Crate));
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refusal(brought_back),
              "expected a group that was taken away, got crate, which is there");
    own.take_away(Crate);
    const std::string is_away = "expected a group that is there, got crate, which was taken away";
    EXPECT_EQ(refusal(taken_away), is_away);
    EXPECT_EQ(refusal([](const Scene& scene, std::uint32_t group) {
                  return moved(scene, group, glm::dmat4(1.0));
              }),
              is_away);
}

void expect_refusal(const Scene& scene, const glm::dmat4& matrix, const std::string& text,
                    std::uint32_t group = Crate) {
    try {
        static_cast<void>(moved(scene, group, matrix));
        ADD_FAILURE() << "expected a refusal: " << text;
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr(text));
    }
}

TEST(MovedScene, RefusesWhatCannotBeMoved) {
    Scene scene = scene_of(things());
    glm::dmat4 matrix(1.0);
    matrix[3][0] = std::numeric_limits<double>::quiet_NaN();
    expect_refusal(scene, matrix, "finite numbers");
    expect_refusal(scene, glm::scale(glm::dmat4(1.0), {1.0, 0.0, 1.0}), "singular");
    expect_refusal(scene, glm::scale(glm::dmat4(1.0), {1.0, -1.0, 1.0}), "mirrors");
    expect_refusal(scene, glm::dmat4(0.0), "last row");
    expect_refusal(scene, glm::translate(glm::dmat4(1.0), {1e30, 0.0, 0.0}), "coordinates within");
    scene.settings.floor_vertices = 3;
    expect_refusal(scene, glm::dmat4(1.0), "added floor", 4);
    scene.mesh.triangle_groups.back() = 0;
    expect_refusal(scene, glm::dmat4(1.0), "shares some with", 0);
    scene.receivers.to_eye.resize(scene.receivers.size(), {0.0f, 1.0f, 0.0f});
    expect_refusal(scene, glm::dmat4(1.0), "fixed view");
    scene.receivers.to_eye.clear();
    scene.mesh.triangle_groups.clear();
    expect_refusal(scene, glm::dmat4(1.0), "--movable");
}

} // namespace
} // namespace relumine::prt
