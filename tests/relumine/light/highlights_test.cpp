// Highlights of pictures whose scene has no view: by rays.
#include <algorithm>
#include <filesystem>
#include <utility>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "data_gen/environments.h"
#include "prt/glossy/brdf.h"
#include "relight/surfaces/reflections.h"
#include "relumine/in/precompute.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"
#include "tests/prt/scenes.h"
#include "tests/relight/environments.h"

namespace relumine {
namespace {

const Camera Front{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 20};

mesh::Material metal(float roughness) {
    return {.name = "metal",
            .model = mesh::MaterialModel::MetallicRoughness,
            .base_color = glm::vec3(1.0f),
            .metallic = 1.0f,
            .roughness = roughness};
}

mesh::TriangleMesh sphere_of(const mesh::Material& material) {
    mesh::TriangleMesh mesh = scenes::icosphere(5, 0.5f, glm::vec3(0.0f));
    mesh.materials = {material};
    mesh.triangle_materials.assign(mesh.num_triangles(), 0);
    return mesh;
}

Picture drawn(const LitScene& lit, OutputOptions options = {}) {
    options.width = options.height = 48;
    options.camera = Front;
    options.background = NothingBehind{};
    return Painter(lit, options).draw(lit.lighting());
}

LitScene lit_under(const mesh::TriangleMesh& mesh, const cubemap::CubeMap& sky,
                   PrecomputeOptions options = {}, const LightOptions& light = {}) {
    options.tolerance = 0.06f;
    options.bounce_tolerance = 0.0f;
    options.no_refine = true;
    LitScene lit(precompute(mesh, options), light);
    lit.light(sky);
    return lit;
}

const glm::vec3& middle(const Picture& picture) {
    return picture.pixels[picture.pixels.size() / 2 + picture.width / 2];
}

TEST(Highlights, AWhiteMetalIsWhiteInAFurnace) {
    const cubemap::CubeMap sky = data_gen::constant(16, glm::vec3(1.0f));
    for (const float roughness : {0.0f, 0.5f, 1.0f}) {
        const LitScene lit = lit_under(sphere_of(metal(roughness)), sky);
        const Picture picture = drawn(lit);
        for (std::size_t i = 0; i < picture.pixels.size(); ++i)
            if (picture.alpha[i] == 1.0f) {
                EXPECT_NEAR(picture.pixels[i].g, 1.0f, 0.02f) << roughness;
            }
    }
}

/// GGX without its Lambertian part as a table, of another strength in each colour.
std::shared_ptr<const mesh::BrdfTable> ggx_table(float roughness) {
    return mesh::brdf_of([roughness](const mesh::BrdfDirections& at) {
        const glm::vec3 h = glm::normalize(at.to_light + at.to_eye);
        const prt::LobeGeometry geometry{at.to_light.z, at.to_eye.z, h.x * h.x + h.y * h.y};
        return glm::vec3(0.25f, 0.1f, 0.05f) + glm::vec3(0.25f, 0.5f, 0.75f) *
                                                   prt::GgxLobe::specular(roughness, geometry) /
                                                   at.to_light.z / 2.0f;
    });
}

/// Mean absolute difference over the mean, where both pictures show the sphere whole.
double relative_difference(const Picture& a, const Picture& b) {
    double sum = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        if (a.alpha[i] == 1.0f && b.alpha[i] == 1.0f)
            for (int color = 0; color < 3; ++color) {
                sum += double{a.pixels[i][color]};
                difference += std::abs(double{a.pixels[i][color]} - double{b.pixels[i][color]});
            }
    EXPECT_GT(sum, 1.0);
    return difference / sum;
}

TEST(Highlights, ATableOfAFormulaLooksLikeTheFormula) {
    const cubemap::CubeMap sky = data_gen::two_soft_boxes(64);
    const mesh::TriangleMesh mesh = scenes::icosphere(5, 0.5f, glm::vec3(0.0f));
    const auto table = ggx_table(0.4f);
    PrecomputeOptions pixels{.receivers = Pixels{.width = 48, .height = 48, .samples_per_axis = 2}};
    pixels.view = View{.camera = Front};
    pixels.highlights = Highlights::Stored;
    pixels.surface = everywhere(prt::measured_surface(table));
    const auto picture_of = [&](const LitScene& lit) {
        return Painter(lit, {.background = NothingBehind{}}).draw(lit.lighting());
    };
    const Picture measured = picture_of(lit_under(mesh, sky, pixels));
    // One scattering of F0 and a Lambertian part beside it: Blinn-Phong has such a sum, so the
    // parts are drawn each by itself.
    const auto part = [&](const prt::Surface& surface) {
        pixels.surface = everywhere(surface);
        return picture_of(lit_under(mesh, sky, pixels));
    };
    Picture expected = part({.albedo = std::numbers::pi_v<float> * glm::vec3(0.25f, 0.1f, 0.05f)});
    const Picture highlight = part({.albedo = glm::vec3(0.0f),
                                    .specular = glm::vec3(1.0f),
                                    .highlight = prt::Highlight::Ggx,
                                    .roughness_or_exponent = 0.4f});
    for (std::size_t i = 0; i < expected.pixels.size(); ++i)
        expected.pixels[i] += glm::vec3(0.125f, 0.25f, 0.375f) * highlight.pixels[i];
    EXPECT_LT(relative_difference(measured, expected), 0.02);

    PrecomputeOptions vertices;
    vertices.surface = pixels.surface = everywhere(prt::measured_surface(table));
    const Picture traced = drawn(lit_under(mesh, sky, vertices), {.highlight_rays = 256});
    EXPECT_LT(relative_difference(traced, expected), 0.04);
}

TEST(Highlights, PixelsTraceWhatIsNotStored) {
    const cubemap::CubeMap sky = data_gen::two_soft_boxes(64);
    const mesh::TriangleMesh mesh = sphere_of(metal(0.4f));
    PrecomputeOptions options{.receivers =
                                  Pixels{.width = 48, .height = 48, .samples_per_axis = 2}};
    options.view = View{.camera = Front};
    const LitScene traced = lit_under(mesh, sky, options, {.highlight_rays = 1024});
    EXPECT_FALSE(traced.scene().settings.glossy_tolerance);
    options.highlights = Highlights::Stored;
    const LitScene stored = lit_under(mesh, sky, options);
    EXPECT_TRUE(stored.scene().settings.glossy_tolerance);
    const auto picture_of = [](const LitScene& lit) {
        return Painter(lit, {.background = NothingBehind{}}).draw(lit.lighting());
    };
    EXPECT_LT(relative_difference(picture_of(traced), picture_of(stored)), 0.03);
    // Numbers have them, too.
    double sum = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < stored.radiance().size(); ++i) {
        sum += double{stored.radiance()[i].g};
        difference += std::abs(double{stored.radiance()[i].g} - double{traced.radiance()[i].g});
    }
    EXPECT_LT(difference, 0.05 * sum);
}

/// A white metal is white, and a mirror shows the lit floor below it.
TEST(Highlights, TracedPixelsShowTheFloorWithItsBounces) {
    Mesh mesh;
    mesh.geometry = sphere_of(metal(0.2f));
    add_floor(mesh, {.floor_vertices = 33});
    const cubemap::CubeMap sky = data_gen::constant(16, glm::vec3(1.0f));
    const Camera above{.eye = {0, 1, 4}, .target = {0, 0, 0}, .fov_degrees = 20};
    const auto lowest = [&](float bounces, float floor_albedo) {
        PrecomputeOptions options{.tolerance = 0.06f,
                                  .receivers =
                                      Pixels{.width = 24, .height = 24, .samples_per_axis = 1},
                                  .bounce_tolerance = bounces};
        options.view = View{.camera = above};
        LitScene lit(precompute(mesh, options));
        lit.light(sky);
        if (lit.scene().bounces)
            lit.bounce(
                {.albedo = bounce_albedo(lit.scene(), {.floor_albedo = glm::vec3(floor_albedo)})});
        float least = 1e9f;
        const prt::Receivers& receivers = lit.scene().receivers;
        for (std::size_t i = 0; i < receivers.num_own(); ++i)
            if (receivers.surfaces[i].metallic == 1.0f && receivers.normals[i].y < -0.3f)
                least = std::min(least, lit.radiance()[i].g);
        return least;
    };
    EXPECT_LT(lowest(0.0f, 1.0f), 0.05f) << "surfaces in the mirror are black";
    const float white = lowest(0.05f, 1.0f);
    EXPECT_GT(white, 0.2f);
    EXPECT_LT(lowest(0.05f, 0.5f), 0.6f * white) << "a darker floor is mirrored darker";
}

/// The file keeps the materials that mirrors show.
TEST(Highlights, PixelsOfAFileMirrorTheColoursOfOtherSurfaces) {
    const mesh::TriangleMesh sphere = sphere_of(metal(0.1f));
    mesh::TriangleMesh mesh = scenes::joined(sphere, scenes::floor_grid(17, 8.0f, -0.6f));
    mesh.materials = {metal(0.1f),
                      {.name = "red",
                       .model = mesh::MaterialModel::MetallicRoughness,
                       .base_color = {0.8f, 0.1f, 0.05f},
                       .metallic = 0.0f,
                       .roughness = 1.0f}};
    mesh.triangle_materials.assign(mesh.num_triangles(), 1);
    std::fill_n(mesh.triangle_materials.begin(), sphere.num_triangles(), 0u);
    PrecomputeOptions options{.tolerance = 0.06f,
                              .receivers = Pixels{.width = 32, .height = 32},
                              .no_refine = true,
                              .bounce_tolerance = 0.05f};
    options.view = View{.camera = Camera{.eye = {0, 1, 4}, .target = {0, 0, 0}, .fov_degrees = 20}};
    const Scene made = precompute(mesh, options);
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) / "mirrored_colors.prt";
    save_scene(file, made);
    const auto lit = [&](Scene scene) {
        LitScene result(std::move(scene));
        result.light(data_gen::constant(16, glm::vec3(1.0f)));
        result.bounce({.albedo = bounce_albedo(result.scene(), {})});
        return result;
    };
    const LitScene before = lit(made), after = lit(load_scene(file));
    std::filesystem::remove(file);
    const prt::Receivers& receivers = made.receivers;
    std::size_t num_below = 0;
    for (std::size_t i = 0; i < receivers.num_own(); ++i) {
        const glm::vec3& own = before.radiance()[i];
        EXPECT_LT(glm::distance(own, after.radiance()[i]), 1e-4f) << i;
        if (receivers.surfaces[i].metallic < 1.0f || receivers.normals[i].y > -0.4f)
            continue;
        ++num_below;
        EXPECT_GT(own.r, 3.0f * own.g) << i << ": mirrors the red floor";
    }
    EXPECT_GT(num_below, 20u);
}

