#include "prt/scene/packed_mesh.h"

#include <algorithm>
#include <cstring>
#include <string>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

SectionReader reader_of(const NewSections& sections) {
    return SectionReader("mesh", packed_sections(sections, Packing::Best));
}

mesh::TriangleMesh read_again(const mesh::TriangleMesh& mesh) {
    NewSections sections;
    add_packed_mesh(sections, mesh);
    const SectionReader reader = reader_of(sections);
    EXPECT_TRUE(has_packed_mesh(reader));
    mesh::TriangleMesh result;
    read_packed_mesh(reader, result);
    return result;
}

TEST(PackedMesh, IsNearlyWhatWasPacked) {
    mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    for (glm::vec3& position : mesh.positions)
        position = 300.0f * position + glm::vec3(1000.0f, -20.0f, 3.0f);
    mesh.normals[7] = glm::vec3(0.0f);
    for (const glm::vec3& axis : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
        mesh.normals.push_back(axis);
        mesh.normals.push_back(-axis);
        mesh.positions.resize(mesh.normals.size(), mesh.positions[0]);
    }
    const mesh::TriangleMesh again = read_again(mesh);
    EXPECT_EQ(again.triangles, mesh.triangles);
    ASSERT_EQ(again.positions.size(), mesh.positions.size());
    ASSERT_EQ(again.normals.size(), mesh.normals.size());
    const glm::vec3 size = mesh::bounds(std::span(mesh.positions)).size();
    const float step = std::max({size.x, size.y, size.z}) / 65'535.0f;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::vec3 off = glm::abs(again.positions[i] - mesh.positions[i]);
        EXPECT_LE(std::max({off.x, off.y, off.z}), 0.51f * step) << i;
        EXPECT_LT(glm::distance(again.normals[i], mesh.normals[i]), 4e-6f) << i;
    }
    EXPECT_EQ(again.normals[7], glm::vec3(0.0f));
    for (std::size_t i = mesh.normals.size() - 6; i < mesh.normals.size(); ++i)
        EXPECT_EQ(again.normals[i], mesh.normals[i]) << "an axis";
}

TEST(PackedMesh, OfOnePointIsThere) {
    mesh::TriangleMesh mesh;
    mesh.positions.assign(3, {1, 2, 3});
    mesh.normals.assign(3, {0, 1, 0});
    mesh.triangles = {{0, 2, 1}};
    const mesh::TriangleMesh again = read_again(mesh);
    EXPECT_EQ(again.positions, mesh.positions);
    EXPECT_EQ(again.triangles, mesh.triangles);
}

TEST(PackedMesh, OfBrokenBytesSaysWhichSection) {
    const mesh::TriangleMesh mesh = scenes::box({0, 0, 0}, {1, 1, 1});
    for (const std::string name : {"packed_positions", "packed_normals", "packed_triangles"}) {
        NewSections sections;
        add_packed_mesh(sections, mesh);
        sections[name] = std::vector<std::byte>(5);
        mesh::TriangleMesh result;
        EXPECT_THAT([&] { read_packed_mesh(reader_of(sections), result); },
                    testing::ThrowsMessage<std::runtime_error>(testing::AllOf(
                        testing::HasSubstr(name), testing::HasSubstr("1 to 4 bytes for each of"))));
    }
    NewSections sections;
    add_packed_mesh(sections, mesh);
    sections["packed_counts"] = std::vector<std::byte>(8);
    mesh::TriangleMesh result;
    EXPECT_THROW(read_packed_mesh(reader_of(sections), result), std::runtime_error);
}

} // namespace
} // namespace relumine::prt
