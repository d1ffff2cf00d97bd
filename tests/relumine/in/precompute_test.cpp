#include "relumine/in/precompute.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "mesh/normals.h"
#include "prt/receivers/lit_position.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/receivers/texel_receivers.h"
#include "prt/visibility/ray_scene.h"
#include "relumine/light/lit_scene.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/same_transfer.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

using scenes::boulder;
using scenes::Tolerance;
using scenes::two_squares;

class PrecomputeFile : public scenes::InFolder {};

TEST(Precompute, IsItsStepsInOneCall) {
    const mesh::TriangleMesh mesh = boulder().geometry;
    PrecomputeReport report;
    const Scene scene = precompute(mesh, {.tolerance = Tolerance, .no_refine = true}, {}, &report);

    const prt::RayScene rays(mesh);
    const float bias = prt::automatic_bias(mesh);
    mesh::TriangleMesh free = mesh;
    prt::leave_obstacles(rays, bias, free);
    prt::expect_same(scene.transfer, prt::precompute(prt::vertex_receivers(free), rays,
                                                     {.tolerance = Tolerance, .bias = bias}));
    EXPECT_EQ(scene.mesh.positions, mesh.positions);
    EXPECT_EQ(scene.receivers.positions, prt::vertex_receivers(free).positions);
    EXPECT_EQ(scene.settings.tolerance, Tolerance);
    EXPECT_EQ(scene.settings.bias, bias);
    EXPECT_EQ(scene.settings.min_level, 3u);
    EXPECT_EQ(scene.settings.face_resolution, 1024u);
    EXPECT_EQ(report.bias, bias);
    EXPECT_EQ(report.num_vertices, mesh.num_vertices());
    EXPECT_EQ(report.num_triangles, mesh.num_triangles());
    EXPECT_EQ(report.num_receivers, mesh.num_vertices());
    EXPECT_EQ(report.clusters.num_clusters, scene.transfer.num_clusters());
    EXPECT_FALSE(report.highlights);
    EXPECT_FALSE(report.memory);
}

TEST(Precompute, AsksBlockersOfOnesOwn) {
    // A ball over a floor that sees nothing else.
    const glm::dvec3 centre(0.1, 1.2, 0.0);
    constexpr double Radius = 0.6;
    const auto ball =
        std::make_shared<scenes::AnalyticBlockers>(scenes::sphere_blocker(centre, Radius));
    mesh::TriangleMesh floor;
    constexpr std::uint32_t N = 17;
    for (std::uint32_t i = 0; i < N * N; ++i)
        floor.positions.push_back({0.25f * static_cast<float>(i / N) - 2.0f, 0.0f,
                                   0.25f * static_cast<float>(i % N) - 2.0f});
    for (std::uint32_t i = 0; i + N < N * N; ++i)
        if (i % N + 1 < N) {
            floor.triangles.push_back({i, i + 1, i + N + 1});
            floor.triangles.push_back({i, i + N + 1, i + N});
        }
    floor.normals = mesh::smooth_normals(floor);
    const PrecomputeOptions options{.tolerance = 0.05f, .min_level = 4, .blockers = ball.get()};
    LitScene lit(precompute(Mesh(floor), options), {.blockers = ball});
    ASSERT_EQ(lit.scene().receivers.size(), floor.num_vertices());

    cubemap::CubeMap white(8);
    std::fill(white.texels.begin(), white.texels.end(), glm::vec3(1.0f));
    lit.light(white);
    const glm::dvec3 to_light = glm::normalize(glm::dvec3(0.2, 1.0, 0.1));
    const std::vector<glm::vec3> under_sky(lit.radiance().begin(), lit.radiance().end());
    lit.light(Light(std::vector<lights::DistantLight>{
        {.direction = to_light, .irradiance = glm::dvec3(1.0), .solid_angle = 1e-4}}));
    std::size_t num_dark = 0;
    for (std::size_t i = 0; i < under_sky.size(); ++i) {
        const glm::dvec3 to_centre = centre - glm::dvec3(floor.positions[i]);
        const double distance = glm::length(to_centre);
        // The form factor of a ball above the horizon.
        const double hidden = to_centre.y / distance * (Radius / distance) * (Radius / distance);
        EXPECT_NEAR(under_sky[i].g, 1.0 - hidden, 0.02) << i;
        const double off = glm::length(glm::cross(to_centre, to_light));
        if (std::abs(off - Radius) < 2e-3)
            continue; // at the very edge of the shadow
        num_dark += off < Radius ? 1 : 0;
        EXPECT_NEAR(lit.radiance()[i].g, off < Radius ? 0.0 : to_light.y / std::numbers::pi, 1e-5)
            << i;
    }
    EXPECT_GT(num_dark, 5u);

    const auto expect_refused = [&](PrecomputeOptions changed, const PrecomputeWork& work = {}) {
        changed.blockers = ball.get();
        EXPECT_THAT([&] { static_cast<void>(precompute(Mesh(floor), changed, work)); },
                    testing::ThrowsMessage<std::invalid_argument>(
                        testing::HasSubstr("expected triangles as blockers")));
    };
    expect_refused({.bounce_tolerance = 0.02f});
    expect_refused({.resume = true});
    EXPECT_THROW(plan(Mesh(floor), {.blockers = ball.get(), .output = "floor.plan"}),
                 std::invalid_argument);
}

