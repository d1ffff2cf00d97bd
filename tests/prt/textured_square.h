// A mesh whose texture is finer than its vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "mesh/materials/texture.h"
#include "mesh/tangents.h"
#include "mesh/triangle_mesh.h"

namespace relumine::scenes {

/// An uncompressed TGA file of 4 x 1 pixels: black, red, green, blue.
inline std::string four_colors_tga() {
    std::string file("\0\0\2\0\0\0\0\0\0\0\0\0\4\0\1\0\x18\x20", 18);
    file += std::string("\0\0\0\0\0\xff\0\xff\0\xff\0\0", 12); // blue, green, red
    return file;
}

/// A square [-1, 1] x [-1, 1] in the plane z = 0 that faces +Z, two triangles. The texture runs
/// from left to right.
inline mesh::TriangleMesh textured_square() {
    mesh::TriangleMesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}};
    mesh.normals.assign(4, glm::vec3(0, 0, 1));
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
    mesh.uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    const std::string file = four_colors_tga();
    mesh::ImageBudget budget;
    mesh.textures.push_back(
        mesh::decode_texture(std::as_bytes(std::span(file)), mesh::VOrigin::Bottom, budget));
    mesh.materials = {{.name = "plain", .base_color = {0.5f, 0.25f, 1.0f}},
                      {.name = "textured",
                       .base_color = {1.0f, 1.0f, 0.5f},
                       .base_color_texture = mesh::TextureSlot{
                           .texture = 0, .is_srgb = true, .wrap = {mesh::Wrap::Clamp, {}}}}};
    mesh.triangle_materials = {1, 1};
    return mesh;
}

/// The same square, grey, with a normal map of one colour.
inline mesh::TriangleMesh mapped_square(const std::array<std::uint8_t, 3>& color) {
    mesh::TriangleMesh mesh = textured_square();
    mesh.textures[0].texels.assign(4, color);
    mesh.materials = {{.name = "grey", .base_color = glm::vec3(0.5f)}};
    mesh.materials[0].normal_texture = mesh::TextureSlot{.texture = 0};
    mesh.triangle_materials = {0, 0};
    mesh::set_tangents(mesh, {});
    return mesh;
}

/// The same with a map of 64 columns that tilt to the right and to the left by 45 degrees in turn.
inline mesh::TriangleMesh striped_square() {
    mesh::TriangleMesh mesh = mapped_square({255, 128, 255});
    mesh.textures[0].width = mesh.textures[0].height = 64;
    mesh.textures[0].texels.clear();
    for (int i = 0; i < 64 * 64; ++i)
        mesh.textures[0].texels.push_back(
            {i % 2 == 0 ? std::uint8_t{255} : std::uint8_t{0}, 128, 255});
    return mesh;
}

} // namespace relumine::scenes
