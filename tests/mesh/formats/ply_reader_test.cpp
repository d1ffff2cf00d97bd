#include "files/pixel_values.h"
#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

class PlyReaderTest : public testing::TestWithParam<const char*> {};

TEST_P(PlyReaderTest, EveryTypeOfNumber) {
    expect_box(ply(box_ply({.format = GetParam()})));
    for (const char* type : {"double", "short", "uchar", "int"})
        expect_box(ply(box_ply({.format = GetParam(), .coordinate_type = type})));
    for (const char* size_type : {"char", "ushort", "uint", "int"})
        for (const char* index_type : {"uchar", "short", "ushort", "uint"})
            expect_box(ply(box_ply({.format = GetParam(),
                                    .size_type = size_type,
                                    .index_type = index_type,
                                    .index_name = "vertex_index"})));
}

TEST_P(PlyReaderTest, ExtraPropertiesListsAndElements) {
    expect_box(ply(box_ply({.format = GetParam(), .face_list_before = true})));
    expect_box(ply(box_ply({.format = GetParam(), .face_list_after = true})));
    expect_box(ply(box_ply({.format = GetParam(), .other_element = true})));
    expect_box(ply(box_ply({.format = GetParam(), .faces_first = true})));
    const TriangleMesh mesh = ply(box_ply({.format = GetParam(),
                                           .coordinate_type = "double",
                                           .vertex_extras = true,
                                           .face_list_before = true,
                                           .face_list_after = true,
                                           .faces_first = true,
                                           .other_element = true}));
    expect_box(mesh);
    EXPECT_EQ(mesh.colors, std::vector<glm::vec3>(8, {1.0f, files::linear_of_srgb(0.2f), 0.0f}));
}

TEST_P(PlyReaderTest, LineEndsOfTheHeader) {
    const std::string text = box_ply({.format = GetParam()});
    const std::size_t body = text.find("end_header\n") + 11;
    expect_box(ply(replace_all(text.substr(0, body), "\n", "\r\n") + text.substr(body)));
    expect_box(ply(replace_all(text.substr(0, body), "\n", "\r") + text.substr(body)));
    expect_box(ply(replace_all(text, "comment a box", "comment end_header")));
    expect_box(ply(replace_all(text, "end_header\n", "end_header \n")));
    expect_box(ply(replace_all(text, "ply\n", "ply \t\n")));
}

/// Other tools skip lines that they do not know.
TEST_P(PlyReaderTest, UnknownLinesOfTheHeaderAreSkippedWithAWarning) {
    const std::string text = box_ply({.format = GetParam()});
    const TriangleMesh mesh = ply(replace_all(text, "element vertex",
                                              "obj_info num_cols 4\nTextureFile a.png\n"
                                              "element vertex"));
    expect_box(mesh);
    EXPECT_THAT(mesh.warnings,
                testing::ElementsAre("a line of the header that PLY does not have is skipped, the "
                                     "first of 'TextureFile'"));
    const TriangleMesh two = ply(replace_all(text, "element vertex", "a\nb\nelement vertex"));
    EXPECT_THAT(two.warnings, testing::ElementsAre("lines of the header that PLY does not have are "
                                                   "skipped, the first of 'a'"));
}

TEST_P(PlyReaderTest, RefusesTooMuchAndTooLittle) {
    const std::string text = box_ply({.format = GetParam()});
    for (const char* count : {"9", "1000", "4294967295", "100000000000", "9000000000000000000",
                              "99999999999999999999"}) {
        expect_refusal(
            [&] { return ply(replace_all(text, "vertex 8", fmt::format("vertex {}", count))); },
            "got");
        expect_refusal(
            [&] { return ply(replace_all(text, "face 7", fmt::format("face {}", count))); }, "got");
    }
    expect_refusal([&] { return ply(replace_all(text, "vertex 8", "vertex -8")); }, "'-8'");
    expect_refusal([&] { return ply(replace_all(text, "face 7", "face 6")); }, "end of the data");
    expect_refusal([&] { return ply(replace_all(text, "face 7", "face 0")); }, "end of the data");
    expect_refusal([&] { return ply(text + "1"); }, "end of the data");
    expect_box(ply(text + "\r\n"));
    // An element without properties takes no bytes, however many there are.
    expect_box(
        ply(replace_all(text, "end_header", "element nothing 1000000000000000\nend_header")));
}

INSTANTIATE_TEST_SUITE_P(Formats, PlyReaderTest,
                         testing::Values("ascii", "binary_little_endian", "binary_big_endian"));

TEST(PlyReader, AsciiLineEnds) {
    expect_box(ply(replace_all(box_ply(), "\n", "\r\n")));
    expect_box(ply(box_ply().substr(0, box_ply().size() - 2)));
}