TEST(Precompute, RefusesAMeshThatContradictsItself) {
    const auto expect_refused = [](const auto& change, const std::string& message) {
        mesh::TriangleMesh mesh = two_squares();
        change(mesh);
        const auto expect = [&](const auto& call) {
            EXPECT_THAT(call,
                        testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr(message)));
        };
        expect([&] { static_cast<void>(precompute(mesh)); });
        expect([&] { static_cast<void>(refined(mesh, {})); });
        expect([&] { static_cast<void>(simplified(mesh, 4)); });
    };
    using Mesh = mesh::TriangleMesh;
    expect_refused([](Mesh& m) { m.triangles[1][2] = 77; }, "got 77 of triangle 1");
    expect_refused([](Mesh& m) { m.triangles[0][0] = ~0u; }, "of triangle 0");
    expect_refused([](Mesh& m) { m.normals.pop_back(); }, "a normal for each of");
    expect_refused([](Mesh& m) { m.normals[2] *= 3.0f; }, "got 3 at vertex 2");
    expect_refused([](Mesh& m) { m.normals[2].x = NAN; }, "at vertex 2");
    expect_refused([](Mesh& m) { m.positions[1].y = INFINITY; }, "at vertex 1");
    expect_refused([](Mesh& m) { m.colors.resize(1); }, "colours of vertices, got 1");
    expect_refused([](Mesh& m) { m.triangle_materials.assign(m.num_triangles(), 5); },
                   "materials below 0, got 5");
    expect_refused([](Mesh& m) { m.triangle_materials.resize(1); }, "materials of triangles");
}

TEST(Precompute, GivesAMeshWithoutNormalsSmoothOnes) {
    mesh::TriangleMesh mesh = boulder().geometry;
    const PrecomputeOptions options{.tolerance = Tolerance, .no_refine = true};
    mesh.normals = mesh::smooth_normals(mesh);
    const Scene expected = precompute(mesh, options);
    mesh.normals.clear();
    prt::expect_same(precompute(mesh, options).transfer, expected.transfer);
}

TEST(Precompute, TakesABias) {
    EXPECT_EQ(precompute(boulder(), {.tolerance = Tolerance, .bias = 0.02f}).settings.bias, 0.02f);
}

TEST(Precompute, LightsPixelsOfAView) {
    const mesh::TriangleMesh mesh = boulder().geometry;
    const Camera camera{.eye = {0, 3, 6}, .target = {0, 0.5f, 0}};
    const Scene scene = precompute(mesh, {.tolerance = Tolerance,
                                          .receivers = Pixels{.width = 12, .height = 8},
                                          .view = View{.camera = camera}});
    const prt::PixelReceivers expected = prt::pixel_receivers(
        mesh, prt::RayScene(mesh),
        {.camera = camera, .width = 12, .height = 8, .samples_per_axis = std::nullopt});
    EXPECT_EQ(std::get<prt::PixelLayout>(scene.layout), expected.layout);
    EXPECT_EQ(scene.receivers.positions, expected.receivers.positions);

    const Scene automatic =
        precompute(mesh, {.tolerance = Tolerance, .receivers = Pixels{.width = 12, .height = 8}});
    EXPECT_EQ(std::get<prt::PixelLayout>(automatic.layout).camera,
              relight::framed(mesh, {.aspect = 12.0f / 8.0f}));
}