TEST(Highlights, AreThoseOfPixelsWithAView) {
    const cubemap::CubeMap sky = data_gen::two_soft_boxes(64);
    const mesh::TriangleMesh mesh = sphere_of(metal(0.4f));
    const Picture traced = drawn(lit_under(mesh, sky), {.highlight_rays = 256});
    PrecomputeOptions options{.receivers =
                                  Pixels{.width = 48, .height = 48, .samples_per_axis = 3}};
    options.view = View{.camera = Front};
    options.highlights = Highlights::Stored;
    const LitScene fixed = lit_under(mesh, sky, options);
    const Picture exact = Painter(fixed, {.background = NothingBehind{}}).draw(fixed.lighting());
    double sum = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < exact.pixels.size(); ++i)
        if (traced.alpha[i] == 1.0f && exact.alpha[i] == 1.0f) {
            sum += exact.pixels[i].g;
            difference += std::abs(exact.pixels[i].g - traced.pixels[i].g);
        }
    ASSERT_GT(sum, 1.0);
    EXPECT_LT(difference, 0.04 * sum);
}

TEST(Highlights, AMirrorShowsTheLightOfSurfaces) {
    // A mirror faces the eye; behind the eye, all around, stands a box that shines.
    mesh::TriangleMesh mesh = scenes::box({-3, -3, 5}, {3, 3, 6});
    const auto num_box = static_cast<std::uint32_t>(mesh.num_triangles());
    const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
    for (const glm::vec3& corner :
         {glm::vec3(-1, -1, 0), glm::vec3(1, -1, 0), glm::vec3(-1, 1, 0), glm::vec3(1, 1, 0)}) {
        mesh.positions.push_back(corner);
        mesh.normals.emplace_back(0, 0, 1);
    }
    mesh.triangles.push_back({first, first + 1, first + 3});
    mesh.triangles.push_back({first, first + 3, first + 2});
    mesh.materials = {
        {.name = "screen", .model = mesh::MaterialModel::Unlit, .base_color = {1.0f, 0.5f, 0.25f}},
        metal(0.1f)};
    mesh.triangle_materials.assign(num_box, 0);
    mesh.triangle_materials.resize(mesh.num_triangles(), 1);
    const LitScene lit = lit_under(mesh, data_gen::constant(16, glm::vec3(0.125f)));
    const glm::vec3 seen = middle(drawn(lit));
    EXPECT_LT(glm::length(seen - glm::vec3(1.0f, 0.5f, 0.25f)), 0.03f);
    EXPECT_LT(middle(drawn(lit, {.highlight_rays = 0})).g, 0.2f) << "matte, and in shadow";
}

