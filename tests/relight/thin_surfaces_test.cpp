// Light and pictures behind what is blended, and behind glass.
#include <cmath>

#include <gtest/gtest.h>

#include "prt/precompute.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/picture_view.h"
#include "relight/pictures/receiver_picture.h"
#include "relight/reference/exact.h"
#include "relight/relighter.h"
#include "tests/prt/leaf_card.h"
#include "tests/prt/scenes.h"

namespace relumine::relight {
namespace {

/// A floor under sheets so wide that they cover the sky.
mesh::TriangleMesh under_sheets(int count, const mesh::Material& material) {
    mesh::TriangleMesh mesh = scenes::floor_grid(5, 1.0f);
    for (int i = 0; i < count; ++i)
        mesh =
            scenes::joined(mesh, scenes::floor_grid(2, 60.0f, 0.3f + 0.1f * static_cast<float>(i)));
    mesh.materials = {{.name = "floor"}, material};
    mesh.triangle_materials.assign(mesh.num_triangles(), 1);
    std::fill_n(mesh.triangle_materials.begin(), 32, 0);
    return mesh;
}

/// Returns the mean radiance of the floor's vertices, and checks each, under a white sky.
double light_of_floor(const mesh::TriangleMesh& mesh, double expected) {
    prt::Receivers receivers = prt::vertex_receivers(mesh);
    receivers.positions.resize(25);
    receivers.normals.resize(25);
    const prt::RayScene rays(mesh);
    const float bias = 1e-3f;
    const prt::PrecomputeOptions options{.face_resolution = 64, .bias = bias};
    const prt::Transfer by_rays = prt::precompute(receivers, rays, options);
    const prt::Transfer transfer = prt::precompute(receivers, prt::BeamScene(mesh, rays), options);
    EXPECT_EQ(transfer.counts.visible, by_rays.counts.visible);
    EXPECT_EQ(transfer.quadtree.leaves().size(), by_rays.quadtree.leaves().size());
    EXPECT_LT(transfer.num_clusters(), 4000u) << "chance alone would split all 24576 cells";
    Relighter relighter(transfer);
    relighter.set_environment(cubemap::CubeMap(32, glm::vec3(1.0f)));
    double sum = 0.0;
    for (const glm::vec3& b : relighter.radiance()) {
        EXPECT_NEAR(b.g, expected, 0.03);
        sum += static_cast<double>(b.g) / 25.0;
    }
    return sum;
}

TEST(ThinSurfaces, LetTheirPartOfTheLightPass) {
    const mesh::Material blended{.alpha_mode = mesh::AlphaMode::Blend, .alpha = 0.3f};
    EXPECT_NEAR(light_of_floor(under_sheets(1, blended), 0.7), 0.7, 0.01);
    EXPECT_NEAR(light_of_floor(under_sheets(2, blended), 0.49), 0.49, 0.01)
        << "behind two it is the product";
    // A thin sheet of glass: its mean tint, but for what it reflects.
    const mesh::Material glass{.base_color = {0.9f, 0.6f, 0.3f}, .transmission = 0.5f};
    EXPECT_NEAR(light_of_floor(under_sheets(1, glass), 0.288), 0.288, 0.01);
}

/// Of a few neighbouring lights, as a sun is cut into, every place sees about the right part.
TEST(ThinSurfaces, AFewLightsPassEvenly) {
    const mesh::Material blended{.alpha_mode = mesh::AlphaMode::Blend, .alpha = 0.4f};
    const prt::RayScene rays(under_sheets(1, blended));
    double squares = 0.0, mean = 0.0;
    constexpr int NumPlaces = 400, Side = 3;
    for (int place = 0; place < NumPlaces; ++place) {
        const glm::vec3 origin(0.001f * static_cast<float>(place), 0.01f, 0.2f);
        int passed = 0;
        for (int i = 0; i < Side * Side; ++i)
            passed += rays.occluded(origin, glm::normalize(glm::vec3(
                                                0.3f + 0.003f * static_cast<float>(i % Side), 1.0f,
                                                0.2f + 0.003f * static_cast<float>(i / Side))))
                          ? 0
                          : 1;
        const double part = passed / static_cast<double>(Side * Side);
        mean += part / NumPlaces;
        squares += (part - 0.6) * (part - 0.6) / NumPlaces;
    }
    EXPECT_NEAR(mean, 0.6, 0.02);
    EXPECT_LT(std::sqrt(squares), 0.667 * std::sqrt(0.6 * 0.4 / (Side * Side)))
        << "two thirds of the noise of plain chance";
}

/// From below: a sheet of alpha 0.25, one of alpha 0.5, and an opaque one.
TEST(ThinSurfaces, PicturesBlendWhatIsBehindInOrder) {
    mesh::TriangleMesh mesh = scenes::floor_grid(2, 60.0f, 3.0f);
    for (const float height : {1.0f, 2.0f})
        mesh = scenes::joined(mesh, scenes::floor_grid(2, 60.0f, height));
    mesh.materials = {{}};
    for (const float alpha : {0.25f, 0.5f})
        mesh.materials.push_back({.alpha_mode = mesh::AlphaMode::Blend, .alpha = alpha});
    mesh.triangle_materials = {0, 0, 1, 1, 2, 2};
    const prt::RayScene rays(mesh);
    std::vector<glm::vec3> radiance(12, glm::vec3(0.0f));
    for (std::size_t i = 0; i < 12; ++i)
        radiance[i][static_cast<int>(i / 4)] = 1.0f;
    // Blue behind, then red and green before it.
    std::rotate(radiance.begin(), radiance.begin() + 8, radiance.end());
    const Camera camera{.eye = {0.1f, 0.0f, 0.2f}, .target = {0.0f, 1.0f, 0.0f}};
    const glm::vec3 expected(0.25f, 0.75f * 0.5f, 0.75f * 0.5f);
    const auto check = [&](const Picture& picture) {
        for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
            EXPECT_LT(glm::length(picture.pixels[i] - expected), 1e-5f);
            EXPECT_NEAR(picture.alpha[i], 1.0f, 1e-5f);
        }
    };
    check(
        PictureView(mesh, rays, camera, {.width = 4, .height = 4}).cut_out({.radiance = radiance}));
    const prt::PixelReceivers pixels = prt::pixel_receivers(
        mesh, rays, {.camera = camera, .width = 4, .height = 4, .samples_per_axis = 2});
    ASSERT_EQ(pixels.receivers.size(), 3u * 64u);
    std::vector<glm::vec3> of_pixels;
    for (const prt::MeshPoint& point : pixels.receivers.points)
        of_pixels.push_back(prt::value_at(mesh, radiance, point));
    check(compose_cut_out(pixels.layout, of_pixels, {}, pixels.receivers.veils));
}

TEST(ThinSurfaces, VeilsOfGlass) {
    mesh::TriangleMesh mesh = scenes::floor_grid(2, 1.0f);
    mesh.triangle_materials = {0, 0};
    mesh.materials = {{.base_color = {0.25f, 1.0f, 0.0f}, .transmission = 1.0f}};
    const auto through = [&] {
        return mesh::veil(mesh, 0, glm::vec2(0.2f)).through;
    };
    EXPECT_LT(glm::length(through() - 0.96f * glm::vec3(0.25f, 1.0f, 0.0f)), 1e-6f);
    // Two surfaces of a body 2 thick, where a way of 1 leaves a half.
    mesh.materials[0].thickness = 2.0f;
    mesh.materials[0].attenuation_color = glm::vec3(0.5f);
    mesh.materials[0].attenuation_distance = 1.0f;
    EXPECT_LT(glm::length(through() - 0.96f * 0.5f * glm::vec3(0.5f, 1.0f, 0.0f)), 1e-6f);
    mesh.materials[0].metallic = 1.0f;
    EXPECT_EQ(through(), glm::vec3(0.0f)) << "metals are opaque";
    mesh::Texture texture;
    texture.width = texture.height = 1;
    texture.texels = {{0, 0, 51}};
    mesh.textures = {texture};
    mesh.uvs.assign(mesh.num_vertices(), glm::vec2(0.5f));
    mesh.materials[0].thickness = 0.0f;
    mesh.materials[0].metallic_roughness_texture = mesh::TextureSlot{};
    EXPECT_LT(glm::length(through() - 0.8f * 0.96f * glm::vec3(0.25f, 1.0f, 0.0f)), 1e-6f)
        << "a fifth is metal by its texture";
    EXPECT_EQ(mesh::veil(mesh::blockers_of(mesh), 0, glm::vec2(0.2f)).through, through());
}

} // namespace
} // namespace relumine::relight
