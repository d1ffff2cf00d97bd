// Bounces of light, from a mesh to what pixels, texels and glossy vertices show.
#include <cmath>

#include <glm/geometric.hpp>

#include "prt/bounces/bounce_precompute.h"
#include "prt/receivers/mesh_point.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

class BouncesFile : public scenes::InFolder {};

using scenes::corner;
using scenes::sun_and_sky;

constexpr Camera View45{.eye = {0.5f, 1.2f, 2.5f}, .target = {0.5f, 0.3f, 0.3f}, .fov_degrees = 30};

PrecomputeOptions options(const ReceiverChoice& receivers) {
    PrecomputeOptions result{
        .tolerance = 0.03f, .receivers = receivers, .no_refine = true, .bounce_tolerance = 0.01f};
    if (std::holds_alternative<Pixels>(receivers))
        result.view = View{View45};
    return result;
}

std::vector<glm::vec3> bounced(LitScene& lit) {
    lit.light(sun_and_sky());
    lit.bounce({.albedo = bounce_albedo(lit.scene())});
    return {lit.bounces().bounced().begin(), lit.bounces().bounced().end()};
}

/// How far pixels or texels are from the light that the vertices of the same mesh interpolate.
/// Those on the line where floor and wall meet are left out: the last bit of their position says on
/// which side of the other square they are.
double difference_to_vertices(const LitScene& lit, std::span<const glm::vec3> light,
                              std::span<const glm::vec3> of_vertices) {
    const prt::Receivers& receivers = lit.scene().receivers;
    double difference = 0.0, all = 0.0;
    for (std::size_t i = 0; i < receivers.num_own(); ++i) {
        if (receivers.positions[i].y < 1e-6f && receivers.positions[i].z < 1e-6f)
            continue;
        const glm::vec3 expected =
            prt::value_at(lit.scene().mesh, of_vertices, receivers.points[i]);
        const glm::dvec3 d = glm::dvec3(light[i]) - glm::dvec3(expected);
        difference += glm::dot(d, d);
        all += glm::dot(glm::dvec3(expected), glm::dvec3(expected));
    }
    return std::sqrt(difference / all);
}

TEST(Bounces, OfPixelsAndTexelsComeFromTheVertices) {
    const mesh::TriangleMesh mesh = corner(33);
    LitScene vertices(precompute(mesh, options(Vertices{})));
    const std::vector<glm::vec3> of_vertices = bounced(vertices);
    for (const auto& receivers : std::initializer_list<ReceiverChoice>{
             Pixels{.width = 40, .height = 30}, Texels{.width = 64, .height = 32}}) {
        LitScene lit(precompute(mesh, options(receivers)));
        const prt::Receivers& own = lit.scene().receivers;
        EXPECT_EQ(own.num_added, mesh.num_vertices());
        const std::vector<glm::vec3> light = bounced(lit);
        EXPECT_LT(difference_to_vertices(lit, light, of_vertices), 0.03);
        // The wall's red is on the floor.
        EXPECT_GT(light[own.num_own() + 3].r, 1.5f * light[own.num_own() + 3].g);
        const Verification check = verify(lit, {.num_samples = 200, .num_paths = 600});
        EXPECT_LT(check.error.relative_l2, 0.03 + check.noise);
        for (const std::uint32_t receiver : check.receivers)
            EXPECT_LT(receiver, own.num_own());
        const Picture picture = draw(lit);
        EXPECT_EQ(picture.pixels.size(), std::holds_alternative<Pixels>(receivers) ? 1200u : 2048u);
    }
}