std::string triangle_ply(const std::string& properties, const std::string& values) {
    return fmt::format("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                       "y\nproperty float z\n{}"
                       "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                       "0 0 0 {}\n1 0 0 {}\n0 1 0 {}\n3 0 1 2\n",
                       properties, values, values, values);
}

TEST(PlyReader, AttributesOfVertices) {
    const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
    EXPECT_EQ(ply(triangle_ply(normals, "0 3 4")).normals[0], glm::vec3(0.0f, 0.6f, 0.8f));
    EXPECT_EQ(ply(triangle_ply(normals, "0 3 4"), NormalSource::Smooth).normals[0],
              glm::vec3(0, 0, 1));
    EXPECT_EQ(ply(triangle_ply(normals, "0 0 0")).normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(ply(triangle_ply(normals, "nan 0 0")).normals[0], glm::vec3(0, 0, 1));

    EXPECT_EQ(ply(triangle_ply("property float s\nproperty float t\n", "0.25 0.5")).uvs[2],
              glm::vec2(0.25f, 0.5f));
    EXPECT_EQ(
        ply(triangle_ply("property float u\nproperty float v\nproperty float s\n", "0.25 0.5 9"))
            .uvs[2],
        glm::vec2(0.25f, 0.5f));
}

TEST(PlyReader, ColorsOfVertices) {
    const auto colored = [](const std::string& type, const std::string& values) {
        return ply(triangle_ply(fmt::format("property {0} red\nproperty {0} green\nproperty {0} "
                                            "blue\n",
                                            type),
                                values));
    };
    const auto near = [](const TriangleMesh& mesh, const glm::vec3& color) {
        return mesh.colors.size() == 3 && glm::distance(mesh.colors[2], color) < 1e-6f;
    };
    // Whole numbers are a screen's, as in other programs.
    const glm::vec3 linear(1.0f, files::linear_of_srgb(0.2f), 0.0f);
    for (const auto& [type, values] : {std::pair{"uchar", "255 51 0"},
                                       {"ushort", "65535 13107 0"},
                                       {"int", "255 51 0"},
                                       {"short", "255 51 0"}}) {
        const TriangleMesh mesh = colored(type, values);
        EXPECT_TRUE(near(mesh, linear)) << type;
        EXPECT_THAT(mesh.notes, testing::Contains("colours are taken as sRGB, as other programs "
                                                  "write whole numbers into .ply; --vertex-colors "
                                                  "linear takes them otherwise"));
    }
    const TriangleMesh floats = colored("float", "7.5 0.25 0");
    EXPECT_TRUE(near(floats, {7.5f, 0.25f, 0.0f})) << "HDR";
    EXPECT_THAT(floats.warnings, testing::ElementsAre(testing::HasSubstr("colours are up to 7.5")));
    EXPECT_THAT(floats.notes,
                testing::ElementsAre("colours are taken as linear, since they are floats; "
                                     "--vertex-colors srgb takes them otherwise"));
    EXPECT_TRUE(near(colored("float", "255 51 0"), {1.0f, 0.2f, 0.0f}));
    EXPECT_TRUE(near(colored("float", "204 25.5 0"), {0.8f, 0.1f, 0.0f}));
    EXPECT_TRUE(near(to_mesh(read_ply(bytes_of(triangle_ply("property uchar red\nproperty uchar "
                                                            "green\nproperty uchar blue\n",
                                                            "255 51 0"))),
                             NormalSource::File, ColorCurve::Linear),
                     {1.0f, 0.2f, 0.0f}));
    EXPECT_TRUE(colored("float", "nan 0.25 0").colors.empty());
    EXPECT_TRUE(ply(triangle_ply("property uchar red\n", "255")).colors.empty());
}

/// Two triangles over four vertices, with more properties and values of faces.
std::string square_ply(const std::string& properties, const std::string& first,
                       const std::string& second) {
    return fmt::format("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float "
                       "y\nproperty float z\nelement face 2\n{}end_header\n"
                       "0 0 0\n1 0 0\n1 0 -1\n0 0 -1\n{}\n{}\n",
                       properties, first, second);
}

TEST(PlyReader, ColorsOfFaces) {
    const std::string list = "property list uchar int vertex_indices\n";
    const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    for (const TriangleMesh& mesh :
         {ply(square_ply(list + colors, "3 0 1 2 255 0 0", "3 0 2 3 0 255 0")),
          ply(square_ply(colors + list, "255 0 0 3 0 1 2", "0 255 0 3 0 2 3"))}) {
        EXPECT_EQ(defect(mesh), "");
        ASSERT_EQ(mesh.num_vertices(), 6u) << "two corners are repeated";
        for (std::size_t i = 0; i < 2; ++i)
            for (const std::uint32_t vertex : mesh.triangles[i]) {
                EXPECT_EQ(mesh.colors[vertex], i == 0 ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0));
                EXPECT_EQ(mesh.normals[vertex], glm::vec3(0, 1, 0));
            }
    }
    // The normals stay smooth across the border of colours.
    const std::string bent = replace_all(
        square_ply(list + colors, "3 0 1 2 255 0 0", "3 0 2 3 0 255 0"), "1 0 -1\n", "1 0.5 -1\n");
    for (const NormalSource source : {NormalSource::File, NormalSource::Smooth}) {
        const TriangleMesh mesh = ply(bent, source);
        ASSERT_EQ(mesh.num_vertices(), 6u);
        EXPECT_LT(glm::distance(mesh.normals[0], mesh.normals[4]), 1e-6f);
    }
    EXPECT_EQ(ply(square_ply(list + colors, "3 0 1 2 9 9 9", "3 0 2 3 9 9 9")).num_vertices(), 4u);
    // Beside colours of vertices.
    const auto both = [&](const std::string& first, const std::string& second) {
        std::string text =
            replace_all(square_ply(list + colors, first, second), "0 0 0\n", "0 0 0 0 0 255\n");
        for (const char* other : {"1 0 0\n", "1 0 -1\n", "0 0 -1\n"})
            text = replace_all(text, other, replace_all(other, "\n", " 0 255 0\n"));
        return ply(replace_all(text, "float z\n", "float z\n" + colors));
    };
    EXPECT_EQ(both("3 0 1 2 255 0 0", "3 0 2 3 0 0 255").colors[0], glm::vec3(1, 0, 0));
    const TriangleMesh of_vertices = both("3 0 1 2 255 0 0", "3 0 2 3 255 0 0");
    EXPECT_EQ(of_vertices.colors[0], glm::vec3(0, 0, 1));
    EXPECT_THAT(of_vertices.notes, testing::Contains("vertices and faces have colours: those of "
                                                     "vertices are taken"));
}

