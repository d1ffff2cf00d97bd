// A card of cut-out leaves.
#pragma once

#include <cstdint>

#include "mesh/triangle_mesh.h"

namespace relumine::scenes {

/// Texels of a leaf's texture along each axis.
inline constexpr std::uint32_t LeafSize = 32;
/// Of a leaf's disc, in widths of the leaf's square.
inline constexpr float LeafRadius = 0.4f;

/// A square with n x n leaves in the plane y = height, about the y axis. Alpha is 1 inside of the
/// discs and 0 outside, with one texel of an edge between.
[[nodiscard]] inline mesh::TriangleMesh leaf_card(std::uint32_t n, float side, float height,
                                                  mesh::AlphaMode mode = mesh::AlphaMode::Mask) {
    mesh::TriangleMesh mesh;
    const float h = 0.5f * side, uv = static_cast<float>(n);
    mesh.positions = {{-h, height, -h}, {h, height, -h}, {-h, height, h}, {h, height, h}};
    mesh.normals.assign(4, glm::vec3(0.0f, 1.0f, 0.0f));
    mesh.triangles = {{0, 3, 1}, {0, 2, 3}};
    mesh.uvs = {{0, 0}, {uv, 0}, {0, uv}, {uv, uv}};
    mesh::Texture leaf{.name = "leaf", .width = LeafSize, .height = LeafSize, .texels = {}};
    for (std::uint32_t y = 0; y < LeafSize; ++y)
        for (std::uint32_t x = 0; x < LeafSize; ++x) {
            const glm::vec2 from_middle =
                (glm::vec2(x, y) + 0.5f) / static_cast<float>(LeafSize) - 0.5f;
            const float inside = (LeafRadius - glm::length(from_middle)) * LeafSize + 0.5f;
            const auto alpha = static_cast<std::uint8_t>(255.0f * glm::clamp(inside, 0.0f, 1.0f));
            leaf.texels.push_back({alpha, alpha, alpha});
        }
    mesh.textures = {leaf};
    mesh.materials = {
        {.name = "opaque"},
        {.name = "leaves", .alpha_mode = mode, .alpha_texture = mesh::TextureSlot{.texture = 0}}};
    mesh.triangle_materials = {1, 1};
    return mesh;
}

/// A mesh of opaque triangles and a card.
[[nodiscard]] inline mesh::TriangleMesh with_card(mesh::TriangleMesh mesh,
                                                  const mesh::TriangleMesh& card) {
    const auto offset = static_cast<std::uint32_t>(mesh.num_vertices());
    mesh.triangle_materials.resize(mesh.num_triangles(), 0);
    mesh.uvs.resize(mesh.num_vertices(), glm::vec2(0.0f));
    const auto add = [](auto& values, const auto& more) {
        values.insert(values.end(), more.begin(), more.end());
    };
    add(mesh.positions, card.positions);
    add(mesh.normals, card.normals);
    add(mesh.uvs, card.uvs);
    add(mesh.triangle_materials, card.triangle_materials);
    for (const auto& [a, b, c] : card.triangles)
        mesh.triangles.push_back({a + offset, b + offset, c + offset});
    mesh.materials = card.materials;
    mesh.textures = card.textures;
    return mesh;
}

} // namespace relumine::scenes