TEST(Precompute, LightsTexelsOfALightmap) {
    mesh::TriangleMesh mesh = two_squares();
    PrecomputeReport report;
    const Scene scene = precompute(
        mesh, {.tolerance = 0.2f, .receivers = Texels{.width = 8, .height = 4}}, {}, &report);
    const prt::TexelReceivers expected = prt::texel_receivers(mesh, {.width = 8, .height = 4});
    EXPECT_EQ(std::get<prt::TexelLayout>(scene.layout), expected.layout);
    ASSERT_TRUE(report.atlas);
    EXPECT_EQ(report.atlas->num_overlapping, 0u);

    // The second square's chart over the first one's: 4 x 4 texels, without the four whose centres
    // are on the triangles' common edge and so inside of none.
    for (std::size_t vertex = 4; vertex < 8; ++vertex)
        mesh.uvs[vertex].x -= 0.5f;
    std::vector<std::string> warnings;
    static_cast<void>(precompute(mesh,
                                 {.tolerance = 0.2f, .receivers = Texels{.width = 8, .height = 4}},
                                 {.on_warning = [&](Warning kind, const std::string& text) {
                                     EXPECT_EQ(kind, Warning::ChartsOverlap);
                                     warnings.push_back(text);
                                 }}));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0], "12 texels lie in several triangles, the first at column 0, row 0: "
                           "charts overlap, the first triangle of the mesh wins");
}

TEST(Precompute, ALightmapTakesSecondUvsThatAreAnUnwrap) {
    constexpr prt::AtlasSize Size{.width = 8, .height = 4};
    Mesh mesh(two_squares());
    mesh.geometry.second_uvs = mesh.geometry.uvs;
    for (glm::vec2& uv : mesh.geometry.uvs)
        uv *= 4.0f; // tiles
    PrecomputeReport report;
    const auto lit = [&](const Mesh& given) {
        return precompute(given, {.tolerance = 0.2f, .receivers = Texels{.width = 8, .height = 4}},
                          {.on_warning =
                               [](Warning, const std::string&) {
                               }},
                          &report);
    };
    const auto layout = [&](std::uint32_t uv_set) {
        return prt::texel_receivers(mesh.geometry, Size, uv_set).layout;
    };
    const Scene second = lit(mesh);
    EXPECT_EQ(std::get<prt::TexelLayout>(second.layout), layout(1));
    EXPECT_TRUE(report.takes_second_uvs);
    EXPECT_TRUE(second.mesh.second_uvs.empty()) << "no texture uses them";
    mesh.lightmap_uvs = 0;
    EXPECT_EQ(std::get<prt::TexelLayout>(lit(mesh).layout), layout(0));
    EXPECT_FALSE(report.takes_second_uvs);
    // They overlap.
    mesh.lightmap_uvs.reset();
    for (std::size_t vertex = 4; vertex < 8; ++vertex)
        mesh.geometry.second_uvs[vertex].x -= 0.5f;
    EXPECT_EQ(std::get<prt::TexelLayout>(lit(mesh).layout), layout(0));
    mesh.lightmap_uvs = 1;
    EXPECT_EQ(std::get<prt::TexelLayout>(lit(mesh).layout), layout(1));
}

TEST(Precompute, NamesTheMeshThatHasNoUvs) {
    Mesh mesh = boulder();
    mesh.geometry.uvs.clear();
    mesh.source = "folder/boulder.ply";
    try {
        static_cast<void>(precompute(mesh, {.receivers = Texels{}}));
        FAIL() << "made texels without uvs";
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what()).find("folder/boulder.ply: "), 0u) << error.what();
    }
}