TEST(PlyReader, UvsOfWedges) {
    const std::string properties =
        "property list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int "
        "texnumber\n";
    const TriangleMesh mesh =
        ply(square_ply(properties, "3 0 1 2 6 0 0 1 0 1 1 0", "3 0 2 3 6 0.5 0 0.5 1 0 1 0"));
    ASSERT_EQ(mesh.corner_uvs.size(), 2u);
    EXPECT_EQ(mesh.corner_uvs[0][2], glm::vec2(1, 1));
    EXPECT_EQ(mesh.corner_uvs[1][0], glm::vec2(0.5f, 0));
    const std::string named = replace_all(
        square_ply(properties, "3 0 1 2 6 0 0 1 0 1 1 0", "3 0 2 3 6 0.5 0 0.5 1 0 1 0"),
        "element vertex", "comment TextureFile   tex 1.png\nelement vertex");
    EXPECT_THAT(ply(named).warnings,
                testing::ElementsAre("the image 'tex 1.png', which a comment names, is left out: "
                                     "textures of .ply are not read"));
    EXPECT_EQ(mesh.num_vertices(), 4u);
    const TriangleMesh odd = ply(square_ply(properties, "3 0 1 2 6 0 0 1 0 1 1 0", "3 0 2 3 0 0"));
    EXPECT_EQ(odd.corner_uvs[1][0], glm::vec2(0, 0));
    EXPECT_THAT(odd.warnings, testing::ElementsAre("1 of 2 faces have no uvs of their corners, or "
                                                   "not two numbers for each"));
}

TEST(PlyReader, ANormalThatIsNoneCostsItAlone) {
    const std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 2\n"
        "property list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0 1\n1 0 0 nan 0 0\n1 0 -1 0 0 1\n0 0 -1 0 0 0\n3 0 1 2\n3 0 2 3\n";
    const TriangleMesh mesh = ply(text);
    EXPECT_EQ(mesh.normals, (std::vector<glm::vec3>{{0, 0, 1}, {0, 1, 0}, {0, 0, 1}, {0, 1, 0}}));
    EXPECT_THAT(mesh.notes, testing::ElementsAre("2 corners without a normal take that of the "
                                                 "faces around them"));
}

