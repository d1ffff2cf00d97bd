// A plane with a normal map of one tilt: under any light that both horizons let pass, it is the
// tilted plane.
#include <numbers>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_gen/environments.h"
#include "relumine/in/precompute.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"
#include "tests/prt/textured_square.h"

namespace relumine {
namespace {

/// Of albedo 0.5.
constexpr std::array<std::uint8_t, 3> Flat = {127, 128, 255}, Tilted = {255, 128, 255};
const glm::vec3 TiltedNormal = glm::normalize(glm::vec3(1, 0, 1));

LitScene scene_of(const std::array<std::uint8_t, 3>& color, PrecomputeOptions options) {
    options.no_refine = true;
    options.view = View{.camera = Camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 20}};
    return LitScene(precompute(scenes::mapped_square(color), options));
}

TEST(NormalMaps, PixelsAndTexelsAreLitAsTheTiltedPlane) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(1, 2, 3));
    for (const PrecomputeOptions& options :
         {PrecomputeOptions{.receivers = Texels{.width = 4, .height = 4}},
          PrecomputeOptions{.receivers = Pixels{.width = 4, .height = 4}}}) {
        LitScene lit = scene_of(Tilted, options);
        lit.light(Light(std::vector<lights::DistantLight>{
            {.direction = direction, .irradiance = glm::dvec3(3.0)}}));
        const double expected =
            0.5 * 3.0 / std::numbers::pi * glm::dot(direction, glm::dvec3(TiltedNormal));
        for (const glm::vec3& radiance : lit.radiance())
            EXPECT_NEAR(radiance.g, expected, 1e-5);
    }
}

/// Half a sky of radiance 1, less what the plane hides of the tilted half.
TEST(NormalMaps, PixelsAndVerticesUnderAnEvenSky) {
    const double expected = 0.5 * 0.5 * (1.0 + std::numbers::sqrt2 / 2.0);
    const cubemap::CubeMap sky = data_gen::constant(16, glm::vec3(1.0f));
    LitScene pixels =
        scene_of(Tilted, {.tolerance = 0.02f, .receivers = Pixels{.width = 4, .height = 4}});
    pixels.light(sky);
    for (const glm::vec3& radiance : pixels.radiance())
        EXPECT_NEAR(radiance.g, expected, 0.005);
    LitScene vertices = scene_of(Tilted, {.tolerance = 0.02f});
    vertices.light(sky);
    for (const glm::vec3& radiance : vertices.radiance())
        EXPECT_NEAR(radiance.g, 0.5f, 0.001f) << "the mesh's own normal";
    const OutputOptions options{.width = 4, .height = 4, .samples_per_axis = 1};
    for (const glm::vec3& pixel : Painter(vertices, options).draw(vertices.lighting()).pixels)
        EXPECT_NEAR(pixel.g, expected, 0.02);
}

/// But for roundings.
MATCHER(NearlyEqual, "") {
    return glm::length(std::get<0>(arg) - std::get<1>(arg)) <=
           1e-6f * glm::length(std::get<1>(arg));
}

TEST(NormalMaps, AFlatMapChangesNothing) {
    const cubemap::CubeMap sky = data_gen::two_soft_boxes(16);
    const auto drawn = [&](const mesh::TriangleMesh& mesh, const PrecomputeOptions& options) {
        LitScene lit(precompute(mesh, options));
        lit.light(sky);
        return Painter(lit, {.width = 8, .height = 8}).draw(lit.lighting()).pixels;
    };
    const mesh::TriangleMesh mapped = scenes::mapped_square(Flat);
    mesh::TriangleMesh plain = mapped;
    plain.materials[0].normal_texture.reset();
    plain.corner_tangents.clear();
    for (const PrecomputeOptions& options :
         {PrecomputeOptions{.tolerance = 0.06f},
          PrecomputeOptions{.tolerance = 0.06f, .receivers = Pixels{.width = 8, .height = 8}},
          PrecomputeOptions{.tolerance = 0.06f, .receivers = Texels{.width = 8, .height = 8}}})
        EXPECT_THAT(drawn(mapped, options),
                    testing::Pointwise(NearlyEqual(), drawn(plain, options)));
}

/// Layers of pixels under a white sky: each lobe is cut into cells of its own, and kept in files.
TEST(NormalMaps, LayersOfAWhiteSurfaceStayWhite) {
    mesh::TriangleMesh mesh = scenes::mapped_square(Tilted);
    mesh.materials[0] = {.model = mesh::MaterialModel::MetallicRoughness,
                         .roughness = 0.5f,
                         .coat = 1.0f,
                         .coat_roughness = 0.4f,
                         .sheen = glm::vec3(1.0f),
                         .sheen_roughness = 0.5f};
    const Camera camera{.eye = {0, -3, 3}, .target = {0, 0, 0}, .fov_degrees = 20};
    const Scene scene = precompute(mesh, {.tolerance = 0.02f,
                                          .receivers = Pixels{.width = 4, .height = 4},
                                          .view = View{.camera = camera},
                                          .highlights = Highlights::Stored});
    ASSERT_TRUE(scene.transfer.glossy);
    for (const prt::GlossyLobe lobe : {prt::GlossyLobe::Coat, prt::GlossyLobe::Sheen})
        EXPECT_GT(scene.transfer.glossy->lobes[static_cast<std::size_t>(lobe)].num_entries(), 0u);
    LitScene lit(scene);
    lit.light(data_gen::constant(64, glm::vec3(1.0f)));
    for (const glm::vec3& radiance : lit.radiance())
        EXPECT_NEAR(radiance.g, 1.0f, 0.015f);
}

} // namespace
} // namespace relumine
