// Small scenes for the tests of the door, and a folder for their files.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "data_gen/scenes.h"
#include "relumine/relumine.h"
#include "tests/own_folder.h"

namespace relumine::scenes {

inline constexpr float Tolerance = 0.06f;

/// A boulder on a floor, a thousand vertices, which precompute() keeps: a fifteenth of what it
/// would make of them.
[[nodiscard]] inline Mesh boulder() {
    Mesh mesh(data_gen::blob(1000));
    mesh.is_open = false;
    return mesh;
}

/// A square over another, with uvs that fill the atlas, colours and no material.
[[nodiscard]] inline mesh::TriangleMesh two_squares() {
    mesh::TriangleMesh mesh;
    mesh.positions = {{-1, 0, 1},  {1, 0, 1},      {1, 0, -1},         {-1, 0, -1},
                      {0, 0.5, 0}, {0.6f, 0.5, 0}, {0.6f, 0.5, -0.6f}, {0, 0.5, -0.6f}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    mesh.normals.assign(8, {0, 1, 0});
    mesh.uvs = {{0, 0}, {0.5, 0}, {0.5, 1}, {0, 1}, {0.5, 0}, {1, 0}, {1, 1}, {0.5, 1}};
    mesh.colors.assign(8, {0.5f, 0.25f, 1.0f});
    return mesh;
}

/// A blue sky with a sun of one texel.
[[nodiscard]] inline cubemap::CubeMap sun_and_sky() {
    cubemap::CubeMap map(16, glm::vec3(0.2f, 0.3f, 0.5f));
    map.at(cubemap::Face::PositiveZ, 8, 3) = glm::vec3(60.0f);
    return map;
}

/// Two squares of n x n vertices that meet at a right angle and face each other: a floor and a red
/// wall. The floor has the left half of the atlas.
[[nodiscard]] inline mesh::TriangleMesh corner(std::uint32_t n) {
    mesh::TriangleMesh mesh;
    for (const bool is_wall : {false, true}) {
        const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
        for (std::uint32_t j = 0; j < n; ++j)
            for (std::uint32_t i = 0; i < n; ++i) {
                const float s = static_cast<float>(i) / static_cast<float>(n - 1);
                const float t = static_cast<float>(j) / static_cast<float>(n - 1);
                mesh.positions.push_back(is_wall ? glm::vec3(s, t, 0.0f) : glm::vec3(s, 0.0f, t));
                mesh.normals.push_back(is_wall ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0));
                mesh.colors.push_back(is_wall ? glm::vec3(0.8f, 0.1f, 0.1f) : glm::vec3(0.5f));
                mesh.uvs.emplace_back(0.01f + 0.48f * s + (is_wall ? 0.5f : 0.0f),
                                      0.02f + 0.96f * t);
            }
        for (std::uint32_t j = 0; j + 1 < n; ++j)
            for (std::uint32_t i = 0; i + 1 < n; ++i) {
                const std::uint32_t at = first + j * n + i;
                const mesh::Triangle a = {at, at + 1, at + n + 1}, b = {at, at + n + 1, at + n};
                mesh.triangles.push_back(is_wall ? a : mesh::Triangle{a[0], a[2], a[1]});
                mesh.triangles.push_back(is_wall ? b : mesh::Triangle{b[0], b[2], b[1]});
            }
    }
    return mesh;
}

class InFolder : public tests::FolderTest {
protected:
    [[nodiscard]] std::filesystem::path file(const std::string& name) const {
        return folder_ / name;
    }
    [[nodiscard]] std::string read(const std::string& name) const {
        std::ifstream stream(file(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    /// Expects that a scene is not saved once `damage` is done to it, for a reason that says
    /// `what`, and that no file is left.
    template<typename Damage>
    void refuses_damage(Scene scene, const Damage& damage, const char* what) const {
        damage(scene);
        const std::string said = tests::message_of([&] { save_scene(file("damaged.prt"), scene); });
        EXPECT_NE(said.find(what), std::string::npos) << said;
        EXPECT_FALSE(std::filesystem::exists(file("damaged.prt")));
    }
};

} // namespace relumine::scenes
