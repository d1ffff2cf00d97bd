#include "prt/visibility/see_through.h"

#include <cmath>
#include <limits>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/visibility/ray_scene.h"
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
        std::size_t num_known = 0;
        for (std::uint32_t triangle = 0; triangle < card.num_triangles(); ++triangle) {
            const bool may_pass = see_through.may_pass(triangle, RayOf::Light);
            num_known += may_pass ? 0 : 1;
            for (int i = 0; i < 20; ++i) {
                const glm::vec2 at(weight(random), weight(random));
                const mesh::Veil veil = mesh::veil(card, triangle, at);
                EXPECT_EQ(may_pass && see_through.passes({.triangle = triangle, .barycentric = at},
                                                         RayOf::SettledLight),
                          veil.through.r >= 0.5f);
                EXPECT_EQ(see_through.veil(triangle, at), veil);
            }
        }
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

} // namespace
} // namespace relumine::prt