/// A mirror at z = 0 shows a ball behind the eye as an eye behind the mirror would see it.
TEST(Highlights, AMirrorShowsWhatAMetalMirrors) {
    const glm::vec3 centre(0.0f, 0.0f, 8.0f);
    const cubemap::CubeMap sky = scenes::smooth_environment(64);
    mesh::TriangleMesh ball = scenes::icosphere(5, 0.5f, centre);
    ball.materials = {metal(0.25f)};
    ball.materials[0].base_color = {1.0f, 0.7f, 0.3f};
    ball.triangle_materials.assign(ball.num_triangles(), 0);
    mesh::TriangleMesh both = scenes::joined(ball, scenes::box({-1, -1, -1}, {1, 1, 0}));
    both.materials = {ball.materials[0], metal(0.0f)};
    both.triangle_materials.assign(both.num_triangles(), 1);
    std::fill_n(both.triangle_materials.begin(), ball.num_triangles(), 0u);
    for (std::size_t i = ball.num_vertices(); i < both.num_vertices(); ++i)
        both.normals[i] = {0, 0, 1};
    const auto seen = [&](const mesh::TriangleMesh& mesh, const Camera& camera) {
        OutputOptions options{.camera = camera, .background = NothingBehind{}};
        options.width = options.height = 48;
        const LitScene lit = lit_under(mesh, sky);
        return Painter(lit, options).draw(lit.lighting());
    };
    const Picture direct = seen(ball, {.eye = {0, 0, -4}, .target = centre, .fov_degrees = 6});
    const Picture mirrored = seen(both, {.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 6});
    double sum = 0.0, difference = 0.0;
    for (std::uint32_t y = 0; y < 48; ++y)
        for (std::uint32_t x = 0; x < 48; ++x) {
            const std::size_t pixel = std::size_t{y} * 48 + x;
            // The middle of the ball mirrors the mirror, which nothing shows in `direct`.
            if (direct.alpha[pixel] < 1.0f ||
                glm::length(glm::vec2(x, y) - glm::vec2(23.5f)) < 8.0f)
                continue;
            for (int color = 0; color < 3; ++color) {
                const double own = direct.pixels[pixel][color];
                sum += own;
                difference +=
                    std::abs(own - double{mirrored.pixels[std::size_t{y} * 48 + 47 - x][color]});
            }
        }
    ASSERT_GT(sum, 1.0);
    EXPECT_LT(difference, 0.05 * sum);
}

