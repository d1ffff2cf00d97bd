#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

std::string box_ascii_stl() {
    std::string text = "solid a box with a facet\n";
    for (const auto& face : BoxFaces)
        for (std::size_t i = 1; i + 1 < face.size(); ++i) {
            text += "  facet normal 0 0 1\n    outer loop\n";
            for (const std::uint32_t vertex : {face[0], face[i], face[i + 1]})
                text += fmt::format("      vertex {} {} {:e}\n", BoxPositions[vertex].x,
                                    BoxPositions[vertex].y, BoxPositions[vertex].z);
            text += "    endloop\n  endfacet\n";
        }
    return text + "endsolid a box\n";
}

void expect_welded_box(const TriangleMesh& mesh) {
    EXPECT_EQ(defect(mesh), "");
    EXPECT_EQ(mesh.num_vertices(), 8u);
    EXPECT_EQ(mesh.num_triangles(), 12u);
    EXPECT_THAT(mesh.positions, testing::UnorderedElementsAreArray(BoxPositions));
    EXPECT_NEAR(area(mesh), BoxArea, 1e-6);
    EXPECT_NEAR(volume(mesh), 6.0, 1e-6);
    EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2})) << "vertices in the order of the file";
}

TEST(StlReader, AsciiIsWelded) {
    expect_welded_box(stl(box_ascii_stl()));
    expect_welded_box(stl(replace_all(box_ascii_stl(), "\n", "\r\n")));
    expect_welded_box(stl(box_ascii_stl().substr(0, box_ascii_stl().size() - 1)));
    expect_welded_box(
        stl("\n " + replace_all(replace_all(box_ascii_stl(), "facet", "FACET"), "solid", "Solid")));
    expect_welded_box(stl(replace_all(box_ascii_stl(), "vertex 0 0", "vertex -0.0 0")));
    expect_welded_box(stl(replace_all(box_ascii_stl(), "endsolid a box", "endsolid")));
}

TEST(StlReader, BinaryIsWeldedAlsoWhenItBeginsWithSolid) {
    expect_welded_box(stl(box_binary_stl()));
    std::string other = box_binary_stl();
    other.replace(0, 5, "Mesh ");
    expect_welded_box(stl(other));
}

TEST(StlReader, WeldsExactlyAndKeepsDegenerateFacets) {
    const auto facet = [](const std::string& third) {
        return "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex " + third +
               " endloop endfacet\n";
    };
    const TriangleMesh mesh =
        stl("solid\n" + facet("0 1 0") + facet("0 1.0000001 0") + facet("1 0 0") + "endsolid\n");
    EXPECT_EQ(mesh.num_vertices(), 4u);
    EXPECT_EQ(mesh.num_triangles(), 3u);
}

TEST(StlReader, SeveralSolids) {
    EXPECT_EQ(stl(box_ascii_stl() + box_ascii_stl()).num_triangles(), 24u);
}

TEST(StlReader, RefusesWhatItWouldMisread) {
    const std::string text = box_ascii_stl();
    const auto refused = [&text](const char* from, const char* to, const std::string& part) {
        ASSERT_NE(text.find(from), std::string::npos);
        expect_refusal([&] { return stl(replace_all(text, from, to)); }, part);
    };
    refused("vertex 1 2", "vertex 1 x", "'x'");
    refused("vertex 1 2", "vertex nan 2", "nan");
    refused("vertex 1 2", "vertx 1 2", "'vertex'");
    refused("endloop", "vertex 0 0 0\nendloop", "'endloop'");
    refused("endsolid a box", "", "the end of the file");
    std::string binary = box_binary_stl();
    binary[80] = 13;
    binary[0] = 'x';
    expect_refusal([&] { return stl(binary); },
                   "expected 734 bytes of binary STL with 13 facets, got 684");
    binary[83] = '\xFF';
    expect_refusal([&] { return stl(binary); }, "facets, got 684");
    expect_refusal([] { return stl(""); }, "0 bytes");
    expect_refusal([] { return stl(std::string(84, '\0')); }, "vertices");
    expect_refusal([] { return stl("solid\nendsolid\n"); }, "vertices");
}

} // namespace
} // namespace relumine::mesh
