#include "prt/visibility/see_through.h"

#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "mesh/opacity.h"
#include "prt/visibility/ray_scene.h"
#include "prt/visibility/veil_cells.h"
#include "tests/prt/leaf_card.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// How far a point of a card of side 1 with one leaf lies inside of the leaf's disc, in texels.
float inside_leaf(float x, float z) {
    return (scenes::LeafRadius - std::hypot(x, z)) * scenes::LeafSize;
}

TEST(SeeThrough, RaysStopAtLeavesAndPassBetweenThem) {
    const RayScene rays(scenes::leaf_card(1, 1.0f, 1.0f));
    std::mt19937 random(1);
    std::uniform_real_distribution<float> place(-0.49f, 0.49f);
    int num_blocked = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 target(place(random), 1.0f, place(random));
        const float inside = inside_leaf(target.x, target.z);
        if (std::abs(inside) < 1.0f) // the texture's edge
            continue;
        // From both sides.
        const glm::vec3 origin(place(random), i % 2 == 0 ? 0.0f : 3.0f, place(random));
        const glm::vec3 direction = glm::normalize(target - origin);
        EXPECT_EQ(rays.occluded(origin, direction), inside > 0.0f);
        EXPECT_EQ(rays.closest_hit(origin, direction).has_value(), inside > 0.0f);
        EXPECT_EQ(rays.closest_hit(origin, direction, RayOf::Eye).has_value(), inside > 0.0f);
        num_blocked += inside > 0.0f ? 1 : 0;
    }
    EXPECT_GT(num_blocked, 600);
    EXPECT_LT(num_blocked, 1400);
}

TEST(SeeThrough, RaysGoOnBehindWhatTheyPass) {
    const RayScene rays(
        scenes::with_card(scenes::floor_grid(2, 4.0f), scenes::leaf_card(1, 1.0f, 1.0f)));
    const auto height_of_hit = [&](float x) {
        const auto hit = rays.closest_hit({x, 2.0f, 0.0f}, {0.0f, -1.0f, 0.0f});
        return hit ? 2.0f - hit->distance : -1.0f;
    };
    EXPECT_FLOAT_EQ(height_of_hit(0.1f), 1.0f) << "a leaf";
    EXPECT_FLOAT_EQ(height_of_hit(0.46f), 0.0f) << "beside it";
}

TEST(SeeThrough, PacketsAnswerAsSingleRays) {
    const RayScene rays(scenes::leaf_card(3, 1.0f, 1.0f));
    std::mt19937 random(2);
    std::uniform_real_distribution<float> place(-0.6f, 0.6f);
    for (int round = 0; round < 200; ++round) {
        const glm::vec3 origin(place(random), 0.0f, place(random));
        DirectionPacket packet;
        packet.num_directions = PacketSize;
        for (std::size_t i = 0; i < PacketSize; ++i)
            packet.set(i, glm::normalize(glm::vec3(place(random), 1.0f, place(random)) - origin));
        std::array<Hit, PacketSize> hits;
        const std::uint32_t blocked = rays.occluded(origin, packet, 0xffff);
        const std::uint32_t found = rays.closest_hits(origin, packet, 0xffff, hits);
        EXPECT_EQ(found, blocked);
        for (std::size_t i = 0; i < PacketSize; ++i)
            EXPECT_EQ(rays.occluded(origin, packet.direction(i)), (blocked >> i & 1u) != 0);
    }
}

/// The card of one leaf as n x n squares.
mesh::TriangleMesh divided_card(std::uint32_t n, mesh::AlphaMode mode) {
    mesh::TriangleMesh card = scenes::leaf_card(1, 1.0f, 1.0f, mode);
    card.positions.clear();
    card.uvs.clear();
    card.triangles.clear();
    for (std::uint32_t y = 0; y <= n; ++y)
        for (std::uint32_t x = 0; x <= n; ++x) {
            card.uvs.push_back(glm::vec2(x, y) / static_cast<float>(n));
            card.positions.emplace_back(card.uvs.back().x - 0.5f, 1.0f, card.uvs.back().y - 0.5f);
            if (const std::uint32_t i = y * (n + 1) + x; x < n && y < n) {
                card.triangles.push_back({i, i + n + 2, i + 1});
                card.triangles.push_back({i, i + n + 1, i + n + 2});
            }
        }
    card.normals.assign(card.num_vertices(), glm::vec3(0.0f, 1.0f, 0.0f));
    card.triangle_materials.assign(card.num_triangles(), 1);
    return card;
}

