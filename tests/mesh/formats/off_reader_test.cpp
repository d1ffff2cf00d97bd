#include <bit>

#include "files/pixel_values.h"
#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

std::string box_off(const std::string& keyword = "OFF", const std::string& vertex_suffix = "",
                    const std::string& face_suffix = "") {
    return keyword + "\n8 7 0\n" + box_vertex_lines("", vertex_suffix) +
           box_face_lines(face_suffix);
}

TEST(OffReader, KeepsVerticesAndCutsPolygons) {
    expect_box(off(box_off()));
    expect_box(off("OFF 8 7 0\n" + box_vertex_lines() + box_face_lines()));
    expect_box(off("OFF8 7 0\n" + box_vertex_lines() + box_face_lines()));
    expect_box(off("8 7 0\n" + box_vertex_lines() + box_face_lines()));
}

TEST(OffReader, LineEndsAndCommentsAnywhere) {
    const std::string text = box_off();
    expect_box(off(replace_all(text, "\n", "\r\n")));
    expect_box(off(text.substr(0, text.size() - 1)));
    expect_box(off("# first\n" + replace_all(text, "\n", " # 1 2 3\n\n# 4 5 6\n")));
}

TEST(OffReader, ColorsOfFaces) {
    const float half = files::linear_of_srgb(0.5f);
    expect_box(off(box_off("OFF", "", " 1.0 0.5 0 1")));
    EXPECT_EQ(off(box_off("OFF", "", " 1.0 0.5 0 1")).colors[0], glm::vec3(1.0f, half, 0.0f));
    EXPECT_EQ(off(box_off("OFF", "", " 255 0 0")).colors[0], glm::vec3(1.0f, 0.0f, 0.0f));
    EXPECT_EQ(off(box_off("OFF", "", " 255 0 0 255")).colors[0], glm::vec3(1.0f, 0.0f, 0.0f));
    EXPECT_EQ(off(box_off("OFF", "", " 1 0 0")).colors[0], glm::vec3(1.0f, 0.0f, 0.0f));
    const TriangleMesh indexed = off(box_off("OFF", "", " 3"));
    expect_box(indexed);
    EXPECT_TRUE(indexed.colors.empty());
    EXPECT_THAT(indexed.warnings, testing::ElementsAre("7 of 7 faces have an index of a colour "
                                                       "map, which is not read"));
    // Bytes and fractions beside each other, and faces without a colour.
    const TriangleMesh mixed = off("OFF\n4 3 0\n0 0 0\n1 0 0\n1 0 -1\n0 0 -1\n3 0 1 2 255 0 0\n"
                                   "3 0 2 3 0.0 1.0 0.0\n3 3 2 0\n");
    ASSERT_EQ(mixed.num_triangles(), 3u);
    const std::vector<glm::vec3> colors = {{1, 0, 0}, {0, 1, 0}, {1, 1, 1}};
    for (std::size_t i = 0; i < 3; ++i)
        for (const std::uint32_t vertex : mixed.triangles[i])
            EXPECT_EQ(mixed.colors[vertex], colors[i]);
}

TEST(OffReader, EveryLayoutOfVertices) {
    const auto near = [](const glm::vec3& a, const glm::vec3& b) {
        return glm::distance(a, b) < 1e-6f;
    };
    const glm::vec3 orange(1.0f, files::linear_of_srgb(0.2f), 0.0f);
    const TriangleMesh bytes = off(box_off("COFF", " 255 51 0 255"));
    expect_box(bytes);
    EXPECT_TRUE(near(bytes.colors[7], orange)) << "as other programs write them";
    EXPECT_EQ(off(box_off("COFF", " 255 51 0")).colors, bytes.colors);
    EXPECT_EQ(off(box_off("COFF", " 1 0.5 0.25 1")).colors[7],
              glm::vec3(1.0f, files::linear_of_srgb(0.5f), files::linear_of_srgb(0.25f)));
    EXPECT_EQ(off(box_off("COFF", " 1 1 1 1")).colors[7], glm::vec3(1.0f));
    EXPECT_TRUE(off(box_off("COFF", " nan 0 0 1")).colors.empty());

    const TriangleMesh normals = off(box_off("NOFF", " 0 0 2"));
    expect_box(normals);
    EXPECT_EQ(normals.normals[0], glm::vec3(0, 0, 1));
    EXPECT_NE(off(box_off("NOFF", " 0 0 2"), NormalSource::Smooth).normals[0], glm::vec3(0, 0, 1));

    const TriangleMesh all = off(box_off("STCNOFF", " 0 1 0 255 51 0 255 0.25 0.5"));
    expect_box(all);
    EXPECT_EQ(all.normals[0], glm::vec3(0, 1, 0));
    EXPECT_TRUE(near(all.colors[0], orange));
    EXPECT_EQ(all.uvs[0], glm::vec2(0.25f, 0.5f));
    EXPECT_TRUE(near(off(box_off("CNOFF", " 0 1 0 255 51 0")).colors[0], orange));
    EXPECT_EQ(off(box_off("STOFF", " 0.25 0.5")).uvs[0], glm::vec2(0.25f, 0.5f));
}

