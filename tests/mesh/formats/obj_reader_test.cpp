#include "files/pixel_values.h"
#include "mesh/edge_uses.h"
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
            replace_all(box_obj(), "f 2 3 7\n", "usemtl x\ns 1\nl 1 2\np 1\ng a b\nf 2 3 7\n")));
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
    ASSERT_EQ(mesh.num_vertices(), 6u) << "the third has two normals";
    EXPECT_EQ(mesh.uvs, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 0}, {1, 0}, {0, 0}, {0, 0}}));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 5, 3}}));
    EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.normals[2], glm::vec3(1, 0, 0));
    EXPECT_EQ(mesh.normals[4], glm::vec3(0.0f)) << "unreferenced";
    EXPECT_EQ(mesh.normals[5], glm::vec3(0, 0, 1));
    EXPECT_EQ(obj(text, NormalSource::Smooth).normals[2], glm::vec3(0, 0, 1));
    EXPECT_EQ(obj(text, NormalSource::Smooth).num_vertices(), 5u);
}

/// A cube of eight vertices, and lines that faces of `suffixes` have: " 0//1" for suffix "//1".
std::string cube_obj(const std::vector<std::string>& suffixes) {
    const std::vector<std::array<int, 4>> faces = {{6, 5, 7, 8}, {1, 2, 4, 3}, {4, 8, 7, 3},
                                                   {1, 5, 6, 2}, {2, 6, 8, 4}, {5, 1, 3, 7}};
    std::string text = "v -1 -1 -1\nv -1 -1 1\nv -1 1 -1\nv -1 1 1\n"
                       "v 1 -1 -1\nv 1 -1 1\nv 1 1 -1\nv 1 1 1\n"
                       "vn 1 0 0\nvn -1 0 0\nvn 0 1 0\nvn 0 -1 0\nvn 0 0 1\nvn 0 0 -1\n";
    for (std::size_t i = 0; i < faces.size(); ++i) {
        text += suffixes[i].starts_with("s ") ? suffixes[i] + "\nf" : "f";
        for (const int vertex : faces[i])
            text += fmt::format(" {}{}", vertex, suffixes[i].starts_with("s ") ? "" : suffixes[i]);
        text += '\n';
    }
    return text;
}

void expect_flat(const TriangleMesh& mesh) {
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t vertex : t)
            EXPECT_NEAR(glm::distance(glm::dvec3(mesh.normals[vertex]),
                                      glm::normalize(area_normal(mesh.positions, t))),
                        0.0, 1e-6);
}

TEST(ObjReader, NormalsBelongToCorners) {
    const TriangleMesh cube = obj("s off\n" + cube_obj({"//1", "//2", "//3", "//4", "//5", "//6"}));
    EXPECT_EQ(defect(cube), "");
    ASSERT_EQ(cube.num_vertices(), 24u);
    EXPECT_EQ(cube.positions[0], glm::vec3(-1, -1, -1)) << "the file's vertices come first";
    EXPECT_EQ(cube.positions[7], glm::vec3(1, 1, 1));
    expect_flat(cube);
    EXPECT_THAT(cube.notes,
                testing::ElementsAre("16 vertices are added behind the 8 of the file, where "
                                     "normals or colours of faces differ"));
    EXPECT_EQ(obj(cube_obj({"//1", "//1", "//1", "//1", "//1", "//1"})).num_vertices(), 8u);
    // A bend of less than a degree is the rounding of a file.
    const std::string bent = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0.01 0 1\n"
                             "vn 0.1 0 1\nf 1//1 2//1 3//1\n";
    EXPECT_EQ(obj(bent + "f 1//2 3//2 4//2\n").num_vertices(), 4u);
    EXPECT_EQ(obj(bent + "f 1//3 3//3 4//3\n").num_vertices(), 6u);
}

TEST(ObjReader, ACornerWithoutANormalCostsItAlone) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 1 0 0\nvn 0 0 0\n";
    for (const char* third : {"3", "3//2"}) {
        const TriangleMesh mesh = obj(vertices + "f 1//1 2//1 " + third + "\nf 2//1 4//1 3\n");
        EXPECT_EQ(mesh.num_vertices(), 4u);
        EXPECT_EQ(mesh.normals[0], glm::vec3(1, 0, 0));
        EXPECT_EQ(mesh.normals[1], glm::vec3(1, 0, 0));
        EXPECT_EQ(mesh.normals[2], glm::vec3(0, 0, 1)) << "that of the faces";
        EXPECT_THAT(mesh.notes, testing::ElementsAre("2 corners without a normal take that of the "
                                                     "faces around them"));
    }
    // Other corners of the vertex have one.
    const TriangleMesh shared = obj(vertices + "f 1//1 2//1 3//1\nf 2//1 4//1 3\n");
    EXPECT_EQ(shared.normals[2], glm::vec3(1, 0, 0));
    EXPECT_TRUE(shared.notes.empty());
}