// Triangles that are all cut out, or all there, are known before rays meet them.
TEST(SeeThrough, SmallTrianglesPassAsTheirPointsDo) {
    for (const mesh::AlphaMode mode : {mesh::AlphaMode::Mask, mesh::AlphaMode::Blend}) {
        const mesh::TriangleMesh card = divided_card(23, mode);
        const SeeThrough see_through(card);
        std::mt19937 random(3);
        std::uniform_real_distribution<float> weight(0.0f, 0.5f);
        std::size_t num_known = 0, num_other = 0;
        for (std::uint32_t triangle = 0; triangle < card.num_triangles(); ++triangle) {
            const bool may_pass = see_through.may_pass(triangle, RayOf::Light);
            num_known += may_pass ? 0 : 1;
            for (int i = 0; i < 20; ++i) {
                const glm::vec2 at(weight(random), weight(random));
                const mesh::Veil veil = mesh::veil(card, triangle, at);
                const bool passes =
                    may_pass && see_through.passes({.triangle = triangle, .barycentric = at},
                                                   RayOf::SettledLight);
                num_other += passes != (veil.through.r >= 0.5f) ? 1 : 0;
                EXPECT_EQ(see_through.veil(triangle, at), veil);
            }
        }
        // The cells of what is blended are as wide as a texel.
        EXPECT_LE(num_other, mode == mesh::AlphaMode::Mask ? 0 : card.num_triangles() / 2);
        EXPECT_GT(num_known, card.num_triangles() / 4);
    }
}

TEST(SeeThrough, CellsOfAMaskSayWhatItsTextureDoes) {
    mesh::TriangleMesh card = scenes::leaf_card(1, 1.0f, 1.0f);
    mesh::Material& material = card.materials[1];
    const mesh::Texture& texture = card.textures[0];
    std::mt19937 random(3);
    std::uniform_real_distribution<float> place(-3.0f, 3.0f);
    for (const mesh::Wrap wrap : {mesh::Wrap::Repeat, mesh::Wrap::Mirror, mesh::Wrap::Clamp})
        for (const float cutoff : {0.1f, 0.5f, 0.9f}) {
            material.alpha_texture->wrap = {wrap, wrap};
            material.alpha_cutoff = cutoff;
            const MaskCells cells(material, texture);
            int num_mixed = 0;
            for (int i = 0; i < 5000; ++i) {
                glm::vec2 uv(place(random), place(random));
                if (i % 5 == 0) // where texels end
                    uv = glm::round(uv * 64.0f) / 64.0f;
                const MaskCells::Cell cell = cells.at(uv);
                if (cell == MaskCells::Cell::Mixed)
                    ++num_mixed;
                else
                    ASSERT_EQ(cell == MaskCells::Cell::There,
                              sample(texture, *material.alpha_texture, uv).r >= cutoff)
                        << uv.x << ", " << uv.y << ", wrap " << static_cast<int>(wrap);
            }
            EXPECT_GT(num_mixed, 0);
            EXPECT_LT(num_mixed, 2000) << "most points need no look at the texture itself";
        }
    const MaskCells cells(material, texture);
    EXPECT_EQ(cells.at({std::numeric_limits<float>::quiet_NaN(), 0.0f}), MaskCells::Cell::Mixed);
    EXPECT_EQ(cells.at({0.0f, -1e30f}), MaskCells::Cell::Mixed);
}

TEST(SeeThrough, EyesPassTheBacksOfSingleSidedFacesAndLightDoesNot) {
    mesh::TriangleMesh square = scenes::floor_grid(2, 2.0f);
    square.materials = {{.is_double_sided = false}};
    square.triangle_materials = {0, 0};
    const RayScene rays(square);
    const glm::vec3 up(0.0f, 1.0f, 0.0f);
    EXPECT_FALSE(rays.closest_hit(-up, up, RayOf::Eye)) << "a back";
    EXPECT_TRUE(rays.closest_hit(up, -up, RayOf::Eye)) << "a front";
    EXPECT_TRUE(rays.closest_hit(-up, up));
    EXPECT_TRUE(rays.occluded(-up, up));
    square.materials[0].is_double_sided = true;
    EXPECT_TRUE(RayScene(square).closest_hit(-up, up, RayOf::Eye));
}

TEST(SeeThrough, AFactorBelowTheCutoffRemovesTheSurface) {
    mesh::TriangleMesh square = scenes::floor_grid(2, 2.0f);
    square.materials = {{.alpha_mode = mesh::AlphaMode::Mask, .alpha = 0.4f}};
    square.triangle_materials = {0, 0};
    const glm::vec3 up(0.0f, 1.0f, 0.0f);
    EXPECT_FALSE(RayScene(square).occluded(-up, up));
    square.materials[0].alpha_cutoff = 0.4f;
    EXPECT_TRUE(RayScene(square).occluded(-up, up)) << "at the cutoff it is there";
}

/// A square of glass, [-1, 1] x [-1, 1], whose parts a texture of 40 x 30 random texels says.
mesh::TriangleMesh textured_glass() {
    mesh::TriangleMesh mesh = scenes::floor_grid(2, 2.0f);
    for (const glm::vec3& position : mesh.positions)
        mesh.uvs.emplace_back(0.5f * (position.x + 1.0f), 0.5f * (position.z + 1.0f));
    mesh::Texture texture{.name = "parts", .width = 40, .height = 30, .texels = {}};
    std::mt19937 random(4);
    for (int i = 0; i < 40 * 30; ++i)
        texture.texels.push_back({static_cast<std::uint8_t>(random() % 256),
                                  static_cast<std::uint8_t>(random() % 256), 0});
    mesh.textures = {std::move(texture)};
    mesh::Material glass{.name = "glass", .transmission = 0.9f};
    glass.transmission_texture = mesh::TextureSlot{.texture = 0};
    glass.base_color_texture = mesh::TextureSlot{.texture = 0};
    mesh.materials = {glass};
    mesh.triangle_materials.assign(mesh.num_triangles(), 0);
    return mesh;
}