TEST(PlyReader, RefusesWhatItWouldMisread) {
    const std::string text = box_ply();
    const auto refused = [&text](const char* from, const char* to, const std::string& part) {
        ASSERT_NE(text.find(from), std::string::npos);
        expect_refusal([&] { return ply(replace_all(text, from, to)); }, part);
    };
    refused("format ascii 1.0", "format ascii 2.0", "format 1.0");
    refused("format ascii 1.0", "format utf8 1.0", "'utf8'");
    refused("format ascii 1.0\n", "", "''");
    refused("ply\n", "plx\n", "'plx'");
    refused("end_header", "end_head", "end_header");
    refused("property float x", "property float q", "x, y and z");
    refused("property float x", "property quad x", "'quad'");
    refused("property float x", "property float", "2 words");
    refused("property list uchar int", "property list float int", "size of a list");
    refused("property list uchar int", "property list uchar float", "vertex_indices");
    refused("vertex_indices", "corner_indices", "vertex_indices");
    refused("element face 7", "element vertex 7", "each element once");
    refused("element vertex 8\n", "", "an element before its properties");
    refused("3 1 2 6", "3 1 2 8", "vertex indices of 0 to 7, got 8");
    refused("3 1 2 6", "3 1 2 -1", "got -1");
    refused("3 1 2 6", "3 1 2 0.5", "got 0.5");
    refused("3 1 2 6", "3 1 2 x", "'x'");
    refused("3 1 2 6", "-3 1 2 6", "got -3");
    refused("3 1 2 6", "4000000000 1 2 6", "got");
    refused("1 2 3", "1 nan 3", "nan");
    refused("1 2 3", "1 1e39 3", "inf");
    expect_refusal(
        [] { return ply("ply\nformat ascii 1.0\nelement face 4294967295\nend_header\n"); },
        "vertex_indices");
    expect_refusal([] { return ply(""); }, "'ply'");
    expect_refusal([] { return ply("ply\n"); }, "end_header");
    expect_refusal([] { return ply("ply\nformat ascii 1.0\nend_header\n"); }, "vertices, got none");
}

/// What scanners write before anyone makes faces of it.
TEST(PlyReader, RangeGridsAreNamed) {
    expect_refusal(
        [] {
            return ply("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                       "property float y\nproperty float z\nelement range_grid 2\n"
                       "property list uchar int vertex_indices\nend_header\n"
                       "0 0 0\n1 0 0\n0 1 0\n1 0\n0\n");
        },
        "got 3 vertices and 0 faces; its range_grid is not read, MeshLab makes faces of it");
}

/// Strips as trimesh2 and Stanford's tools write them: one list, -1 between strips.
TEST(PlyReader, StripsOfTriangles) {
    const std::string header = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\n"
                               "property float y\nproperty float z\n";
    const std::string strips =
        "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    // Around the box, then both ends.
    const std::string around = "0 1 3 2 7 6 4 5 0 1", left = "0 3 4 7", right = "1 5 2 6";
    const std::string all = around + " -1 " + left + " -1 " + right;
    const TriangleMesh mesh = ply(header + strips + box_vertex_lines() + "20 " + all + "\n");
    EXPECT_EQ(mesh.positions, BoxPositions);
    ASSERT_EQ(mesh.num_triangles(), 12u);
    EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 3}));
    EXPECT_EQ(mesh.triangles[1], (Triangle{3, 1, 2}));
    EXPECT_EQ(mesh.triangles[8], (Triangle{0, 3, 4}));
    EXPECT_NEAR(area(mesh), BoxArea, 1e-6);
    EXPECT_NEAR(std::abs(volume(mesh)), 6.0, 1e-6) << "all face the same side";

    // Faces beside strips, and a list for each strip, binary.
    const TriangleMesh both =
        ply(header + "element face 1\nproperty list uchar int vertex_indices\n" + strips +
            box_vertex_lines() + "4 0 3 2 1\n20 " + all + "\n");
    EXPECT_EQ(both.num_triangles(), 14u);
    std::string binary =
        replace_all(header, "ascii", "binary_little_endian") +
        "element tristrips 2\nproperty list uchar short vertex_indices\nend_header\n";
    for (const glm::vec3& p : BoxPositions)
        binary.append(reinterpret_cast<const char*>(&p), sizeof p);
    for (const std::vector<std::int16_t>& strip :
         {std::vector<std::int16_t>{0, 3, 4, 7}, {1, 5, 2, -1, 5, 6, 2}}) {
        binary += static_cast<char>(strip.size());
        binary.append(reinterpret_cast<const char*>(strip.data()), 2 * strip.size());
    }
    EXPECT_EQ(ply(binary).triangles,
              (std::vector<Triangle>{{0, 3, 4}, {4, 3, 7}, {1, 5, 2}, {5, 6, 2}}));

    const auto refused = [&](const std::string& list, const std::string& part) {
        expect_refusal([&] { return ply(header + strips + box_vertex_lines() + list + "\n"); },
                       part);
    };
    refused("4 0 1 2 8", "vertex indices of -1 to 7, got 8");
    refused("4 0 1 2 -2", "vertex indices of -1 to 7, got -2");
    refused("5 0 1 -1 2 3", "faces with three or more corners");
    refused("4 0 1 2", "a number");
    expect_refusal(
        [&] {
            return ply(replace_all(header + strips, "int int", "int float") + box_vertex_lines() +
                       "4 0 1 2 3\n");
        },
        "tristrips with a list of whole numbers 'vertex_indices', got none");
}

} // namespace
} // namespace relumine::mesh