TEST(ObjReader, SmoothingGroups) {
    const TriangleMesh off = obj(cube_obj({"s off", "s off", "s off", "s 0", "s off", "s off"}));
    EXPECT_EQ(off.num_vertices(), 24u);
    expect_flat(off);
    EXPECT_THAT(off.notes, testing::Contains("6 faces without normals are flat; --crease 180 "
                                             "rounds them"));
    const TriangleMesh smooth = obj(cube_obj({"", "", "", "", "", ""}));
    EXPECT_EQ(smooth.num_vertices(), 8u);
    EXPECT_TRUE(smooth.notes.empty());
    const TriangleMesh one = obj(cube_obj({"s 3", "s 3", "s 3", "s 3", "s 3", "s 3"}));
    EXPECT_EQ(one.num_vertices(), 8u);
    EXPECT_EQ(one.normals, smooth.normals);
    // The faces of +-X and +-Y are one group, those of +-Z flat.
    const TriangleMesh two = obj(cube_obj({"s 1", "s 1", "s 1", "s 1", "s off", "s off"}));
    EXPECT_EQ(two.num_vertices(), 16u);
    EXPECT_NEAR(glm::distance(two.normals[7], glm::normalize(glm::vec3(1, 1, 0))), 0.0f, 1e-6f);
    EXPECT_EQ(
        obj(cube_obj({"s off", "s off", "s off", "s off", "s off", "s off"}), NormalSource::Smooth)
            .normals,
        smooth.normals);
    // A flat face has one normal, though its corners are not in one plane.
    const TriangleMesh bent = obj("s off\nv 0 0 0\nv 1 0 0\nv 1 1 0.2\nv 0 1 0\nf 1 2 3 4\n");
    for (const glm::vec3& normal : bent.normals)
        EXPECT_EQ(normal, bent.normals[0]);
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
    const auto near = [](const glm::vec3& a, const glm::vec3& b) {
        return glm::distance(a, b) < 1e-5f;
    };
    // Other programs write sRGB.
    const glm::vec3 linear(1.0f, files::linear_of_srgb(0.5f), files::linear_of_srgb(0.25f));
    const TriangleMesh fractions = obj(box_obj(" 1 0.5 0.25"));
    EXPECT_EQ(fractions.colors, std::vector<glm::vec3>(8, linear));
    EXPECT_THAT(fractions.notes,
                testing::ElementsAre("colours are taken as sRGB, as other programs write them into "
                                     ".obj; --vertex-colors linear takes them otherwise"));
    EXPECT_EQ(obj(box_obj(" 1 0.5 0.25 1")).colors.size(), 8u);
    const TriangleMesh chosen =
        to_mesh(read_obj(bytes_of(box_obj(" 1 0.5 0.25"))), NormalSource::File, ColorCurve::Linear);
    EXPECT_EQ(chosen.colors, std::vector<glm::vec3>(8, {1.0f, 0.5f, 0.25f}));
    EXPECT_TRUE(chosen.notes.empty());
    EXPECT_TRUE(
        near(obj(box_obj(" 255 0 51")).colors[3], {1.0f, 0.0f, files::linear_of_srgb(0.2f)}));
    EXPECT_TRUE(near(obj(box_obj(" 204.5 0 51")).colors[3],
                     {files::linear_of_srgb(204.5f / 255.0f), 0.0f, files::linear_of_srgb(0.2f)}));
    EXPECT_THAT(obj(box_obj(" 204.5 0 51")).notes,
                testing::Contains("colours are taken as numbers of 0 to 255"));
    EXPECT_TRUE(
        near(obj(box_obj(" 65535 0 13107")).colors[3], {1.0f, 0.0f, files::linear_of_srgb(0.2f)}));
    EXPECT_GT(obj(box_obj(" 1.5 0 0")).colors[3].r, 1.5f) << "not by the look of it";
    EXPECT_EQ(obj(box_obj(" -0.5 0 0")).colors[3], glm::vec3(0.0f));
}

TEST(ObjReader, AVertexWithoutAColorIsWhite) {
    EXPECT_TRUE(obj(box_obj(" nan nan nan")).colors.empty());
    for (const char* odd : {"v 1 2 3", "v 1 2 3 nan 0 0"}) {
        const TriangleMesh mesh = obj(replace_all(box_obj(" 255 0 51"), "v 1 2 3 255 0 51", odd));
        ASSERT_EQ(mesh.colors.size(), 8u);
        EXPECT_EQ(mesh.colors[6], glm::vec3(1.0f));
        EXPECT_NEAR(mesh.colors[5].b, files::linear_of_srgb(0.2f), 1e-6f);
        EXPECT_THAT(mesh.warnings,
                    testing::ElementsAre("1 of 8 vertices have no colour, or none that is a "
                                         "number: they are white"));
    }
    const TriangleMesh first = obj(replace_all(box_obj(), "v 0 2 3", "v 0 2 3 1 0 0"));
    EXPECT_EQ(first.colors[0], glm::vec3(1.0f));
    EXPECT_EQ(first.colors[7], glm::vec3(1.0f, 0.0f, 0.0f));
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
