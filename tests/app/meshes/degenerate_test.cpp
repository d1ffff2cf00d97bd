// Meshes at the edge of what is one, through the whole program. Files that are none (NaN, no faces)
// are in mesh_files_test.cpp.
#include <algorithm>

#include <fmt/format.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"
#include "tests/prt/scenes.h"

namespace relumine::app {
namespace {

using Radiance = std::vector<std::array<float, 3>>;

class Degenerate : public AppTest {
protected:
    Degenerate() {
        write("white.hdr", white_hdr());
        write("lamp.hdr", lamp_hdr(64)); // at +Z, a light that gets shadow rays
        write("below.hdr", hdr_file(64, 32, [](std::uint32_t, std::uint32_t y) {
                  const float radiance = y < 16 ? 0.0f : 1.0f;
                  return Rgb{radiance, radiance, radiance};
              }));
    }

    /// Each vertex's radiance, albedo 1.
    [[nodiscard]] Radiance lit(const std::string& obj, const std::string& environment,
                               const std::vector<std::string>& options = {"--face-resolution",
                                                                          "64"}) const {
        write("mesh.obj", obj);
        std::vector<std::string> arguments = {"precompute", "mesh.obj", "-o",       "mesh.prt",
                                              "--bounces",  "0",        "--refine", "off"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        succeed(arguments);
        succeed({"relight", "mesh.prt", environment, "-o", "lit.npy", "--albedo", "1"});
        return npy_values(read("lit.npy"));
    }
    /// Down to single texels, so that clusters do not depend on what else is in the mesh.
    [[nodiscard]] Radiance finely_lit(const std::string& obj,
                                      const std::string& environment) const {
        return lit(obj, environment, {"--face-resolution", "16", "--tolerance", "0"});
    }
};

std::string text(const mesh::TriangleMesh& mesh, float scale = 1.0f,
                 const glm::vec3& offset = glm::vec3(0.0f)) {
    std::string obj;
    for (const glm::vec3& position : mesh.positions) {
        const glm::vec3 p = scale * position + offset;
        obj += fmt::format("v {} {} {}\n", p.x, p.y,
                           p.z); // the shortest that reads back to the same bits
    }
    for (const auto& [a, b, c] : mesh.triangles)
        obj += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
    return obj;
}

/// A sum of rounding errors.
void expect_equal(const Radiance& got, const Radiance& expected, std::size_t num_vertices,
                  double tolerance = 1e-5) {
    ASSERT_GE(got.size(), num_vertices);
    ASSERT_GE(expected.size(), num_vertices);
    for (std::size_t i = 0; i < num_vertices; ++i)
        EXPECT_NEAR(got[i][1], expected[i][1], tolerance) << i;
}

/// What is left of a cluster whose sharp light is taken out is a difference of large numbers.
void expect_black(const Radiance& radiance, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
        for (const float channel : radiance[i])
            EXPECT_NEAR(channel, 0.0f, 1e-8f) << i;
}

TEST_F(Degenerate, OneTriangleSeesItsHemisphere) {
    const std::string up = "v 0 0 0\nv 0 0 1\nv 1 0 0\nf 1 2 3\n";
    for (const auto& radiance : lit(up, "white.hdr"))
        EXPECT_NEAR(radiance[0], 1.0f, 2e-3f); // a white furnace, but for the horizon's clusters
    for (const auto& radiance : lit(up, "below.hdr"))
        EXPECT_NEAR(radiance[0], 0.0f, 1e-12f); // cells end at the horizon but for rounding
    // The lamp stands on the horizon: texels of its pixels' size would move its middle.
    EXPECT_LT(succeed("verify mesh.prt lamp.hdr --face-resolution 512 --json")
                  .json()["relative_l2"]
                  .get<double>(),
              0.02);
    // Turned over, it is the other way round.
    const std::string down = "v 0 0 0\nv 0 0 1\nv 1 0 0\nf 1 3 2\n";
    for (const auto& radiance : lit(down, "below.hdr"))
        EXPECT_NEAR(radiance[0], 1.0f, 2e-3f);
}

TEST_F(Degenerate, VerticesInOnePointHaveNoSideThatLightCouldReach) {
    const Radiance radiance =
        lit("v 1 2 3\nv 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\nf 2 3 4\n", "white.hdr");
    ASSERT_EQ(radiance.size(), 4u);
    expect_black(radiance, 0, 4);
    succeed("verify mesh.prt white.hdr");
}

TEST_F(Degenerate, SizeMakesNoDifference) {
    // Powers of two change no digit of any coordinate, so that not one bit of the result may change
    // either.
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    for (const char* environment : {"white.hdr", "lamp.hdr"}) {
        const Radiance unit = lit(text(mesh), environment);
        for (const float scale : {0x1p23f, 0x1p-23f}) // 8e6 and 1e-7
            EXPECT_EQ(lit(text(mesh, scale), environment), unit) << environment << ' ' << scale;
    }
}

TEST_F(Degenerate, NorDoesAPlaceFarAway) {
    // Of whole numbers, which floats still have at 2^20; a bias of 1e-4 times the size, 0.04, they
    // have not.
    const mesh::TriangleMesh mesh =
        scenes::joined(scenes::floor_grid(9, 256.0f), scenes::box({-32, 16, -32}, {32, 48, 32}));
    const Radiance here = lit(text(mesh), "white.hdr");
    const Radiance there =
        lit(text(mesh, 1.0f, glm::vec3(0x1p20f, -0x1p20f, 0x1p20f)), "white.hdr");
    expect_equal(there, here, mesh.num_vertices(), 0.02);
}

TEST_F(Degenerate, SliversBlockLikeTheirWhole) {
    // A plate over a floor: of two triangles, and as a fan of 500 from one corner, ten thousand
    // times as long as wide.
    const mesh::TriangleMesh floor = scenes::floor_grid(9, 4.0f);
    mesh::TriangleMesh plate;
    plate.positions = {{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}};
    plate.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh::TriangleMesh slivers;
    slivers.positions = {plate.positions[0]};
    constexpr std::uint32_t NumSlivers = 500;
    for (std::uint32_t i = 0; i <= NumSlivers; ++i) {
        const float t = 2.0f * static_cast<float>(i) / NumSlivers; // around two edges
        slivers.positions.emplace_back(std::min(t, 1.0f) * 2.0f - 1.0f, 1.0f,
                                       1.0f - 2.0f * std::max(t - 1.0f, 0.0f));
        if (i > 0)
            slivers.triangles.push_back({0, i, i + 1});
    }
    for (const char* environment : {"white.hdr", "lamp.hdr"}) {
        const Radiance whole = finely_lit(text(scenes::joined(floor, plate)), environment);
        const Radiance cut = finely_lit(text(scenes::joined(floor, slivers)), environment);
        expect_equal(cut, whole, floor.num_vertices());
        const std::size_t middle = floor.num_vertices() / 2;
        EXPECT_LT(whole[middle][0], 0.7f) << "it does block";
    }
}

TEST_F(Degenerate, DoubledFacesBlockOnce) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    mesh::TriangleMesh doubled = mesh;
    doubled.triangles.insert(doubled.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    expect_equal(finely_lit(text(doubled), "white.hdr"), finely_lit(text(mesh), "white.hdr"),
                 mesh.num_vertices());
}

TEST_F(Degenerate, AClosedMeshInsideOutIsBlack) {
    const std::string inside_out =
        "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
        "f 3 1 5\nf 3 6 1\nf 3 2 6\nf 3 5 2\nf 4 5 1\nf 4 1 6\nf 4 6 2\nf 4 2 5\n";
    for (const char* environment : {"white.hdr", "lamp.hdr"})
        expect_black(lit(inside_out, environment), 0, 6);
}

TEST_F(Degenerate, InsideAClosedBoxThereIsNoLight) {
    mesh::TriangleMesh inner;
    inner.positions = {{0, 0, 0}, {0, 0, 0.1f}, {0.1f, 0, 0}};
    inner.triangles = {{0, 1, 2}};
    const mesh::TriangleMesh mesh = scenes::joined(scenes::box({-1, -1, -1}, {1, 1, 1}), inner);
    for (const char* environment : {"white.hdr", "lamp.hdr"}) {
        const Radiance radiance = lit(text(mesh), environment);
        expect_black(radiance, 8, 11);
        EXPECT_GT(*std::max_element(radiance.begin(), radiance.begin() + 8),
                  (std::array<float, 3>{}))
            << "outside there is";
    }
    EXPECT_LT(succeed("verify mesh.prt white.hdr --json").json()["relative_l2"].get<double>(),
              0.02);
}

TEST_F(Degenerate, UnusedVerticesTakeNoLightAndChangeNothing) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const Radiance expected = finely_lit(text(mesh), "white.hdr");
    const std::string obj = fmt::format("{}v 1e6 0 0\nv 0 0 0\n", text(mesh));
    const Radiance got = finely_lit(obj, "white.hdr");
    ASSERT_EQ(got.size(), mesh.num_vertices() + 2);
    expect_equal(got, expected, mesh.num_vertices());
    expect_black(got, mesh.num_vertices(), got.size());
}

} // namespace
} // namespace relumine::app