TEST(Precompute, HighlightsNeedAView) {
    const PrecomputeOptions options{.tolerance = Tolerance,
                                    .face_resolution = 64,
                                    .surface = everywhere({.albedo = glm::vec3(0.3f),
                                                           .specular = glm::vec3(0.5f),
                                                           .highlight = prt::Highlight::Ggx,
                                                           .roughness_or_exponent = 0.6f})};
    PrecomputeReport report;
    const Scene diffuse = precompute(boulder(), options, {}, &report);
    EXPECT_FALSE(diffuse.transfer.glossy);
    EXPECT_EQ(report.num_highlights_left_out, diffuse.receivers.size());
    EXPECT_FALSE(diffuse.settings.glossy_tolerance);

    PrecomputeOptions seen = options;
    seen.bounce_tolerance = 0.0f;
    seen.no_refine = true;
    seen.view = View{};
    double last = 0.0;
    std::vector<Stage> stages;
    PrecomputeWork work;
    work.on_progress = [&](Stage stage, double fraction) {
        if (stages.empty() || stages.back() != stage) {
            stages.push_back(stage);
            last = 0.0;
        }
        EXPECT_GE(fraction, last);
        EXPECT_LE(fraction, 1.0);
        last = fraction;
    };
    const Scene shiny = precompute(boulder(), seen, work, &report);
    EXPECT_TRUE(shiny.transfer.glossy);
    EXPECT_EQ(shiny.settings.view, relight::framed(shiny.mesh));
    EXPECT_EQ(shiny.settings.glossy_tolerance, seen.glossy_tolerance);
    ASSERT_TRUE(report.highlights);
    EXPECT_GT(report.highlights->num_entries, 0u);
    EXPECT_EQ(report.num_highlights_left_out, 0u);
    EXPECT_EQ(stages, (std::vector{Stage::Clusters, Stage::Highlights}));
}

TEST(Precompute, RefusesOptionsOutOfRange) {
    const auto run = [](const PrecomputeOptions& options) {
        static_cast<void>(precompute(boulder(), options));
    };
    EXPECT_THROW(run({.tolerance = -1.0f}), std::invalid_argument);
    EXPECT_THROW(run({.face_resolution = 0}), std::invalid_argument);
    EXPECT_THROW(run({.bias = -1.0f}), std::invalid_argument);
    EXPECT_THROW(run({.output = "scene.ply"}), std::invalid_argument);
    EXPECT_THROW(run({.resume = true}), std::invalid_argument);
    EXPECT_THROW(run({.checkpoint_seconds = -1.0}), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(precompute(mesh::TriangleMesh())), std::invalid_argument);
}

