#include "relumine/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "files/hash.h"
#include "mesh/floor.h"
#include "mesh/save.h"
#include "prt/scene/scene_file.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

class MeshFile : public scenes::InFolder {};

TEST_F(MeshFile, KnowsItsOriginAndItsFloor) {
    const mesh::TriangleMesh squares = scenes::two_squares();
    mesh::save(file("squares.ply"), squares, squares.colors);

    const Mesh plain = load_mesh(file("squares.ply"));
    EXPECT_EQ(plain.geometry.positions, squares.positions);
    EXPECT_EQ(plain.source, file("squares.ply").string());
    EXPECT_EQ(plain.source_hash, files::file_hash(file("squares.ply")));
    EXPECT_EQ(plain.floor_vertices, 0u);

    const Mesh standing =
        load_mesh(file("squares.ply"), {.floor_vertices = 5, .floor_scale = 2.0f});
    mesh::TriangleMesh expected = mesh::load(file("squares.ply"));
    mesh::append_floor(expected, 5, 2.0f);
    EXPECT_EQ(standing.geometry.positions, expected.positions);
    EXPECT_EQ(standing.floor_vertices, 5u);
}

TEST_F(MeshFile, IsTurnedUpright) {
    const mesh::TriangleMesh squares = scenes::two_squares();
    mesh::save(file("squares.ply"), squares, squares.colors);
    const Mesh turned = load_mesh(file("squares.ply"), {.up = mesh::UpAxis::Z});
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(turned.geometry.normals[i], glm::vec3(0, 0, -1));
        EXPECT_EQ(turned.geometry.positions[i].y, squares.positions[i].z);
    }
}

/// A cube of STL: eight corners, each with the normals of three faces.
TEST_F(MeshFile, OfStlHasSharpEdgesUnlessTheyAreToBeSmooth) {
    std::string text = "solid s\n";
    const std::array<std::array<int, 4>, 6> faces = {
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& face : faces)
        for (const auto& corners :
             {std::array{face[0], face[1], face[2]}, std::array{face[0], face[2], face[3]}}) {
            text += "facet normal 0 0 0\nouter loop\n";
            for (const int corner : corners)
                text += fmt::format("vertex {} {} {}\n", corner & 1, corner >> 1 & 1, corner >> 2);
            text += "endloop\nendfacet\n";
        }
    const std::filesystem::path path = file("cube.stl");
    std::ofstream(path) << text << "endsolid s\n";
    const Mesh sharp = load_mesh(path);
    EXPECT_EQ(sharp.geometry.num_vertices(), 24u);
    for (const glm::vec3& normal : sharp.geometry.normals)
        EXPECT_NEAR(std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}), 1.0f,
                    1e-6f);
    EXPECT_EQ(load_mesh(path, {.normals = mesh::NormalSource::Smooth}).geometry.num_vertices(), 8u);
    EXPECT_EQ(load_mesh(path, {.crease = 120.0f}).geometry.num_vertices(), 8u);
}

TEST_F(MeshFile, RefinedKeepsTheFloorLastAndTheBlockersAsTheyWere) {
    Mesh mesh(scenes::two_squares());
    mesh::append_floor(mesh.geometry, 3);
    mesh.floor_vertices = 3;
    const mesh::TriangleMesh before = mesh.geometry;
    const std::size_t num_own = before.num_vertices() - 9;
    const Mesh fine = refined(mesh, {.error = 0.0f, .max_vertices = 300});
    ASSERT_TRUE(fine.blockers);
    EXPECT_EQ(fine.blockers->positions, before.positions);
    EXPECT_EQ(fine.blockers->triangles, before.triangles);
    const std::vector<glm::vec3>& positions = fine.geometry.positions;
    EXPECT_TRUE(std::equal(before.positions.begin(),
                           before.positions.begin() + static_cast<std::ptrdiff_t>(num_own),
                           positions.begin()));
    ASSERT_GT(fine.floor_added, 0u);
    const std::size_t first = positions.size() - 9 - fine.floor_added;
    for (std::size_t i = 0; i < 9; ++i)
        EXPECT_EQ(positions[first + i], before.positions[num_own + i]);
    for (std::size_t i = 0; i < positions.size(); ++i)
        EXPECT_EQ(positions[i].y == before.positions.back().y, i >= first) << i;
    // The scene knows its floor.
    const Scene scene = unclustered_scene(fine);
    EXPECT_TRUE(scene.blockers);
    // A curved surface throws its own shadows.
    EXPECT_FALSE(refined(mesh, {.error = {}, .max_edge = 0.3f, .curved = true}).blockers);
    EXPECT_THROW(static_cast<void>(refined(mesh, {.max_vertices = 3})), std::runtime_error);
}

TEST_F(MeshFile, SimplifiedKeepsTheFloorAndTheBlockers) {
    Mesh mesh(scenes::two_squares());
    mesh::append_floor(mesh.geometry, 5);
    mesh.floor_vertices = 5;
    const Mesh coarse = simplified(mesh, 4);
    ASSERT_TRUE(coarse.blockers);
    EXPECT_EQ(coarse.blockers->positions, mesh.geometry.positions);
    EXPECT_TRUE(std::equal(mesh.geometry.positions.end() - 25, mesh.geometry.positions.end(),
                           coarse.geometry.positions.end() - 25));
    EXPECT_THROW(static_cast<void>(simplified(mesh, 2)), std::runtime_error);
}

TEST_F(MeshFile, ThatIsAbsentIsNamed) {
    try {
        static_cast<void>(load_mesh(file("absent.ply")));
        FAIL() << "loaded a mesh that is not there";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("absent.ply"), std::string::npos);
    }
}

TEST(RefinedMesh, TheFloorSinksUnderACurvedMesh) {
    // An octahedron of radius 1 whose normals are a ball's, lying on two of its lower triangles'
    // common edge: the curved edge bulges below it.
    mesh::TriangleMesh octahedron;
    const float s = std::sqrt(0.5f);
    octahedron.positions = {{s, s, 0}, {-s, s, 0}, {-s, -s, 0}, {s, -s, 0}, {0, 0, 1}, {0, 0, -1}};
    octahedron.normals = octahedron.positions;
    octahedron.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4},
                            {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}};
    mesh::append_floor(octahedron, 2);
    Mesh mesh(octahedron);
    mesh.floor_vertices = 2;
    const float height = octahedron.positions.back().y;
    const Mesh flat = refined(mesh, {.error = {}, .max_edge = 0.3f});
    EXPECT_EQ(flat.geometry.positions.back().y, height);
    const Mesh curved = refined(mesh, {.error = {}, .max_edge = 0.3f, .curved = true});
    const std::size_t num_of_ball = curved.geometry.num_vertices() - 4 - curved.floor_added;
    float lowest = 0.0f, highest_of_floor = -10.0f;
    for (std::size_t i = 0; i < curved.geometry.num_vertices(); ++i) {
        const float y = curved.geometry.positions[i].y;
        if (i < num_of_ball)
            lowest = std::min(lowest, y);
        else
            highest_of_floor = std::max(highest_of_floor, y);
    }
    EXPECT_LT(lowest, height) << "it bulges";
    EXPECT_LT(highest_of_floor, lowest);
    EXPECT_NEAR(lowest - highest_of_floor, -s - height, 1e-6f) << "as far below as before";
    EXPECT_EQ(curved.geometry.positions[3], octahedron.positions[3]);
}

} // namespace
} // namespace relumine
