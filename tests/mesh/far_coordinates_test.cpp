// Meshes far from the origin, as maps have them: floats there are half a metre apart.
#include <cmath>

#include <fmt/format.h>

#include "mesh/load.h"
#include "mesh/save.h"
#include "mesh/up_axis.h"
#include "tests/mesh/gltf_model.h"
#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

using FarCoordinates = MeshFileTest;

/// Where the box stands: easting, height, northing.
constexpr glm::dvec3 Place(691234.1, 520.3, 5334567.7);

glm::dvec3 far_corner(std::size_t i) {
    return Place + 0.1 * glm::dvec3(BoxPositions[i]);
}

std::string lines_of(const std::string& prefix) {
    std::string text;
    for (std::size_t i = 0; i < BoxPositions.size(); ++i) {
        const glm::dvec3 p = far_corner(i);
        text += fmt::format("{}{:.4f} {:.4f} {:.4f}\n", prefix, p.x, p.y, p.z);
    }
    return text;
}

std::string obj_faces() {
    std::string text;
    for (const auto& face : BoxFaces) {
        text += 'f';
        for (const std::uint32_t corner : face)
            text += fmt::format(" {}", corner + 1);
        text += '\n';
    }
    return text;
}

std::string ascii_stl() {
    std::string text = "solid far\n";
    for (const auto& face : BoxFaces)
        for (std::size_t i = 2; i < face.size(); ++i) {
            text += "facet normal 0 0 0\nouter loop\n";
            for (const std::uint32_t corner : {face[0], face[i - 1], face[i]}) {
                const glm::dvec3 p = far_corner(corner);
                text += fmt::format("vertex {:.4f} {:.4f} {:.4f}\n", p.x, p.y, p.z);
            }
            text += "endloop\nendfacet\n";
        }
    return text + "endsolid far\n";
}

std::string binary_ply() {
    std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty double x\n"
                       "property double y\nproperty double z\nelement face 1\n"
                       "property list uchar int vertex_indices\nend_header\n";
    for (std::size_t i = 0; i < BoxPositions.size(); ++i) {
        const glm::dvec3 p = far_corner(i);
        text.append(reinterpret_cast<const char*>(&p), sizeof p);
    }
    text += '\3';
    const std::array<std::int32_t, 3> corners = {0, 1, 2};
    return text.append(reinterpret_cast<const char*>(corners.data()), sizeof corners);
}

std::string ascii_ply() {
    return "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\n"
           "property double z\nelement face 7\nproperty list uchar int vertex_indices\n"
           "end_header\n" +
           lines_of("") + box_face_lines();
}

/// All places are within what the file says, and the note is there.
void expect_at_its_place(const TriangleMesh& mesh, bool has_file_order = true) {
    ASSERT_EQ(mesh.num_vertices(), 8u);
    EXPECT_NE(mesh.offset, glm::dvec3(0.0));
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_LT(glm::length(mesh.positions[i]), 2.0f);
        double nearest = 1.0;
        for (std::size_t k = 0; k < 8; ++k)
            if (!has_file_order || k == i)
                nearest =
                    std::min(nearest, glm::length(mesh.offset + glm::dvec3(mesh.positions[i]) -
                                                  far_corner(k)));
        EXPECT_LT(nearest, 1e-4) << i;
    }
    ASSERT_FALSE(mesh.notes.empty());
    EXPECT_THAT(mesh.notes.back(), testing::HasSubstr("coordinates are far from the origin: ("));
}

TEST_F(FarCoordinates, TextAndDoublesKeepTheirDigits) {
    expect_at_its_place(obj(lines_of("v ") + obj_faces()));
    expect_at_its_place(off("OFF\n8 7 0\n" + lines_of("") + box_face_lines()));
    expect_at_its_place(ply(ascii_ply()));
    expect_at_its_place(ply(binary_ply()));
    expect_at_its_place(stl(ascii_stl()), false);
}