TEST(Precompute, KeepsWithinAMemoryLimit) {
    using Part = MemoryLimitExceeded::Part;
    const auto part_of = [](const PrecomputeOptions& options) -> std::optional<Part> {
        Mesh mesh(data_gen::blob(20'000));
        mesh.source = "boulder.ply";
        try {
            static_cast<void>(precompute(std::move(mesh), options));
        } catch (const MemoryLimitExceeded& error) {
            EXPECT_EQ(std::string(error.what()).find("boulder.ply: expected "), 0u) << error.what();
            return error.part;
        }
        return {};
    };
    constexpr std::uint64_t MiB = 1u << 20u;
    EXPECT_EQ(part_of({.max_memory = 1 * MiB}), Part::Scene);
    EXPECT_EQ(part_of({.tolerance = 0.002f, .max_memory = 70 * MiB}), Part::Clusters);

    PrecomputeReport report;
    const Scene limited =
        precompute(boulder(), {.tolerance = Tolerance, .max_memory = 200 * MiB}, {}, &report);
    prt::expect_same(limited.transfer, precompute(boulder(), {.tolerance = Tolerance}).transfer);
    ASSERT_TRUE(report.memory);
    EXPECT_LT(report.memory->peak_bytes, 200 * MiB);
}

TEST_F(PrecomputeFile, IsWrittenAndItsCheckpointGoes) {
    PrecomputeReport report;
    const Scene scene = precompute(
        boulder(),
        {.tolerance = Tolerance, .output = file("scene.prt"), .checkpoint_seconds = 1e-9}, {},
        &report);
    EXPECT_EQ(report.file_bytes, std::filesystem::file_size(file("scene.prt")));
    EXPECT_FALSE(std::filesystem::exists(file("scene.prt.checkpoint")));
    save_scene(file("again.prt"), scene);
    EXPECT_EQ(read("scene.prt"), read("again.prt"));
    prt::expect_same(load_scene(file("scene.prt")).transfer, scene.transfer);
}

TEST_F(PrecomputeFile, StoppedIsResumedToTheSameBytes) {
    const auto options = [&](const char* name) {
        return PrecomputeOptions{.tolerance = 0.02f,
                                 .no_refine = true,
                                 .output = file(name),
                                 .checkpoint_seconds = 1e-9};
    };
    static_cast<void>(precompute(boulder(), options("whole.prt")));

    std::stop_source stop;
    PrecomputeWork first{.stop = stop.get_token()};
    first.on_progress = [&](Stage, double fraction) {
        if (fraction > 0.3)
            stop.request_stop();
    };
    PrecomputeReport report;
    EXPECT_THROW(static_cast<void>(precompute(boulder(), options("scene.prt"), first, &report)),
                 Cancelled);
    EXPECT_EQ(report.checkpoint, file("scene.prt.checkpoint"));
    EXPECT_FALSE(std::filesystem::exists(file("scene.prt")));

    PrecomputeOptions second = options("scene.prt");
    second.resume = true;
    std::vector<std::string> notes;
    static_cast<void>(precompute(boulder(), second,
                                 {.on_note =
                                      [&](const std::string& text) {
                                          notes.push_back(text);
                                      }},
                                 &report));
    EXPECT_EQ(notes, std::vector{"going on from " + file("scene.prt.checkpoint").string()});
    EXPECT_TRUE(report.checkpoint.empty());
    EXPECT_EQ(read("scene.prt"), read("whole.prt"));
    EXPECT_FALSE(std::filesystem::exists(file("scene.prt.checkpoint")));
}

TEST_F(PrecomputeFile, UnlitSurfacesAreNotLit) {
    mesh::TriangleMesh mesh = scenes::two_squares();
    mesh.colors.clear();
    mesh.materials = {{.name = "plaster"},
                      {.name = "sign",
                       .model = mesh::MaterialModel::Unlit,
                       .base_color = glm::vec3(0.5f, 0.25f, 1.0f)}};
    mesh.triangle_materials = {1, 1, 1, 1};
    PrecomputeReport report;
    const Scene unlit = precompute(Mesh(mesh), {}, {}, &report);
    EXPECT_EQ(report.clusters.num_rays, 0u);
    EXPECT_FALSE(report.refined);
    EXPECT_EQ(unlit.mesh.num_vertices(), mesh.num_vertices());
    // Nobody sees light on what has no alpha.
    mesh::TriangleMesh glassy = mesh;
    glassy.materials[1] = {.name = "collider", .alpha_mode = mesh::AlphaMode::Blend, .alpha = 0.0f};
    EXPECT_EQ(precompute(Mesh(glassy)).mesh.num_vertices(), mesh.num_vertices());
    // What the options light is lit.
    const auto white = [](const mesh::TriangleMesh&, std::uint32_t, const prt::Surface&) {
        return prt::Surface{};
    };
    const Scene lit = precompute(Mesh(mesh), {.surface = white}, {}, &report);
    EXPECT_GT(report.clusters.num_rays, 0u);
    EXPECT_GT(lit.mesh.num_vertices(), mesh.num_vertices());
    EXPECT_EQ(lit.mesh.materials[1].model, mesh::MaterialModel::Unlit);
    // Of both kinds, the file has the normals that were looked from.
    mesh.triangle_materials = {0, 0, 1, 1};
    const Scene both = precompute(Mesh(mesh), {.no_refine = true});
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_EQ(both.receivers.normals[i], i < 4 ? mesh.normals[i] : glm::vec3(0.0f));
    save_scene(file("both.prt"), both);
    EXPECT_EQ(load_scene(file("both.prt")).receivers.normals, both.receivers.normals);
}

} // namespace
} // namespace relumine
