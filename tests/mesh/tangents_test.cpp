#include "mesh/tangents.h"

#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::mesh {
namespace {

Material mapped() {
    Material material;
    material.normal_texture = TextureSlot();
    return material;
}

/// A square [0, 1]^2 in the plane z = 0 that faces +Z, with a normal map.
TriangleMesh square(VOrigin origin) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.normals.assign(4, glm::vec3(0, 0, 1));
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.textures.resize(1);
    mesh.textures[0].origin = origin;
    mesh.materials = {mapped()};
    mesh.triangle_materials = {0, 0};
    return mesh;
}

/// Expects each corner's tangent to be the direction of u, and its bitangent to be that of the
/// picture's upper side.
void expect_all(const TriangleMesh& mesh, const glm::vec3& tangent, const glm::vec3& bitangent) {
    ASSERT_EQ(mesh.corner_tangents.size(), mesh.num_triangles());
    for (const auto& corners : mesh.corner_tangents)
        for (const glm::vec4& own : corners) {
            EXPECT_LT(glm::distance(glm::vec3(own), tangent), 1e-6f);
            EXPECT_LT(glm::distance(own.w * glm::cross({0, 0, 1}, glm::vec3(own)), bitangent),
                      1e-6f);
        }
}

TEST(Tangents, FollowUAndTheUpperSideOfThePicture) {
    TriangleMesh mesh = square(VOrigin::Bottom);
    set_tangents(mesh, {});
    expect_all(mesh, {1, 0, 0}, {0, 1, 0});
    mesh = square(VOrigin::Top); // v grows downwards in the picture
    set_tangents(mesh, {});
    expect_all(mesh, {1, 0, 0}, {0, -1, 0});
    // A turned and a mirrored picture.
    mesh = square(VOrigin::Bottom);
    mesh.materials[0].normal_texture->uv_from_mesh_uv = glm::mat2(0, -1, 1, 0);
    set_tangents(mesh, {});
    expect_all(mesh, {0, 1, 0}, {-1, 0, 0});
    mesh = square(VOrigin::Bottom);
    mesh.materials[0].normal_texture->uv_from_mesh_uv = glm::mat2(-1, 0, 0, 1);
    set_tangents(mesh, {});
    expect_all(mesh, {-1, 0, 0}, {0, 1, 0});
    mesh = square(VOrigin::Bottom);
    mesh.second_uvs = {{0, 1}, {0, 0}, {1, 0}, {1, 1}};
    mesh.materials[0].normal_texture->uv_set = 1;
    set_tangents(mesh, {});
    expect_all(mesh, {0, 1, 0}, {-1, 0, 0});
}

TEST(Tangents, AreOnlyOfNormalMaps) {
    TriangleMesh mesh = square(VOrigin::Bottom);
    mesh.materials.emplace_back();
    mesh.triangle_materials = {0, 1};
    set_tangents(mesh, {});
    EXPECT_EQ(mesh.corner_tangents[1][0], glm::vec4(0.0f));
    mesh.materials.erase(mesh.materials.begin());
    mesh.triangle_materials = {0, 0};
    mesh.corner_tangents.clear();
    set_tangents(mesh, {});
    EXPECT_TRUE(mesh.corner_tangents.empty());
}

/// The halves of a picture that is mirrored in the middle do not mix, although they share vertices.
TEST(Tangents, OfMirroredHalvesStayApart) {
    TriangleMesh mesh = square(VOrigin::Bottom);
    mesh.positions = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.uvs = {{1, 0}, {0, 0}, {1, 0}, {0, 1}};
    mesh.triangles = {{0, 1, 3}, {1, 2, 3}};
    set_tangents(mesh, {});
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(mesh.corner_tangents[0][k], glm::vec4(-1, 0, 0, -1));
        EXPECT_EQ(mesh.corner_tangents[1][k], glm::vec4(1, 0, 0, 1));
    }
}

/// Two triangles with uvs that are turned by 90 degrees share vertex 0, whose corners are 90 and 45
/// degrees wide: the mean counts them so, also where vertices are repeated.
TEST(Tangents, AreMeansByAngle) {
    TriangleMesh mesh = square(VOrigin::Bottom);
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-1, 1, 0}};
    mesh.normals.assign(5, glm::vec3(0, 0, 1));
    mesh.triangles = {{0, 1, 2}, {3, 2, 4}};
    // Of the second, u grows by 1 along +Y and by 1 along (-1, 1): towards +Y.
    mesh.corner_uvs = {{{{0, 0}, {1, 0}, {0, 1}}}, {{{0, 0}, {1, 0}, {1, 1}}}};
    set_tangents(mesh, {});
    const double first = std::numbers::pi / 2, second = std::numbers::pi / 4;
    const glm::vec3 expected(glm::normalize(glm::dvec3(first, second, 0.0)));
    EXPECT_LT(glm::distance(glm::vec3(mesh.corner_tangents[0][0]), expected), 1e-6f);
    EXPECT_EQ(mesh.corner_tangents[1][0], mesh.corner_tangents[0][0]);
    EXPECT_LT(glm::distance(glm::vec3(mesh.corner_tangents[0][1]), glm::vec3(1, 0, 0)), 1e-6f);
}

TEST(Tangents, OfNoUvsAreStillUnitVectorsAcrossTheNormal) {
    TriangleMesh mesh = square(VOrigin::Bottom);
    mesh.uvs.clear();
    set_tangents(mesh, {});
    for (const auto& corners : mesh.corner_tangents)
        for (const glm::vec4& own : corners) {
            EXPECT_NEAR(glm::length(glm::vec3(own)), 1.0f, 1e-6f);
            EXPECT_EQ(own.z, 0.0f);
        }
}

} // namespace
} // namespace relumine::mesh
