#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

std::string box_obj(const std::string& vertex_suffix = "") {
    std::string text = box_vertex_lines("v ", vertex_suffix);
    for (const auto& face : BoxFaces) {
        text += 'f';
        for (const std::uint32_t vertex : face)
            text += fmt::format(" {}", vertex + 1);
        text += '\n';
    }
    return text;
}

TEST(ObjReader, KeepsVerticesAndCutsPolygons) {
    expect_box(obj(box_obj()));
    EXPECT_TRUE(obj(box_obj()).colors.empty());
    EXPECT_TRUE(obj(box_obj()).uvs.empty());
}

TEST(ObjReader, LineEndsWhiteSpaceAndComments) {
    const std::string text = box_obj();
    expect_box(obj(replace_all(text, "\n", "\r\n")));
    expect_box(obj(replace_all(text, "\n", "\r")));
    expect_box(obj(text.substr(0, text.size() - 1)));
    expect_box(obj("\xEF\xBB\xBF# C:\\box\\\n" + replace_all(text, "\n", " # comment\n\n")));
    expect_box(obj(replace_all(replace_all(text, " ", "\t "), "v", "  v")));
    expect_box(obj(replace_all(text, "f 1 ", "f\\\n 1 \\\n")));
    expect_box(obj(replace_all(text, "v 1 2 3", "v +1.0 .2E1 3.")));
}

TEST(ObjReader, SkipsOtherStatements) {
    expect_box(
        obj("mtllib a.mtl\no box\n" +
            replace_all(box_obj(), "f 2 3 7\n", "usemtl x\ns off\nl 1 2\np 1\ng a b\nf 2 3 7\n")));
}

TEST(ObjReader, NegativeIndicesCountBackFromTheNewestElement) {
    std::string text = box_vertex_lines("v ");
    for (const auto& face : BoxFaces) {
        text += 'f';
        for (const std::uint32_t vertex : face)
            text += fmt::format(" {}", static_cast<int>(vertex) - 8);
        text += '\n';
    }
    expect_box(obj(text));
    // Relative to the place in the file, not to its end.
    const TriangleMesh mesh = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n");
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(ObjReader, FacesMayComeBeforeTheirVertices) {
    EXPECT_EQ(obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").triangles,
              (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(ObjReader, PositionsUvsAndNormalsHaveTheirOwnCounts) {
    const std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\n"
                             "vt 0 0\nvt 1 0 0\nvn 0 0 2\nvn 1 0 0\n"
                             "f 1/1/1 2/2/1 3/1/2\nf 1/1/1 3/1/1 4/2/1\n";
    const TriangleMesh mesh = obj(text);
    EXPECT_EQ(defect(mesh), "");
    EXPECT_EQ(mesh.num_vertices(), 5u);
    EXPECT_EQ(mesh.uvs, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 0}, {1, 0}, {0, 0}}));
    EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, 1));
    EXPECT_NEAR(glm::distance(mesh.normals[2], glm::vec3(std::sqrt(0.5f), 0, std::sqrt(0.5f))),
                0.0f, 1e-6f);
    EXPECT_EQ(mesh.normals[4], glm::vec3(0.0f)) << "unreferenced";
    EXPECT_EQ(obj(text, NormalSource::Smooth).normals[2], glm::vec3(0, 0, 1));
}

TEST(ObjReader, NormalsCountOnlyIfEveryCornerHasOne) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nvn 0 0 0\n";
    EXPECT_EQ(obj(vertices + "f 1//1 2//1 3//1\n").normals[0], glm::vec3(1, 0, 0));
    EXPECT_EQ(obj(vertices + "f 1//1 2//1 3\n").normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(obj(vertices + "f 1//1 2//1 3//2\n").normals[0], glm::vec3(0, 0, 1))
        << "a zero normal is none";
}