/// Two polished plates that face each other send a ray on until it leaves between them: what the
/// eye sees is the sky there, however often the ray was mirrored.
TEST(Highlights, PlatesMirrorEachOtherUntilTheSkyIsSeen) {
    const cubemap::CubeMap sky = scenes::smooth_environment(64);
    for (std::uint32_t count = 1; count <= relight::MostMirrors; ++count) {
        // A ray that goes down by 45 degrees meets the plates at x = 0.5, 1.5, ..
        const auto length = static_cast<float>(count);
        mesh::TriangleMesh plates = scenes::joined(scenes::box({0, -2, -1}, {length, 2, 0}),
                                                   scenes::box({0, -2, 1}, {length, 2, 2}));
        for (std::size_t i = 0; i < plates.num_vertices(); ++i)
            plates.normals[i] = {0, 0, i < plates.num_vertices() / 2 ? 1 : -1};
        plates.materials = {metal(0.0f)};
        plates.triangle_materials.assign(plates.num_triangles(), 0);
        OutputOptions options{
            .camera = Camera{.eye = {-3.5f, 0, 4}, .target = {0.5f, 0, 0}, .fov_degrees = 1},
            .background = NothingBehind{}};
        options.width = options.height = 16;
        const LitScene lit = lit_under(plates, sky);
        const glm::vec3 seen = middle(Painter(lit, options).draw(lit.lighting()));
        const glm::vec3 expected =
            cubemap::sample(sky, glm::normalize(glm::vec3(1, 0, count % 2 == 1 ? 1 : -1)));
        EXPECT_LT(glm::distance(seen, expected), 0.03f * glm::length(expected)) << count;
    }
}

TEST(Highlights, SurfacesOfOptionsHaveTheirs) {
    const cubemap::CubeMap sky = data_gen::constant(16, glm::vec3(1.0f));
    PrecomputeOptions options;
    options.surface = [](const mesh::TriangleMesh&, std::uint32_t, const prt::Surface&) {
        return prt::Surface{.albedo = glm::vec3(0.0f),
                            .specular = glm::vec3(0.25f),
                            .highlight = prt::Highlight::GgxWhole,
                            .roughness_or_exponent = 0.3f};
    };
    const LitScene lit = lit_under(scenes::icosphere(3, 0.5f, glm::vec3(0.0f)), sky, options);
    EXPECT_NEAR(middle(drawn(lit)).g, 0.25f, 0.02f);
}

} // namespace
} // namespace relumine
