// What glows of a mesh.
#include <vector>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "prt/lamps/lamps.h"
#include "tests/prt/textured_square.h"

namespace relumine::prt {
namespace {

using testing::ElementsAre;

double area_of(const mesh::TriangleMesh& mesh, const Emitter& emitter) {
    const auto [a, b, c] = corners_of(mesh, emitter);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

/// A unit square of two triangles whose emission has a texture of n x n texels: the left half has
/// the radiance 4, the right one 0.
mesh::TriangleMesh screen(std::uint32_t n) {
    mesh::TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh::Texture texture;
    texture.width = texture.height = n;
    for (std::uint32_t i = 0; i < n * n; ++i) {
        const auto level = static_cast<std::uint8_t>(i % n < n / 2 ? 255 : 0);
        texture.texels.push_back({level, level, level});
    }
    mesh.textures = {texture};
    mesh.materials = {{.name = "screen",
                       .emission = glm::vec3(4.0f),
                       .emission_texture = mesh::TextureSlot{.texture = 0}}};
    mesh.triangle_materials = {0, 0};
    return mesh;
}

TEST(Lamps, ATextureKeepsItsPower) {
    for (const std::uint32_t n : {4u, 16u, 128u, 512u}) {
        const mesh::TriangleMesh mesh = screen(n);
        const Lamps lamps = lamps_of(mesh);
        double power = 0.0;
        for (const Emitter& emitter : lamps.emitters)
            power += area_of(mesh, emitter) * double{emitter.radiance.r};
        // Half of 4; the square is repeated, so its edges mix.
        EXPECT_NEAR(power, 2.0, n < 16 ? 0.3 : 0.05) << n;
        EXPECT_EQ(lamps.groups, std::vector<std::string>{""});
    }
    EXPECT_EQ(lamps_of(screen(4)).emitters.size(), 2u);
    // 512 x 512 texels: 64 parts of each triangle, of which half are dark.
    const Lamps fine = lamps_of(screen(512));
    EXPECT_GT(fine.emitters.size(), 250u);
    EXPECT_LT(fine.emitters.size(), 400u);
}

TEST(Lamps, PartsTileTheirTriangle) {
    mesh::TriangleMesh mesh = screen(4);
    for (const std::uint32_t first : {1u, 4u, 16u, 64u, 256u}) {
        double area = 0.0;
        glm::dvec3 middle(0.0);
        for (std::uint32_t part = first; part < 2 * first; ++part) {
            const Emitter emitter{.triangle = 0, .part = part};
            const auto [a, b, c] = corners_of(mesh, emitter);
            area += area_of(mesh, emitter);
            middle += (a + b + c) / 3.0 / static_cast<double>(first);
            EXPECT_NEAR(area_of(mesh, emitter), 0.5 / first, 1e-9);
            EXPECT_GT(glm::cross(b - a, c - a).z, 0.0) << "as the triangle runs";
        }
        EXPECT_NEAR(area, 0.5, 1e-9);
        EXPECT_NEAR(middle.x, 2.0 / 3.0, 1e-6);
        EXPECT_NEAR(middle.y, 1.0 / 3.0, 1e-6);
    }
}

TEST(Lamps, HaveTheGroupsThatGlow) {
    mesh::TriangleMesh mesh = screen(4);
    mesh.materials = {{.name = "wall"},
                      {.name = "lamp", .emission = {1, 2, 3}},
                      {.name = "sign", .model = mesh::MaterialModel::Unlit}};
    mesh.triangles.push_back({0, 1, 3});
    mesh.triangle_materials = {0, 1, 2};
    mesh.groups = {"room", "bulb", "exit"};
    mesh.triangle_groups = {0, 1, 2};
    const Lamps lamps = lamps_of(mesh);
    EXPECT_THAT(lamps.groups, ElementsAre("bulb"));
    EXPECT_THAT(lamps.emitters,
                ElementsAre(Emitter{.triangle = 1, .radiance = glm::vec3(1, 2, 3)}));
    EXPECT_THAT(lamp_groups(mesh, lamps), ElementsAre(NoGroup, 0u, NoGroup));
    // Another material in its place glows no more.
    const Lamps none =
        lamps_of(mesh, [](const auto&, std::uint32_t, const Surface&) { return Surface{}; });
    EXPECT_TRUE(none.empty());
}

} // namespace
} // namespace relumine::prt