TEST(ObjReader, UvsCountOnlyIfVerticesHaveOne) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 0\n";
    EXPECT_TRUE(obj(vertices + "f 1/1 2/2 3/1\nf 2/1 4/1 3/1\n").uvs.empty()) << "a seam";
    EXPECT_EQ(obj(vertices + "f 1/1 2/2 3/1\nf 2/3 4/1 3/1\n").uvs.size(), 4u)
        << "equal coordinates";
    EXPECT_TRUE(obj(vertices + "f 1/1 2/2 3/1\nf 2 4 3\n").uvs.empty());
    EXPECT_EQ(obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/2/1 3/3/1\n").num_triangles(), 1u)
        << "lists that are absent";
}

TEST(ObjReader, ColorsOfVertices) {
    expect_box(obj(box_obj(" 1.0")));
    EXPECT_EQ(obj(box_obj(" 1 0.5 0.25")).colors, std::vector<glm::vec3>(8, {1.0f, 0.5f, 0.25f}));
    EXPECT_EQ(obj(box_obj(" 1 0.5 0.25 1")).colors.size(), 8u);
    EXPECT_EQ(obj(box_obj(" 255 0 51")).colors[3], glm::vec3(1.0f, 0.0f, 0.2f));
    EXPECT_TRUE(obj(box_obj(" nan nan nan")).colors.empty());
    EXPECT_TRUE(
        obj(replace_all(box_obj(" 1 0.5 0.25"), "v 1 2 3 1 0.5 0.25", "v 1 2 3")).colors.empty());
}

TEST(ObjReader, SkipsFacesOfFewerThanThreeCorners) {
    const TriangleMesh mesh = obj(box_obj() + "f 1 2\nf 3\nf\n");
    expect_box(mesh);
    EXPECT_THAT(mesh.warnings, testing::ElementsAre("3 of 10 faces have fewer than three corners"));
    expect_refusal([] { return obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n"); },
                   "got 3 vertices and 1 faces");
}

TEST(ObjReader, RefusesWhatItWouldMisread) {
    const std::string text = box_obj();
    const auto refused = [&text](const char* from, const char* to, const std::string& part) {
        ASSERT_NE(text.find(from), std::string::npos);
        expect_refusal([&] { return obj(replace_all(text, from, to)); }, part);
    };
    refused("v 1 0 0", "v nan 0 0", "nan 0 0 at vertex 1");
    refused("v 1 0 0", "v 1e60 0 0", "inf");
    refused("v 1 0 0", "v 1 abc 0", "a number in line 2, got 'abc'");
    refused("v 1 0 0", "v 1 0", "line 2");
    refused("v 1 0 0", "v 1 0 0 0 0", "line 2");
    refused("v 1 0 0", "v 1,5 0 0", "'1,5'");
    refused("f 1 4", "f 1 44", "vertex indices of 1 to 8, got 44");
    refused("f 1 4", "f 0 4", "'0'");
    refused("f 1 4", "f -9 4", "'-9'");
    refused("f 1 4", "f 4294967297 4", "4294967297");
    refused("f 1 4", "f 99999999999999999999 4", "whole number");
    refused("f 1 4", "f 1.5 4", "'1.5'");
    refused("f 1 4", "f 1/x 4", "'x'");
    expect_refusal([&] { return obj("vt 0 0\n" + text + "f 1/1 2/2 3/1\n"); },
                   "texture coordinate indices of 1 to 1, got 2");
    expect_refusal([&] { return obj("vn 0 0 1\n" + text + "f 1//1 2//2 3//1\n"); },
                   "normal indices of 1 to 1, got 2");
    expect_refusal([] { return obj(""); }, "vertices, got none");
    expect_refusal([] { return obj("v 0 0 0\n"); }, "faces");
    expect_refusal([] { return obj(std::string_view("\xFF\xFEv\0", 4)); }, "UTF-16");
    expect_refusal([] { return obj(std::string_view("v\0 \0", 4)); }, "NUL");
}

} // namespace
} // namespace relumine::mesh
