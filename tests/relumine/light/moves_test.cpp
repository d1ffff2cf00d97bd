// Groups that move in a scene that is lit: the light follows, and goes back.
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_gen/environments.h"
#include "mesh/normals.h"
#include "prt/precompute.h"
#include "prt/precompute_context.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relumine/in/drag.h"
#include "relumine/light/scene_moves.h"
#include "relumine/relumine.h"
#include "tests/own_folder.h"
#include "tests/prt/same_transfer.h"
#include "tests/prt/scenes.h"

namespace relumine {
namespace {

using testing::HasSubstr;

/// A floor, a ball, and a lamp above it.
mesh::TriangleMesh things(bool has_lamp = true) {
    mesh::TriangleMesh mesh = scenes::floor_grid(21, 6.0f);
    const auto add = [&](const mesh::TriangleMesh& part) {
        const std::uint32_t group =
            mesh.triangle_groups.empty() ? 0 : mesh.triangle_groups.back() + 1;
        mesh::TriangleMesh joined = scenes::joined(mesh, part);
        joined.triangle_groups = mesh.triangle_groups;
        joined.triangle_groups.resize(joined.num_triangles(), group);
        mesh = std::move(joined);
    };
    mesh.triangle_groups.resize(mesh.num_triangles(), 0);
    add(scenes::icosphere(3, 0.6f, {0.8f, 0.7f, 0.3f}));
    mesh.groups = {"ground", "ball"};
    if (has_lamp) {
        add(scenes::box({-1.2f, 1.5f, -0.3f}, {-0.9f, 1.7f, 0.3f}));
        mesh.groups.emplace_back("lamp");
    }
    mesh.materials = {{.name = "grey", .base_color = glm::vec3(0.5f)},
                      {.name = "bulb", .emission = {4, 3, 2}}};
    for (const std::uint32_t group : mesh.triangle_groups)
        mesh.triangle_materials.push_back(group == 2 ? 1 : 0);
    return mesh;
}

const PrecomputeOptions Options{.tolerance = 0.04f,
                                .min_level = 2,
                                .face_resolution = 64,
                                .no_refine = true,
                                .bounce_tolerance = 0.03f,
                                .movable = true};

const Scene& before() {
    static const Scene scene = precompute(things(), Options);
    return scene;
}

/// What lights a scene.
struct Lit {
    bool has_sky = true, has_list = true, has_layer = true, has_bounces = true;
    std::uint32_t harmonics = 0;
};

/// A sky with a sharp sun, a layer over it, a distant light, dimmed lamps, and bounces; or some of
/// these.
void light(LitScene& lit, const Lit& how = {}) {
    lit.dim({{.name = "lamp", .gain = glm::vec3(0.5f)}});
    Light light;
    if (how.has_sky)
        light.environment = data_gen::sun_and_sky(64);
    if (how.has_list)
        light.lights = {{.direction = glm::normalize(glm::dvec3(-1.0, 1.0, 0.2)),
                         .irradiance = glm::dvec3(0.5, 0.1, 0.1)}};
    lit.light(std::move(light));
    if (how.has_layer) {
        set_layers(
            lit, {{.name = "key",
                   .region = cubemap::Disc{.direction = {0.0f, 1.0f, 0.3f}, .radius_degrees = 20.0},
                   .effect = cubemap::Gain{.tint = glm::vec3(3.0f)}}});
        mark(lit); // the light is that of the state, whichever edits led to it
    }
    if (how.has_bounces)
        lit.bounce({.albedo = bounce_albedo(lit.scene())});
}

std::vector<glm::vec3> radiance_of(const LitScene& lit) {
    return {lit.radiance().begin(), lit.radiance().end()};
}

const GroupStep Step{.name = "ball", .by = {-1.5, 0.1, 0.2}, .degrees = 30.0};

/// Several moves, undone and made again: each time all light is that of another LitScene.
void expect_that_light_follows(const Lit& how) {
    const LightOptions options{.harmonics = how.harmonics};
    LitScene lit(before(), options);
    light(lit, how);
    Scene scene = before();
    std::vector<std::vector<glm::vec3>> seen = {radiance_of(lit)};
    for (const GroupStep& step :
         {Step, GroupStep{.name = "lamp", .by = {1.0, -0.2, 0.5}, .degrees = 70.0},
          GroupStep{.name = "ball", .by = {0.1, -0.3, 0.0}}}) {
        MoveReport report = lit.moves().move(move_of(lit.scene(), step));
        EXPECT_GT(report.num_moved, 0u);
        EXPECT_LT(report.counts.num_pairs, report.num_all);
        EXPECT_EQ(lit.environment().state().layers.size(), how.has_layer ? 1u : 0u);
        move(scene, move_of(scene, step));
        LitScene anew(scene, options);
        light(anew, how);
        EXPECT_EQ(radiance_of(lit), radiance_of(anew));
        EXPECT_NE(radiance_of(lit), seen.back());
        EXPECT_EQ(lit.lighting().soft, anew.lighting().soft);
        if (how.harmonics != 0) {
            EXPECT_EQ(lit.harmonics(), anew.harmonics());
        }
        seen.push_back(radiance_of(lit));
    }
    for (std::size_t i = seen.size(); --i > 0;) {
        EXPECT_EQ(radiance_of(lit), seen[i]);
        EXPECT_TRUE(lit.moves().undo());
    }
    EXPECT_FALSE(lit.moves().undo());
    EXPECT_EQ(radiance_of(lit), seen[0]);
    EXPECT_TRUE(lit.moves().redo());
    EXPECT_EQ(radiance_of(lit), seen[1]);
}

TEST(Moves, TheLightIsThatOfTheMovedScene) {
    expect_that_light_follows({});
}

TEST(Moves, EachLightFollowsByItself) {
    constexpr Lit Sky{.has_list = false, .has_layer = false, .has_bounces = false};
    expect_that_light_follows(Sky);
    Lit how = Sky;
    how.has_layer = true;
    expect_that_light_follows(how);
    how = Sky;
    how.has_bounces = true;
    expect_that_light_follows(how);
    how = Sky;
    how.harmonics = 2;
    expect_that_light_follows(how);
    how = Sky;
    how.has_sky = false;
    how.has_list = true;
    expect_that_light_follows(how);
}

TEST(Moves, LightThatWasUpdatedIsSummedAnew) {
    const auto lit_after_edits = [](LitScene& lit) {
        lit.light(data_gen::sun_and_sky(64));
        for (const float tint : {1e5f, 1.5f})
            set_layers(lit, {{.name = "key",
                              .region = cubemap::Disc{.direction = {0.3f, 1.0f, 0.3f},
                                                      .radius_degrees = 40.0},
                              .effect = cubemap::Gain{.tint = glm::vec3(tint)}}});
    };
    LitScene lit(before());
    lit_after_edits(lit);
    lit.moves().move(move_of(lit.scene(), Step));
    Scene scene = before();
    move(scene, move_of(scene, Step));
    LitScene anew(std::move(scene));
    lit_after_edits(anew);
    mark(anew);
    EXPECT_EQ(radiance_of(lit), radiance_of(anew));
}

template<typename Call>
std::string refusal(const Call& call) {
    try {
        call();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

/// Relative L2
double difference(const std::vector<glm::vec3>& found, const std::vector<glm::vec3>& expected) {
    double sum = 0.0, of_all = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const glm::dvec3 a(found[i]), b(expected[i]);
        sum += glm::dot(a - b, a - b);
        of_all += glm::dot(b, b);
    }
    return std::sqrt(sum / of_all);
}

bool are_same(const prt::VisibleCounts& a, const prt::VisibleCounts& b) {
    return a.visible == b.visible && a.mixed == b.mixed && a.mixed_before == b.mixed_before &&
           a.counts == b.counts;
}

const std::vector<GroupStep> Way = {{.name = "ball", .by = {-0.4, 0.0, 0.1}},
                                    {.name = "ball", .by = {-1.0, 0.3, 0.3}, .degrees = 40.0},
                                    {.name = "ball", .by = {1.2, -0.2, -0.5}, .degrees = 90.0}};

/// The radiance without bounces.
std::vector<glm::vec3> direct_of(const LitScene& lit) {
    std::vector<glm::vec3> result = radiance_of(lit);
    const std::vector<glm::vec3> further = relumine::bounced(lit);
    for (std::size_t i = 0; i < further.size(); ++i)
        result[i] -= further[i];
    return result;
}

/// What is shown on the way of a drag is close to what moves there show but for bounces, which
/// stay, and a drop is a move.
void expect_that_drags_are_moves(Lit how) {
    constexpr double Most = 0.02;
    LitScene lit(before());
    light(lit, how);
    const std::vector<glm::vec3> at_first = radiance_of(lit), direct_at_first = direct_of(lit),
                                 bounced_at_first = relumine::bounced(lit);
    EXPECT_EQ(bounced_at_first.empty(), !how.has_bounces);
    for (const GroupStep& step : Way) {
        const GroupMove to = move_of(before(), step);
        EXPECT_GT(lit.moves().drag(to).num_moved, 0u);
        LitScene moved(before());
        light(moved, how);
        moved.moves().move(to);
        EXPECT_LT(difference(direct_of(lit), direct_of(moved)), Most);
        EXPECT_GT(difference(direct_of(lit), direct_at_first), 2.0 * Most);
        EXPECT_EQ(relumine::bounced(lit), bounced_at_first);
    }
    const GroupMove last = move_of(before(), Way.back());
    const MoveReport report = lit.moves().drop();
    EXPECT_GT(report.counts.num_pairs, 0u);
    LitScene moved(before());
    light(moved, how);
    moved.moves().move(last);
    EXPECT_EQ(radiance_of(lit), radiance_of(moved));
    EXPECT_TRUE(are_same(lit.scene().transfer.counts, moved.scene().transfer.counts));
    EXPECT_EQ(lit.scene().mesh.positions, moved.scene().mesh.positions);
    Scene scene = before();
    move(scene, last);
    LitScene anew(std::move(scene));
    light(anew, how);
    EXPECT_EQ(radiance_of(lit), radiance_of(anew));
    EXPECT_TRUE(lit.moves().undo());
    EXPECT_EQ(radiance_of(lit), at_first);
    EXPECT_FALSE(lit.moves().undo());
}

TEST(Moves, ADragIsAboutTheMoveAndADropIsTheMove) {
    constexpr Lit Sky{.has_list = false, .has_layer = false, .has_bounces = false}, All;
    expect_that_drags_are_moves(Sky);
    expect_that_drags_are_moves(All);
}

TEST(Moves, ADragOverAnOpenFloorCountsAsAMove) {
    PrecomputeOptions options = Options;
    options.bounce_tolerance = 0.0f;
    const Scene first = precompute(things(false), options);
    Scene scene = first;
    SceneRays rays(scene);
    GroupDrag drag(scene, rays, move_of(first, Way.front()));
    for (const GroupStep& step : Way) {
        const GroupMove to = move_of(first, step);
        MoveReport report;
        static_cast<void>(drag.to(to.matrix, {}, report));
        Scene moved = first;
        move(moved, to);
        EXPECT_TRUE(are_same(scene.transfer.counts, moved.transfer.counts));
        EXPECT_EQ(scene.transfer.normals, moved.transfer.normals);
    }
    static_cast<void>(drag.back());
    EXPECT_TRUE(are_same(scene.transfer.counts, first.transfer.counts));
    EXPECT_EQ(scene.mesh.positions, first.mesh.positions);
    EXPECT_EQ(scene.receivers.positions, first.receivers.positions);
}

TEST(Moves, ADragKnowsItsPlaceAlone) {
    LitScene one(before()), other(before());
    const Lit how{.has_bounces = false};
    light(one, how);
    light(other, how);
    for (const GroupStep& step : Way)
        one.moves().drag(move_of(before(), step));
    other.moves().drag(move_of(before(), Way.back()));
    EXPECT_TRUE(are_same(one.scene().transfer.counts, other.scene().transfer.counts));
    EXPECT_EQ(radiance_of(one), radiance_of(other));
}

TEST(Moves, ADragIsTakenBack) {
    LitScene lit(before());
    light(lit);
    const std::vector<glm::vec3> at_first = radiance_of(lit);
    const auto drag = [&] {
        lit.moves().drag(move_of(before(), Way[1]));
        EXPECT_NE(radiance_of(lit), at_first);
    };
    const auto expect_back = [&] {
        EXPECT_EQ(radiance_of(lit), at_first);
        EXPECT_TRUE(are_same(lit.scene().transfer.counts, before().transfer.counts));
        EXPECT_EQ(lit.scene().mesh.positions, before().mesh.positions);
    };
    drag();
    EXPECT_TRUE(lit.moves().undo());
    expect_back();
    EXPECT_FALSE(lit.moves().undo());
    EXPECT_THROW(lit.moves().drop(), std::logic_error);

    // A matrix that is refused leaves the group where it was dragged to.
    drag();
    EXPECT_THAT(refusal([&] { lit.moves().drag({.name = "ball", .matrix = glm::dmat4(0.0)}); }),
                HasSubstr("last row"));
    EXPECT_THAT(refusal([&] { lit.moves().drag({.name = "bal"}); }),
                HasSubstr("did you mean ball?"));
    std::stop_source stop;
    stop.request_stop();
    drag();
    EXPECT_THROW(lit.moves().drop({.stop = stop.get_token()}), prt::Cancelled);
    expect_back();

    // Another group's drag, and a move, begin where the group stood.
    drag();
    const GroupMove of_lamp =
        move_of(before(), {.name = "lamp", .by = {0.5, 0.0, 0.5}, .degrees = 20.0});
    lit.moves().drag(of_lamp);
    drag();
    lit.moves().move(of_lamp);
    LitScene moved(before());
    light(moved);
    moved.moves().move(of_lamp);
    EXPECT_EQ(radiance_of(lit), radiance_of(moved));
}

TEST(Moves, TheLightIsThatWithoutWhatIsTakenAway) {
    LitScene lit(before());
    light(lit);
    const std::vector<glm::vec3> at_first = radiance_of(lit);
    const double of_lamps = glm::length(lit.lamps().direct()[0]);
    EXPECT_GT(of_lamps, 0.0);
    Scene scene = before();
    std::vector<std::vector<glm::vec3>> seen = {at_first};
    for (const GroupStep& step : {GroupStep{.name = "ball", .going = Going::Away},
                                  GroupStep{.name = "lamp", .going = Going::Away},
                                  GroupStep{.name = "ball", .going = Going::Back}}) {
        EXPECT_EQ(lit.moves().move(move_of(lit.scene(), step)).num_moved, 0u);
        move(scene, move_of(scene, step));
        LitScene anew(scene);
        light(anew);
        EXPECT_EQ(radiance_of(lit), radiance_of(anew));
        EXPECT_NE(radiance_of(lit), seen.back());
        seen.push_back(radiance_of(lit));
    }
    for (const glm::vec3& of_lamp : lit.lamps().direct())
        EXPECT_EQ(of_lamp, glm::vec3(0.0f));
    for (std::size_t i = seen.size(); --i > 0;) {
        EXPECT_EQ(radiance_of(lit), seen[i]);
        EXPECT_TRUE(lit.moves().undo());
    }
    EXPECT_EQ(radiance_of(lit), at_first);

    // The light of the receivers that are there is that of a mesh without the ball.
    mesh::TriangleMesh rest = things();
    std::vector<std::uint32_t> materials, groups;
    std::vector<mesh::Triangle> triangles;
    for (std::size_t i = 0; i < rest.num_triangles(); ++i)
        if (rest.triangle_groups[i] != 1) {
            triangles.push_back(rest.triangles[i]);
            materials.push_back(rest.triangle_materials[i]);
            groups.push_back(rest.triangle_groups[i]);
        }
    rest.triangles = triangles;
    rest.triangle_materials = materials;
    rest.triangle_groups = groups;
    constexpr Lit Sky{.has_list = false, .has_layer = false, .has_bounces = false};
    PrecomputeOptions options = Options;
    options.movable = false;
    options.tolerance = 0.01f;
    LitScene without(precompute(rest, options));
    light(without, Sky);
    light(lit, Sky);
    lit.moves().move({.name = "ball", .going = Going::Away});
    const auto on_ground = [](const LitScene& of) {
        const std::vector<glm::vec3> all = radiance_of(of);
        return std::vector(all.begin(), all.begin() + 21 * 21);
    };
    const double wrong = difference(on_ground(lit), on_ground(without));
    lit.moves().undo();
    EXPECT_LT(1.5 * wrong, difference(on_ground(lit), on_ground(without)));
}

TEST(Moves, TheLightIsAboutThatOfAPrecomputeAnew) {
    LitScene lit(before());
    light(lit);
    for (const GroupStep& step :
         {Step, GroupStep{.name = "lamp", .by = {1.0, -0.2, 0.5}, .degrees = 70.0}})
        lit.moves().move(move_of(lit.scene(), step));
    mesh::TriangleMesh mesh = lit.scene().mesh;
    LitScene anew(precompute(std::move(mesh), Options));
    light(anew);
    EXPECT_LT(difference(radiance_of(lit), radiance_of(anew)), 0.05);
}

/// A floor, a crate that stands on it, and a ball with lifts that lead into the floor.
mesh::TriangleMesh touching_things() {
    mesh::TriangleMesh mesh = scenes::floor_grid(21, 6.0f);
    const std::size_t num_floor = mesh.num_triangles();
    const auto crate = scenes::box({-0.53f, 0.0f, -0.47f}, {0.49f, 1.0f, 0.51f});
    mesh = scenes::joined(mesh, crate);
    const std::size_t num_vertices = mesh.num_vertices();
    mesh = scenes::joined(mesh, scenes::icosphere(3, 0.5f, {-2.0f, 0.505f, 0.0f}));
    mesh.triangle_groups.resize(num_floor, 0);
    mesh.triangle_groups.resize(num_floor + crate.num_triangles(), 1);
    mesh.triangle_groups.resize(mesh.num_triangles(), 2);
    mesh.groups = {"ground", "crate", "ball"};
    mesh.lifts.resize(num_vertices, glm::vec3(0.0f));
    for (std::size_t i = num_vertices; i < mesh.num_vertices(); ++i)
        mesh.lifts.push_back(0.02f * mesh.normals[i]);
    return mesh;
}

/// Expects places that are the same but for roundings. The bias is a hundred times as large.
void expect_near(const std::vector<glm::vec3>& places, const std::vector<glm::vec3>& expected) {
    ASSERT_EQ(places.size(), expected.size());
    for (std::size_t i = 0; i < places.size(); ++i)
        EXPECT_LT(glm::distance(places[i], expected[i]), 1e-5f) << i;
}

/// Moves a group and expects receivers where a precompute has them, and counts of such a one with
/// the same clusters.
void expect_places_of_a_precompute(Scene& scene, const PrecomputeOptions& options,
                                   const GroupStep& step) {
    move(scene, move_of(scene, step));
    mesh::TriangleMesh mesh = touching_things();
    mesh.uvs = scene.mesh.uvs;
    mesh.positions = scene.mesh.positions;
    PrecomputeOptions fixed = options;
    fixed.bias = scene.settings.bias;
    const Scene anew = precompute(std::move(mesh), fixed);
    expect_near(scene.receivers.positions, anew.receivers.positions);
    expect_near(scene.mesh.lifts, anew.mesh.lifts);
    const prt::RayScene rays(scene.blocking_mesh());
    const prt::BeamScene beams(scene.blocking_mesh(), rays);
    const prt::PrecomputeOptions same{.tolerance = *options.tolerance,
                                      .min_level = options.min_level,
                                      .face_resolution = options.face_resolution,
                                      .bias = scene.settings.bias};
    prt::expect_same(scene.transfer,
                     prt::precompute(scene.receivers, beams, same, {},
                                     {.given = &scene.transfer, .has_clusters = true}));
}

PrecomputeOptions without_bounces() {
    PrecomputeOptions options = Options;
    options.bounce_tolerance = 0.0f;
    return options;
}

/// Receivers that look from inside of the floor
std::ptrdiff_t num_inside(const Scene& scene) {
    return std::ranges::count_if(scene.receivers.positions,
                                 [](const glm::vec3& place) { return place.y < 0.0f; });
}

TEST(Moves, WhatWasTouchedLooksFromItsOwnPlaceAgain) {
    const PrecomputeOptions options = without_bounces();
    Scene scene = precompute(touching_things(), options);
    const std::vector<glm::vec3> places = scene.receivers.positions, lifts = scene.mesh.lifts;
    EXPECT_EQ(num_inside(scene), 9) << "below the crate";
    EXPECT_FALSE(scene.free_lifts.empty()) << "some of the ball's lead into the floor";
    for (const GroupStep& step : {GroupStep{.name = "crate", .by = {1.53, 0.0, 0.22}},
                                  GroupStep{.name = "ball", .by = {0.0, 0.5, 0.0}},
                                  GroupStep{.name = "crate", .by = {-1.53, 0.0, -0.22}},
                                  GroupStep{.name = "ball", .by = {0.0, -0.5, 0.0}}})
        expect_places_of_a_precompute(scene, options, step);
    expect_near(scene.receivers.positions, places);
    expect_near(scene.mesh.lifts, lifts);
    move(scene, {.name = "crate", .going = Going::Away});
    EXPECT_EQ(num_inside(scene), 0);
    move(scene, {.name = "crate", .going = Going::Back});
    expect_near(scene.receivers.positions, places);
}

TEST(Moves, TexelsThatWereTouchedLookFromTheirOwnPlaceAgain) {
    PrecomputeOptions options = without_bounces();
    options.receivers = Texels{.width = 20, .height = 20};
    mesh::TriangleMesh mesh = touching_things();
    mesh.uvs.resize(mesh.num_vertices(), glm::vec2(0.0f));
    for (std::size_t i = 0; i < 21 * 21; ++i)
        mesh.uvs[i] = glm::vec2(mesh.positions[i].x, mesh.positions[i].z) / 6.0f + 0.5f;
    Scene scene = precompute(mesh, options);
    ASSERT_EQ(scene.receivers.size(), 400u);
    EXPECT_GT(num_inside(scene), 8);
    expect_places_of_a_precompute(scene, options, {.name = "crate", .by = {1.53, 0.0, 0.22}});
    move(scene, {.name = "crate", .going = Going::Away});
    EXPECT_EQ(num_inside(scene), 0);
}

TEST(Moves, WhatIsTouchedFollowsADrag) {
    LitScene lit(precompute(touching_things(), without_bounces()));
    lit.light(data_gen::sun_and_sky(64));
    const Scene scene = lit.scene();
    const std::vector<glm::vec3> light = radiance_of(lit);
    constexpr std::size_t BelowTheCrate = 10 * 21 + 10;
    EXPECT_EQ(light[BelowTheCrate], glm::vec3(0.0f));
    for (const double x : {1.53, 2.53}) {
        const MoveReport report =
            lit.moves().drag(move_of(scene, {.name = "crate", .by = {x, 0.0, 0.22}}));
        EXPECT_GT(lit.radiance()[BelowTheCrate].g, 0.1f);
        EXPECT_EQ(report.num_moved, 8u) << "the crate's vertices, not those of the floor";
        EXPECT_GT(num_inside(lit.scene()), 0);
    }
    EXPECT_TRUE(lit.moves().undo());
    EXPECT_EQ(lit.scene().receivers.positions, scene.receivers.positions);
    EXPECT_EQ(lit.scene().mesh.lifts, scene.mesh.lifts);
    EXPECT_EQ(radiance_of(lit), light);
}

TEST(Moves, TheLightFollowsAPose) {
    LitScene lit(before());
    light(lit);
    const std::vector<glm::vec3> at_first = radiance_of(lit);
    mesh::TriangleMesh mesh = things();
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        for (const std::uint32_t vertex : mesh.triangles[i])
            if (mesh.triangle_groups[i] == 1) // flat, and on its way to the ground
                mesh.positions[vertex].y = 0.4f * before().mesh.positions[vertex].y;
    mesh.normals = mesh::smooth_normals(mesh);
    const GroupMove flat = pose_of("ball", mesh);
    lit.moves().move(flat);
    Scene scene = before();
    move(scene, flat);
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        if (mesh.triangle_groups[i] == 1) {
            EXPECT_EQ(scene.receivers.normals[mesh.triangles[i][0]],
                      mesh.normals[mesh.triangles[i][0]]);
        }
    LitScene anew(scene);
    light(anew);
    EXPECT_EQ(radiance_of(lit), radiance_of(anew));
    EXPECT_NE(radiance_of(lit), at_first);
    EXPECT_TRUE(lit.moves().undo());
    EXPECT_EQ(radiance_of(lit), at_first);
    EXPECT_THAT(refusal([&] { lit.moves().drag(flat); }), HasSubstr("a place to drag a group to"));
}

TEST(Moves, SeveralThingsMoveAtOnce) {
    LitScene lit(before());
    light(lit);
    const std::vector<glm::vec3> at_first = radiance_of(lit);
    std::vector<GroupMove> moves = {
        move_of(before(), {.name = "lamp", .by = {1.0, -0.2, 0.5}, .degrees = 70.0}),
        move_of(before(), Step)};
    Scene together = before(), in_turn = before();
    for (const GroupMove& own : moves)
        move(in_turn, own);
    const prt::SceneChange change = move(together, moves);
    EXPECT_EQ(change.groups, (std::vector<std::uint32_t>{2, 1}));
    prt::expect_same(together.transfer, in_turn.transfer);
    EXPECT_EQ(together.receivers.positions, in_turn.receivers.positions);
    EXPECT_EQ(together.bounces->rays.num_hits, in_turn.bounces->rays.num_hits);

    const MoveReport report = lit.moves().move(moves);
    EXPECT_GT(report.num_moved, 642u) << "the ball's vertices, and the lamp's";
    LitScene anew(together);
    light(anew);
    EXPECT_EQ(radiance_of(lit), radiance_of(anew));
    EXPECT_TRUE(lit.moves().undo());
    EXPECT_EQ(radiance_of(lit), at_first);
    EXPECT_FALSE(lit.moves().undo()) << "it was a step";
    EXPECT_TRUE(lit.moves().redo());
    EXPECT_EQ(radiance_of(lit), radiance_of(anew));
    EXPECT_TRUE(lit.moves().undo());

    EXPECT_THAT(refusal([&] { lit.moves().move(std::vector<GroupMove>()); }),
                HasSubstr("expected groups to move, got none"));
    moves[0].going = Going::Away;
    EXPECT_THAT(refusal([&] { lit.moves().move(moves); }), HasSubstr("got lamp, which is taken"));
    moves[0] = moves[1];
    EXPECT_THAT(refusal([&] { lit.moves().move(moves); }), HasSubstr("got ball twice"));
    EXPECT_EQ(radiance_of(lit), at_first);
}

TEST(Moves, WhatIsTouchedFollowsSeveralThings) {
    const Scene scene = precompute(touching_things(), without_bounces());
    const std::vector<GroupMove> moves = {
        move_of(scene, {.name = "ball", .by = {0.0, 0.5, 0.0}}),
        move_of(scene, {.name = "crate", .by = {1.53, 0.0, 0.22}})};
    Scene together = scene, in_turn = scene;
    for (const GroupMove& own : moves)
        move(in_turn, own);
    prt::SceneChange change = move(together, moves);
    EXPECT_EQ(together.receivers.positions, in_turn.receivers.positions);
    EXPECT_EQ(together.mesh.lifts, in_turn.mesh.lifts);
    prt::expect_same(together.transfer, in_turn.transfer);
    prt::exchange(together, change);
    EXPECT_EQ(together.receivers.positions, scene.receivers.positions);
    EXPECT_EQ(together.mesh.lifts, scene.mesh.lifts);
    EXPECT_EQ(together.free_lifts, scene.free_lifts);
    prt::expect_same(together.transfer, scene.transfer);
}

class MovesFile : public tests::FolderTest {};

TEST_F(MovesFile, KeepsWhereVerticesWouldLookFrom) {
    Scene scene = precompute(touching_things(), without_bounces());
    prt::save_scene(folder_ / "scene.prt", scene);
    Scene loaded = prt::load_scene(folder_ / "scene.prt");
    EXPECT_EQ(loaded.free_lifts, scene.free_lifts);
    const GroupStep up{.name = "ball", .by = {0.0, 0.5, 0.0}};
    move(loaded, move_of(loaded, up));
    move(scene, move_of(scene, up));
    EXPECT_EQ(loaded.receivers.positions, scene.receivers.positions);
    prt::save_scene(folder_ / "scene.prt", loaded);
    EXPECT_EQ(prt::load_scene(folder_ / "scene.prt").receivers.positions,
              scene.receivers.positions);
}

TEST(Moves, RefusesNamesAndScenesThatAreShared) {
    LitScene lit(before());
    light(lit);
    const std::vector<glm::vec3> at_first = radiance_of(lit);
    EXPECT_THAT(refusal([&] { lit.moves().move({.name = "bal"}); }),
                HasSubstr("expected one of 3 groups, got 'bal'; did you mean ball?"));
    glm::dmat4 singular(1.0);
    singular[1] = glm::dvec4(0.0);
    EXPECT_THAT(refusal([&] { lit.moves().move({.name = "ball", .matrix = singular}); }),
                HasSubstr("singular"));
    EXPECT_THAT(refusal([&] { lit.moves().move({.name = "ball", .going = Going::Back}); }),
                HasSubstr("expected a group that was taken away, got ball, which is there"));
    EXPECT_THAT(refusal([&] { lit.moves().drag({.name = "ball", .going = Going::Away}); }),
                HasSubstr("a place to drag a group to"));
    EXPECT_EQ(radiance_of(lit), at_first);
    LitScene shared(std::make_shared<const Scene>(before()));
    EXPECT_THAT(refusal([&] { shared.moves().move({.name = "ball"}); }), HasSubstr("not shared"));
    Scene without = before();
    without.mesh.triangle_groups.clear();
    EXPECT_THAT(refusal([&] { move(without, {.name = "ball"}); }), HasSubstr("--movable"));
    EXPECT_THAT(refusal([] {
                    static_cast<void>(precompute(scenes::floor_grid(3, 1.0f), {.movable = true}));
                }),
                HasSubstr("a mesh with groups"));
}

TEST(Moves, StepsHaveAText) {
    const GroupStep step = GroupStepText::read("a=b=1,2,-3.5,90");
    EXPECT_EQ(step, (GroupStep{.name = "a=b", .by = {1.0, 2.0, -3.5}, .degrees = 90.0}));
    EXPECT_EQ(GroupStepText::read(GroupStepText::show(step)), step);
    EXPECT_EQ(GroupStepText::show(GroupStepText::read("x=1,2,3")), "x=1,2,3");
    EXPECT_EQ(GroupStepText::read("a=b=away"), (GroupStep{.name = "a=b", .going = Going::Away}));
    EXPECT_EQ(GroupStepText::show(GroupStepText::read("x=back")), "x=back");
    for (const char* text :
         {"=away", "x=aways", "x", "=1,2,3", "x=1,2", "x=1,2,3,4,5", "x=1,2,nan", "x=a,b,c"})
        EXPECT_THROW(static_cast<void>(GroupStepText::read(text)), std::invalid_argument) << text;
}

} // namespace
} // namespace relumine
