#include "relumine/mesh.h"

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
    EXPECT_EQ(plain.source_hash, prt::file_hash(file("squares.ply")));
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

TEST_F(MeshFile, ThatIsAbsentIsNamed) {
    try {
        static_cast<void>(load_mesh(file("absent.ply")));
        FAIL() << "loaded a mesh that is not there";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("absent.ply"), std::string::npos);
    }
}

} // namespace
} // namespace relumine