/// glTF has floats, but nodes move them in double; camera and lights go along.
TEST_F(FarCoordinates, NodesOfGltfMoveInDouble) {
    Model model = square();
    model.json["extensionsUsed"] = {"KHR_lights_punctual"};
    model.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    model.json["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    model.json["nodes"] = {{{"children", {1, 2, 3}}, {"translation", {Place.x, Place.y, Place.z}}},
                           {{"mesh", 0}, {"scale", {0.1, 0.1, 0.1}}},
                           {{"camera", 0}, {"translation", {0.05, 0.0, 1.0}}},
                           {{"translation", {0.0, 0.3, 0.7}},
                            {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
    const LoadedMesh mesh = load(write("far.gltf", model.embedded()));
    const auto place = [&](const glm::vec3& p) {
        return mesh.offset + glm::dvec3(p) - Place;
    };
    ASSERT_EQ(mesh.num_vertices(), 4u);
    EXPECT_LT(glm::length(place(mesh.positions[2]) - glm::dvec3(0.1, 0.1, 0.0)), 1e-6);
    ASSERT_EQ(mesh.lights.size(), 1u);
    EXPECT_LT(glm::length(place(mesh.lights[0].position) - glm::dvec3(0.0, 0.3, 0.7)), 1e-6);
    ASSERT_TRUE(mesh.camera.has_value());
    EXPECT_LT(glm::length(place(mesh.camera->eye) - glm::dvec3(0.05, 0.0, 1.0)), 1e-6);
    EXPECT_LT(glm::length(place(mesh.camera->target) - glm::dvec3(0.05, 0.0, 0.0)), 1e-6);
}

/// A few stray vertices, at the origin as well, do not hold the others back.
TEST_F(FarCoordinates, StrayVerticesDoNotCount) {
    std::string text;
    for (int i = 0; i < 5; ++i)
        text += lines_of("v ");
    const TriangleMesh mesh = obj(text + "v 0 0 0\n" + obj_faces());
    EXPECT_LT(glm::length(mesh.positions[0]), 2.0f);
    EXPECT_LT(glm::length(mesh.offset + glm::dvec3(mesh.positions.back())), 1.0);
}

TEST_F(FarCoordinates, WrittenFilesHaveTheirPlaceAgain) {
    const TriangleMesh mesh = load(write("far.obj", lines_of("v ") + obj_faces()));
    const std::vector<glm::vec3> radiance(mesh.num_vertices(), glm::vec3(0.5f));
    save(folder_ / "a.obj", mesh);
    save(folder_ / "a.ply", mesh);
    save(folder_ / "a.glb", mesh);
    save_lit(folder_ / "lit.ply", mesh, radiance);
    save_lit(folder_ / "lit.glb", mesh, radiance);
    for (const char* name : {"a.obj", "a.ply", "a.glb", "lit.ply", "lit.glb"}) {
        SCOPED_TRACE(name);
        expect_at_its_place(load(folder_ / name));
    }
    TriangleMesh turned = mesh;
    turn_up(turned, UpAxis::Z);
    EXPECT_EQ(turned.offset, glm::dvec3(mesh.offset.x, mesh.offset.z, -mesh.offset.y));
    const glm::dvec3 first = far_corner(0);
    EXPECT_LT(glm::length(load_points(folder_ / "a.ply", mesh.offset).front() -
                          glm::vec3(first - mesh.offset)),
              1e-4f);
}

TEST_F(FarCoordinates, OthersStayAsTheyAre) {
    // Ten sizes away: floats have enough digits.
    const TriangleMesh near = obj("v 10.1 0 0\nv 11.2 0 0\nv 10.3 1.1 0\nf 1 2 3\n");
    EXPECT_EQ(near.offset, glm::dvec3(0.0));
    EXPECT_EQ(near.positions[0], glm::vec3(10.1f, 0, 0));
    EXPECT_TRUE(near.notes.empty());
    // So have those of a file of floats that is less far than they round it away.
    EXPECT_EQ(stl(box_binary_stl()).offset, glm::dvec3(0.0));
    EXPECT_EQ(obj("v 100 0 0\nv 101 0 0\nv 100 1 0\nf 1 2 3\n").offset, glm::dvec3(0.0));
}

/// Floats that are far have no more digits to give. Cameras and rays beside the mesh have.
TEST_F(FarCoordinates, CoordinatesThatWereRoundedAreTold) {
    const TriangleMesh mesh = obj("v 691234 520 5334567\nv 691235 520 5334567\n"
                                  "v 691234 521 5334567\nf 1 2 3\n");
    EXPECT_EQ(mesh.offset, glm::dvec3(691234, 520, 5334567));
    EXPECT_EQ(mesh.positions[1], glm::vec3(1, 0, 0));
    EXPECT_THAT(mesh.warnings,
                testing::ElementsAre(testing::HasSubstr("coordinates are about 0.636 apart from "
                                                        "each other at (691234, 520, 5334567), "
                                                        "which is coarse for a mesh of 1.41")));
    EXPECT_THAT(mesh.notes, testing::ElementsAre(testing::HasSubstr("far from the origin")));
}

} // namespace
} // namespace relumine::mesh