TEST(OffReader, SkipsFacesOfFewerThanThreeCorners) {
    const TriangleMesh mesh =
        off(replace_all(box_off(), "8 7 0\n", "8 10 0\n") + "2 0 1\n1 0\n0\n");
    expect_box(mesh);
    EXPECT_THAT(mesh.warnings, testing::ElementsAre("3 of 10 faces have fewer than three corners"));
    EXPECT_THAT(off(box_off()).warnings, testing::IsEmpty());
}

/// Words of 32 bits, high byte first.
std::string words(std::initializer_list<std::uint32_t> values) {
    std::string text;
    for (const std::uint32_t value : values)
        for (const int shift : {24, 16, 8, 0})
            text += static_cast<char>(value >> shift & 0xffu);
    return text;
}

/// The box in binary: each vertex with further words, each face with further words.
std::string binary_off(const std::string& keyword = "OFF BINARY\n",
                       const std::string& of_vertex = "", const std::string& of_face = words({0})) {
    std::string text = keyword + words({8, 7, 0});
    for (const glm::vec3& p : BoxPositions)
        text += words({std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                       std::bit_cast<std::uint32_t>(p.z)}) +
                of_vertex;
    for (const auto& face : BoxFaces) {
        text += words({static_cast<std::uint32_t>(face.size())});
        for (const std::uint32_t corner : face)
            text += words({corner});
        text += of_face;
    }
    return text;
}

TEST(OffReader, BinaryFiles) {
    expect_box(off(binary_off()));
    expect_box(off(binary_off("OFF BINARY\r\n")));
    const std::uint32_t one = std::bit_cast<std::uint32_t>(1.0f);
    const std::uint32_t half = std::bit_cast<std::uint32_t>(0.5f);
    const TriangleMesh mesh =
        off(binary_off("STCNOFF BINARY\n", words({0, one, 0, one, half, 0, one, half, 0}),
                       words({4, one, one, one, one})));
    expect_box(mesh);
    EXPECT_EQ(mesh.normals[3], glm::vec3(0, 1, 0));
    EXPECT_EQ(mesh.colors[3], glm::vec3(1.0f)) << "those of faces";
    EXPECT_EQ(mesh.uvs[3], glm::vec2(0.5f, 0.0f));
    const std::string text = binary_off();
    for (std::size_t length = 11; length < text.size(); ++length)
        expect_refusal([&] { return off(text.substr(0, length)); }, "got");
    expect_refusal([&] { return off(text + "x"); }, "nothing after 8 vertices and 7 faces, got 1");
    const auto changed = [&](std::size_t word, std::uint32_t value) {
        return text.substr(0, 11 + 4 * word) + words({value}) + text.substr(15 + 4 * word);
    };
    expect_refusal([&] { return off(changed(0, 0xffffffffu)); }, "a number of vertices below");
    expect_refusal([&] { return off(changed(1, 1000)); }, "a number of faces below");
    expect_refusal([&] { return off(changed(3 + 24, 4000)); }, "a number of corners below");
    expect_refusal([&] { return off(changed(3 + 25, 8)); }, "vertex indices below 8, got 8");
    expect_refusal([&] { return off(changed(3 + 29, 5)); }, "a number of colour values below 5");
}

TEST(OffReader, RefusesWhatItWouldMisread) {
    const std::string text = box_off();
    const auto refused = [&text](const char* from, const char* to, const std::string& part) {
        ASSERT_NE(text.find(from), std::string::npos);
        expect_refusal([&] { return off(replace_all(text, from, to)); }, part);
    };
    refused("OFF", "4OFF", "'4OFF'");
    refused("OFF", "nOFF", "'nOFF'");
    refused("OFF", "OFF BINARY", "a number of vertices below");
    refused("OFF", "PLY", "'PLY'");
    refused("8 7 0", "8 7", "edges");
    refused("8 7 0", "353535235358 7 0", "353535235358");
    refused("8 7 0", "8 4000000000 0", "4000000000");
    refused("8 7 0", "-8 7 0", "-8");
    refused("8 7 0", "8 6 0", "nothing after 8 vertices and 6 faces");
    refused("8 7 0", "8 8 0", "the end of the file");
    refused("8 7 0", "7 8 0", "line");
    refused("1 0 0", "1 x 0", "'x'");
    refused("1 0 0", "1 0", "3 numbers of a vertex in line 4, got 2");
    refused("1 0 0", "1 0 0 255 0 0", "got 6");
    refused("1 0 0", "1 inf 0", "inf");
    refused("3 1 2 6", "3 1 2 8", "vertex index of 0 to 7");
    refused("3 1 2 6", "3 1 2 -1", "'-1'");
    refused("3 1 2 6", "3 1 2", "3 corners");
    refused("3 1 2 6", "3 1 2 6 7 8 9 1 2", "4 colour values");
    refused("3 1 2 6", "-3 1 2 6", "corners");
    refused("3 1 2 6", "3 1 2 6.5", "'6.5'");
    expect_refusal([] { return off(""); }, "header");
    expect_refusal([] { return off("OFF\n0 0 0\n"); }, "vertices");
    expect_refusal([] { return off("OFF\n1 0 0\n0 0 0\n"); }, "faces");
}

} // namespace
} // namespace relumine::mesh