TEST(VeilCells, HoldThePartsOfTexels) {
    const mesh::TriangleMesh mesh = textured_glass();
    ASSERT_TRUE(VeilCells::are_for(mesh.materials[0]));
    const VeilCells cells(mesh.materials[0], mesh.textures);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            const glm::vec2 uv((static_cast<float>(x) + 0.5f) / 40.0f,
                               (static_cast<float>(y) + 0.5f) / 30.0f);
            const glm::vec3 through = mesh::veil(mesh.materials[0], mesh.textures, uv).through;
            EXPECT_NEAR(cells.at(uv), (through.r + through.g + through.b) / 3.0f, 1e-5f);
            // The texture repeats.
            EXPECT_NEAR(cells.at(uv + glm::vec2(3.0f, -2.0f)), cells.at(uv), 1e-5f);
        }
    // What is blended has cells of its alpha. A mask has others.
    for (const mesh::AlphaMode mode : {mesh::AlphaMode::Blend, mesh::AlphaMode::Mask}) {
        const mesh::Material card{
            .alpha_mode = mode, .alpha = 0.8f, .alpha_texture = mesh::TextureSlot{.texture = 0}};
        ASSERT_EQ(VeilCells::are_for(card), mode == mesh::AlphaMode::Blend);
        if (mode == mesh::AlphaMode::Blend) {
            const glm::vec2 middle(20.5f / 40.0f, 10.5f / 30.0f);
            EXPECT_NEAR(VeilCells(card, mesh.textures).at(middle),
                        mesh::veil(card, mesh.textures, middle).through.r, 1e-5f);
        }
    }
    // Textures that lie in other ways have no place in common, and clear glass needs no cells.
    mesh::Material other = mesh.materials[0];
    other.base_color_texture->uv_offset = {0.5f, 0.0f};
    EXPECT_FALSE(VeilCells::are_for(other));
    EXPECT_FALSE(VeilCells::are_for({.name = "clear", .transmission = 1.0f}));
}

TEST(VeilCells, LetTheMeanPartOfRaysPass) {
    mesh::TriangleMesh mesh = textured_glass();
    // The mean of a product of two noises depends on how they are filtered.
    mesh.materials[0].base_color_texture.reset();
    const RayScene rays(mesh);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> place(-0.99f, 0.99f);
    double expected = 0.0, num_passed = 0.0;
    constexpr int NumRays = 20'000;
    for (int i = 0; i < NumRays; ++i) {
        const glm::vec3 at(place(random), 0.0f, place(random));
        const glm::vec2 uv(0.5f * (at.x + 1.0f), 0.5f * (at.z + 1.0f));
        const glm::vec3 through = mesh::veil(mesh.materials[0], mesh.textures, uv).through;
        expected += static_cast<double>((through.r + through.g + through.b) / 3.0f);
        num_passed += rays.occluded(at + glm::vec3(0, 1, 0), {0, -1, 0}) ? 0.0 : 1.0;
    }
    EXPECT_GT(expected / NumRays, 0.05);
    EXPECT_NEAR(num_passed / NumRays, expected / NumRays, 0.01);
}

// The grain of a texture must not split clusters: all rays that choose them stop or pass.
TEST(VeilCells, StopOrPassAsAWholeWhereClustersAreChosen) {
    for (const float transmission : {0.05f, 1.0f}) {
        mesh::TriangleMesh mesh = textured_glass();
        for (auto& texel : mesh.textures[0].texels)
            texel[0] = static_cast<std::uint8_t>(128 + texel[0] / 2); // the mean part is 0.72
        mesh.materials[0].base_color_texture.reset();
        mesh.materials[0].transmission = transmission;
        const RayScene rays(mesh);
        ASSERT_NE(rays.settled(), nullptr);
        const SeeThrough see_through(mesh);
        for (std::uint32_t triangle = 0; triangle < 2; ++triangle) {
            EXPECT_EQ(see_through.all_at(triangle, RayOf::Light), SeeThrough::All::Differ);
            EXPECT_EQ(see_through.all_at(triangle, RayOf::SettledLight),
                      transmission < 0.5f ? SeeThrough::All::Stop : SeeThrough::All::Pass);
        }
        DirectionPacket packet;
        for (std::size_t lane = 0; lane < PacketSize; ++lane)
            packet.set(lane, glm::normalize(glm::vec3(0.05f * static_cast<float>(lane), -1, 0.2f)));
        packet.num_directions = PacketSize;
        EXPECT_EQ(rays.settled()->occluded({-0.2f, 0.5f, 0.1f}, packet, 0xffff),
                  transmission < 0.5f ? 0xffffu : 0u);
    }
}

} // namespace
} // namespace relumine::prt