TEST(Bounces, OfFineMeshesAskForAsManyRays) {
    EXPECT_EQ(prt::automatic_tolerance(1000, false), 0.02f);
    EXPECT_EQ(prt::automatic_tolerance(400'000, false), 0.02f);
    EXPECT_FLOAT_EQ(prt::automatic_tolerance(1'600'000, false), 0.04f);
    EXPECT_EQ(prt::automatic_tolerance(25'000, true), 0.005f);
    EXPECT_FLOAT_EQ(prt::automatic_tolerance(100'000, true), 0.01f);
}

TEST_F(BouncesFile, KeepTheVerticesBehindPixels) {
    PrecomputeOptions how = options(Pixels{.width = 20, .height = 16});
    how.output = file("scene.prt");
    how.two_sided_bounces = true;
    LitScene made(precompute(corner(9), how));
    LitScene read(load_scene(file("scene.prt")));
    EXPECT_EQ(read.scene().receivers.num_added, 162u);
    EXPECT_EQ(read.scene().bounces, made.scene().bounces);
    EXPECT_TRUE(read.scene().settings.two_sided_bounces);
    EXPECT_EQ(bounced(read), bounced(made));

    refuses_damage(
        read.scene(), [](Scene& scene) { scene.bounces->weights[3] = 2.0f; }, "keep at most all");
    refuses_damage(
        read.scene(), [](Scene& scene) { scene.bounces->spectral_radius = std::nanf(""); },
        "0 to 1");
    // Pixels send nothing.
    refuses_damage(
        read.scene(),
        [](Scene& scene) {
            for (std::uint32_t& place : scene.bounces->emitters.places)
                place = 0;
        },
        "light that comes from vertices");
}

/// Lifted off the floor by its sphere of directions, the roof faces up; its back is over the floor.
mesh::TriangleMesh floor_under_a_roof() {
    mesh::TriangleMesh mesh = corner(17);
    mesh.positions.resize(2 * 17 * 17);
    for (std::size_t i = 17 * 17; i < mesh.num_vertices(); ++i) {
        const glm::vec3 wall = mesh.positions[i];
        mesh.positions[i] = {wall.x, 0.4f, wall.y};
        mesh.normals[i] = {0, 1, 0};
    }
    for (std::size_t i = mesh.num_triangles() / 2; i < mesh.num_triangles(); ++i)
        std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
    return mesh;
}

TEST(Bounces, OfBacksAreVerifiedAsTheyWereMade) {
    for (const bool two_sided : {false, true}) {
        PrecomputeOptions how = options(Vertices{});
        how.two_sided_bounces = two_sided;
        LitScene lit(precompute(floor_under_a_roof(), how));
        lit.light(cubemap::CubeMap(16, glm::vec3(1.0f)));
        lit.bounce({.albedo = std::vector(lit.scene().receivers.size(), glm::vec3(0.8f))});
        float largest = 0.0f;
        for (const glm::vec3& light : lit.bounces().bounced())
            largest = std::max(largest, light.g);
        EXPECT_EQ(largest > 0.1f, two_sided);
        const Verification check = verify(lit, {.num_samples = 200, .num_paths = 400});
        EXPECT_LT(check.error.relative_l2, 0.02 + check.noise) << two_sided;
    }
}

TEST(Bounces, GlossyReceiversGainTheDiffusePart) {
    const prt::Surface glossy{.albedo = glm::vec3(0.5f, 0.25f, 0.1f),
                              .specular = glm::vec3(0.04f),
                              .highlight = prt::Highlight::Ggx,
                              .roughness_or_exponent = 0.4f};
    prt::Surface matt = glossy;
    matt.highlight = prt::Highlight::None;
    std::vector<std::vector<glm::vec3>> lights;
    for (const prt::Surface& surface : {glossy, matt}) {
        PrecomputeOptions how = options(Vertices{});
        how.view = View{View45};
        how.surface = everywhere(surface);
        how.glossy_tolerance = 0.1f;
        LitScene lit(precompute(corner(9), how));
        EXPECT_EQ(lit.scene().transfer.glossy.has_value(), surface == glossy);
        lit.light(sun_and_sky());
        const std::vector<glm::vec3> direct(lit.radiance().begin(), lit.radiance().end());
        lit.bounce({.albedo = bounce_albedo(lit.scene())});
        for (std::size_t i = 0; i < direct.size(); ++i)
            ASSERT_EQ(lit.radiance()[i], direct[i] + lit.bounces().bounced()[i]);
        lights.emplace_back(lit.bounces().bounced().begin(), lit.bounces().bounced().end());
    }
    // The bounced light is that of a Lambert surface.
    for (std::size_t i = 0; i < lights[0].size(); ++i)
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(lights[0][i][c], lights[1][i][c], 1e-4f + 1e-3f * lights[1][i][c]);
    EXPECT_GT(lights[0][5].r, 0.01f);
}

TEST(Bounces, OfGlossyPixelsComeFromMattVertices) {
    PrecomputeOptions how = options(Pixels{.width = 20, .height = 16});
    how.surface = everywhere({.albedo = glm::vec3(0.5f),
                              .specular = glm::vec3(0.04f),
                              .highlight = prt::Highlight::Ggx,
                              .roughness_or_exponent = 0.5f});
    how.glossy_tolerance = 0.1f;
    LitScene lit(precompute(corner(9), how));
    const std::vector<prt::Surface>& surfaces = lit.scene().receivers.surfaces;
    EXPECT_EQ(surfaces.front().highlight, prt::Highlight::Ggx);
    EXPECT_EQ(surfaces.back().highlight, prt::Highlight::None);
    const std::vector<glm::vec3> light = bounced(lit);
    EXPECT_GT(light.front().g, 0.0f);
    EXPECT_EQ(draw(lit).pixels.size(), 320u);
}

} // namespace
} // namespace relumine
