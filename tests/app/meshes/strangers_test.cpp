// Inputs that were read wrongly or in silence once, one by one: the folder bugs4 of the data
// (docs/data.md). Each row is a file, what is said of it, and what holds. A file without a row is a
// failure.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "cubemap/layers/image_pyramid.h"
#include "mesh/load.h"
#include "mesh/save.h"
#include "relumine/in/mesh.h"
#include "relumine/out/pictures.h"
#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"
#include "tests/real_data.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* Inputs = "bugs4";

enum class Kind { Mesh, Environment, Refused, Beside };

class Strangers;

struct Input {
    const char* file;
    Kind kind = Kind::Mesh;
    /// Parts of the lines that the first picture and `info` say of the file, one each and no other.
    /// Of a refusal: parts of its one line.
    std::vector<const char*> said = {};
    /// What holds, and how it is asked. None for what stands beside other files.
    const char* what = "";
    void (*holds)(const Strangers&) = nullptr;
};

void PrintTo(const Input& input, std::ostream* out) {
    *out << input.file << ": " << input.what;
}

class Strangers : public AppTest, public testing::WithParamInterface<Input> {
protected:
    Strangers() {
        write("white.hdr", white_hdr());
        write("octahedron.obj", octahedron_obj());
    }

public:
    using AppTest::folder;
    using AppTest::read;

    [[nodiscard]] static std::string path(const std::string& name) {
        return real_data(fs::path(Inputs) / name).string();
    }
    [[nodiscard]] std::string own() const { return path(GetParam().file); }

    /// `relumine COMMAND FIRST...` with more options.
    Result run(std::vector<std::string> arguments, const Words& more) const {
        arguments.insert(arguments.end(), more.begin(), more.end());
        return succeed(arguments);
    }
    /// Precomputes a file in a moment, as scene.prt.
    Result precompute(const std::string& file, const Words& more = "") const {
        return run({"precompute", file, "-o", "scene.prt", "--refine", "off", "--bounces", "0",
                    "--face-resolution", "16", "--tolerance", "0.1"},
                   more);
    }
    /// The picture of scene.prt, linear.
    [[nodiscard]] cubemap::Picture picture(const Words& more) const {
        run({"relight", "scene.prt", "white.hdr", "-o", "picture.exr", "--exposure", "0"}, more);
        return cubemap::load_picture(folder() / "picture.exr");
    }
    [[nodiscard]] std::vector<std::array<float, 3>> numbers(const Words& lit) const {
        run({"relight", "scene.prt"}, lit);
        return npy_values(read("lit.npy"));
    }
    /// What the octahedron's sides send to the eye in the light of an environment.
    [[nodiscard]] std::vector<std::array<float, 3>> octahedron(const std::string& environment,
                                                               const Words& more = "") const {
        precompute("octahedron.obj");
        run({"relight", "scene.prt", environment, "-o", "lit.npy"}, more);
        return npy_values(read("lit.npy"));
    }
    [[nodiscard]] mesh::LoadedMesh mesh() const { return mesh::load(own()); }

    void expect_color(const glm::vec3& found, const glm::vec3& expected, float error) const {
        EXPECT_LT(glm::distance(found, expected), error)
            << fmt::format("({}, {}, {})", found.r, found.g, found.b);
    }
    void expect_octahedron(const glm::vec3& expected, float error) const {
        for (const auto& [r, g, b] : octahedron(own()))
            expect_color({r, g, b}, expected, error);
    }
    void expect_colors(const glm::vec3& expected) const {
        for (const glm::vec3& color : mesh().colors)
            expect_color(color, expected, 2e-3f);
        EXPECT_FALSE(mesh().colors.empty());
    }
    /// All corners have their face's normal.
    void expect_flat() const {
        const mesh::LoadedMesh mesh = this->mesh();
        for (const mesh::Triangle& triangle : mesh.triangles) {
            const glm::vec3 normal = glm::normalize(
                glm::cross(mesh.positions[triangle[1]] - mesh.positions[triangle[0]],
                           mesh.positions[triangle[2]] - mesh.positions[triangle[0]]));
            for (const std::uint32_t corner : triangle)
                EXPECT_LT(glm::distance(mesh.normals[corner], normal), 1e-3f);
        }
    }
};

/// The lines about a file, without its name; sorted, with all repetitions.
std::multiset<std::string> lines_about(const std::string& file, const Result& result) {
    std::multiset<std::string> found;
    for (const std::string& text : {result.out, result.err}) {
        std::size_t begin = 0;
        for (std::size_t end = text.find('\n'); end != std::string::npos;
             begin = end + 1, end = text.find('\n', begin)) {
            const std::string line = text.substr(begin, end - begin);
            for (const std::string& start : {file + ": ", "warning: " + file + ": "})
                if (line.starts_with(start))
                    found.insert(line.substr(start.size()));
        }
    }
    return found;
}

/// The same of `relumine info`.
std::multiset<std::string> lines_of_info(const Result& info) {
    std::multiset<std::string> found;
    std::size_t begin = 0;
    for (std::size_t end = info.out.find('\n'); end != std::string::npos;
         begin = end + 1, end = info.out.find('\n', begin)) {
        const std::string line = info.out.substr(begin, end - begin);
        for (const char* const start : {"read ", "left out ", "suspect "})
            if (line.starts_with(start))
                found.insert(line.substr(20));
        if (line.starts_with("not found "))
            found.insert("no " + line.substr(20) + " is found");
    }
    return found;
}

void expect_said(const std::multiset<std::string>& lines, const std::vector<const char*>& parts) {
    std::vector<testing::Matcher<std::string>> expected;
    expected.reserve(parts.size());
    for (const char* const part : parts)
        expected.emplace_back(HasSubstr(part));
    EXPECT_THAT(lines, testing::UnorderedElementsAreArray(expected));
}

// What holds. The units are radiance; a white sky has 1.

void bulb_and_panel_light_alike(const Strangers& test) {
    test.precompute(test.own(), "--max-edge 0.5");
    test.run({"relight", "scene.prt", "-o", "lit.ply"}, "--exposure 0");
    const mesh::TriangleMesh lit = mesh::load(test.folder() / "lit.ply");
    const auto below = [&](float x) {
        for (std::size_t i = 0; i < lit.num_vertices(); ++i)
            if (glm::distance(lit.positions[i], glm::vec3(x, 0.0f, 0.0f)) < 1e-3f)
                return lit.colors[i].r;
        return 0.0f;
    };
    EXPECT_GT(below(2.0f), 0.2f);
    EXPECT_NEAR(below(2.0f) / below(-2.0f), 0.327 / 0.320, 0.05); // Cycles
}

void ball_of_obj_is_that_of_glb(const Strangers& test) {
    float middle[2];
    for (const int i : {0, 1}) {
        test.precompute(test.path(i == 0 ? "blender-obj-too-bright/ball.obj"
                                         : "blender-obj-too-bright/ball.glb"));
        const cubemap::Picture seen = test.picture("--size 9x9 --camera 0,0");
        middle[i] = seen.pixels[40].r;
    }
    EXPECT_NEAR(middle[0], middle[1], 0.02f);
    EXPECT_NEAR(middle[1], 0.81f, 0.03f);
}

void room_is_black_inside(const Strangers& test) {
    test.precompute(test.own());
    for (const auto& value : test.numbers("white.hdr -o lit.npy"))
        EXPECT_EQ(value, (std::array<float, 3>{}));
    const cubemap::Picture seen = test.picture("--size 24x18");
    for (const glm::vec3& pixel : seen.pixels)
        EXPECT_EQ(pixel, glm::vec3(0.0f));
    // Not brightened by what suits the picture, either.
    const std::string said =
        test.run({"relight", "scene.prt", "white.hdr", "-o", "x.png"}, "--size 24x18").out;
    EXPECT_THAT(said, HasSubstr("exposure 0.0"));
}

void ball_under_a_dome_is_lit_by_it(const Strangers& test) {
    const mesh::LoadedMesh mesh = test.mesh();
    EXPECT_TRUE(std::any_of(mesh.materials.begin(), mesh.materials.end(), [](const auto& each) {
        return each.model == mesh::MaterialModel::Unlit;
    }));
}

void colors_are_within_one(const Strangers& test) {
    const mesh::LoadedMesh mesh = test.mesh();
    float most = 0.0f;
    for (const glm::vec3& color : mesh.colors)
        most = std::max({most, color.r, color.g, color.b});
    EXPECT_GT(most, 0.4f);
    EXPECT_LE(most, 1.0f);
}

/// A sheet under the ball is as dark as a slab.
void contact_is_that_of_a_slab(const Strangers& test) {
    const auto from_near = [&](const char* name) {
        test.precompute(test.path(name), "--receivers pixels:48x36:1 --view 1.6,0.35,1.6,0,0.15,0");
        return test.picture("--background none --bounces 0").pixels;
    };
    const std::vector<glm::vec3> slab = from_near("contact-leak-plane/m30_ball_on_slab.glb"),
                                 sheet = from_near("contact-leak-plane/m30_ball_on_plane.glb");
    for (std::size_t i = 0; i < slab.size(); ++i)
        EXPECT_LT(glm::distance(slab[i], sheet[i]), 0.06f) << i % 48 << ' ' << i / 48;
}

void sunk_ball_has_a_dark_rim(const Strangers& test) {
    test.precompute(test.own(), "--receivers pixels:48x36:1 --view 1.6,0.35,1.6,0,0.15,0");
    const cubemap::Picture seen = test.picture("--background none --bounces 0");
    for (std::size_t i = 0; i + 48 < seen.pixels.size(); ++i)
        EXPECT_LT(seen.pixels[i].r, 1.0f) << i % 48 << ' ' << i / 48;
}

/// Red and blue boxes with fronts in one plane: rows of the picture change colour a few times.
void one_of_two_faces_in_a_plane_wins(const Strangers& test) {
    test.precompute(test.own(), "--max-edge 0.2");
    const cubemap::Picture seen = test.picture("--size 96x72 --camera 30,40");
    std::size_t num_red = 0, num_blue = 0;
    for (std::uint32_t y = 0; y < seen.height; ++y) {
        int before = 0;
        std::size_t changes = 0;
        for (std::uint32_t x = 0; x < seen.width; ++x) {
            const glm::vec3& pixel = seen.pixels[y * seen.width + x];
            const int now = pixel.r > 2.0f * pixel.b ? 1 : pixel.b > 2.0f * pixel.r ? 2 : 0;
            changes += now != before ? 1 : 0;
            before = now;
            num_red += now == 1 ? 1 : 0;
            num_blue += now == 2 ? 1 : 0;
        }
        EXPECT_LE(changes, 6u) << y;
    }
    EXPECT_GT(num_red, 300u);
    EXPECT_GT(num_blue, 100u);
}

void no_dark_line_along_the_floor(const Strangers& test) {
    test.precompute(test.own(), "--floor 9");
    const cubemap::Picture seen =
        test.picture("--size 96x72 --camera 35,25 --floor studio --albedo 1");
    for (std::size_t i = 0; i < seen.pixels.size(); ++i)
        EXPECT_GT(seen.pixels[i].r, 0.1f) << i % 96 << ' ' << i / 96;
}

void is_red_of_acescg(const Strangers& test) {
    test.expect_octahedron({1.0f, 0.2f, 0.05f}, 0.01f);
}

/// The pictures of exr-layers and exr-overscan are one and the same.
void is_the_plain_picture(const Strangers& test) {
    const auto plain = test.octahedron(test.path("exr-layers/e04_lower.exr"));
    const auto own = test.octahedron(test.own());
    ASSERT_EQ(own.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(own[i][k], plain[i][k], 1e-5) << i;
    EXPECT_GT(plain[0][0], 0.1f);
}

void eye_sees_35_degrees(const Strangers& test) {
    test.precompute(test.own());
    const auto seen = test.picture("--size 24x18 --eye 0,4,3 --target 0,0.5,0");
    EXPECT_EQ(seen, test.picture("--size 24x18 --eye 0,4,3 --target 0,0.5,0 --fov 35"));
    EXPECT_NE(seen, test.picture("--size 24x18 --eye 0,4,3 --target 0,0.5,0 --fov 60"));
}

void faces_have_their_colors(const Strangers& test) {
    const mesh::LoadedMesh mesh = test.mesh();
    ASSERT_EQ(mesh.num_triangles(), 2u);
    ASSERT_EQ(mesh.colors.size(), 6u);
    const glm::vec3 first = mesh.colors[mesh.triangles[0][0]],
                    second = mesh.colors[mesh.triangles[1][0]];
    EXPECT_GT(glm::distance(first, second), 0.5f);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(mesh.colors[mesh.triangles[0][k]], first);
        EXPECT_EQ(mesh.colors[mesh.triangles[1][k]], second);
    }
}

void wedges_have_their_uvs(const Strangers& test) {
    const mesh::LoadedMesh mesh = test.mesh();
    EXPECT_EQ(mesh.corner_uvs.size() + (mesh.uvs.empty() ? 0 : 2), 2u);
}

/// Mean irradiance times the solid angle of the sky: that of the sun, cut at 65,504 at the most.
void sun_is_kept(const Strangers& test) {
    const auto lit = test.octahedron(test.own(), "--fix-env");
    float brightest = 0.0f;
    for (const auto& value : lit)
        brightest = std::max(brightest, value[0]);
    const auto whole = test.octahedron(test.path("fix-env-kills-sun/sun_float.exr"));
    float expected = 0.0f;
    for (const auto& value : whole)
        expected = std::max(expected, value[0]);
    EXPECT_GT(brightest, 0.25f * expected);
}

void viewers_get_colors_up_to_one(const Strangers& test) {
    test.precompute(test.own());
    test.run({"relight", "scene.prt", test.path("glb-colours-above-one/sky.hdr")},
             "-o lit.glb --exposure 3");
    const std::string glb = test.read("lit.glb");
    const nlohmann::json json = glb_json(glb);
    std::uint32_t size = 0;
    std::memcpy(&size, glb.data() + 12, sizeof size);
    const nlohmann::json& attributes = json["meshes"][0]["primitives"][0]["attributes"];
    ASSERT_TRUE(attributes.contains("COLOR_0"));
    const nlohmann::json& accessor = json["accessors"][attributes["COLOR_0"].get<std::size_t>()];
    ASSERT_EQ(accessor["componentType"], 5126);
    const nlohmann::json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t begin = 20 + size + 8 + view.value("byteOffset", std::size_t{0}) +
                              accessor.value("byteOffset", std::size_t{0});
    const std::size_t count =
        accessor["count"].get<std::size_t>() * (accessor["type"] == "VEC4" ? 4 : 3);
    std::vector<float> values(count);
    ASSERT_LE(begin + 4 * count, glb.size());
    std::memcpy(values.data(), glb.data() + begin, 4 * count);
    EXPECT_LE(*std::max_element(values.begin(), values.end()), 1.0f);
    EXPECT_GE(*std::min_element(values.begin(), values.end()), 0.0f);
    const mesh::TriangleMesh again = mesh::load(test.folder() / "lit.glb");
    float most = 0.0f;
    for (const glm::vec3& color : again.colors)
        most = std::max(most, color.r);
    EXPECT_GT(most, 1.5f) << "radiance has no upper end";
}

std::vector<glm::vec3> seen_by_its_camera(const Strangers& test, const std::string& name) {
    test.precompute(test.path("gltf-camera-roll-ortho/" + name));
    return test.picture("--size 32x32 --background none").pixels;
}

/// The picture of a camera that is turned by a quarter is that of the other one, turned.
void expect_turned(const std::vector<glm::vec3>& picture, const std::vector<glm::vec3>& other) {
    std::size_t num_left = 0, num_right = 0;
    for (std::size_t y = 0; y < 32; ++y)
        for (std::size_t x = 0; x < 32; ++x) {
            const glm::vec3& pixel = picture[32 * y + x];
            num_left += glm::distance(pixel, other[32 * (31 - x) + y]) < 0.1f ? 1 : 0;
            num_right += glm::distance(pixel, other[32 * x + 31 - y]) < 0.1f ? 1 : 0;
        }
    EXPECT_GT(std::max(num_left, num_right), 1000u);
    EXPECT_LT(std::min(num_left, num_right), 1000u) << "the scene has no symmetry";
}

void camera_is_level(const Strangers& test) {
    EXPECT_EQ(test.mesh().camera.value().roll_degrees, 0.0f);
}

void camera_is_rolled(const Strangers& test) {
    EXPECT_GT(std::abs(test.mesh().camera.value().roll_degrees), 20.0f);
    EXPECT_NE(seen_by_its_camera(test, "m23_cam_roll.glb"),
              seen_by_its_camera(test, "m23_cam_front.glb"));
}

void camera_above_is_turned(const Strangers& test) {
    EXPECT_NEAR(std::abs(test.mesh().camera.value().roll_degrees), 90.0f, 1e-2f);
    expect_turned(seen_by_its_camera(test, "m23_cam_top90.glb"),
                  seen_by_its_camera(test, "m23_cam_top.glb"));
}

void lightmap_takes_the_unwrap(const Strangers& test) {
    EXPECT_THAT(test.precompute(test.own(), "--receivers texels:32x32").out,
                HasSubstr("the lightmap takes the second set of uvs, which is an unwrap; --uv-set "
                          "0 takes the first"));
}

void is_flat(const Strangers& test) {
    test.expect_flat();
}

void has_vertices_once(const Strangers& test) {
    EXPECT_EQ(test.mesh().num_vertices(), 1681u);
    EXPECT_EQ(test.mesh().num_triangles(), 3120u);
}

void hot_pixel_is_named_and_mended(const Strangers& test) {
    for (const auto& [r, g, b] : test.octahedron(test.own(), "--fix-env"))
        test.expect_color({r, g, b}, glm::vec3(0.5f), 1e-3f);
}

void collider_moves_nothing(const Strangers& test) {
    const auto seen = [&](const char* name) {
        test.precompute(test.path(name), "--floor 5");
        return test.picture("--size 24x18").pixels;
    };
    const auto with = seen("invisible-collider/m12_collider.glb"),
               without = seen("invisible-collider/m12_collider_ref.glb");
    for (std::size_t i = 0; i < with.size(); ++i)
        EXPECT_LT(glm::distance(with[i], without[i]), 0.06f) << i % 24 << ' ' << i / 24;
}

void lightmap_is_black_inside(const Strangers& test) {
    test.precompute(test.own(), "--receivers texels:64x64");
    for (const auto& value : test.numbers("white.hdr -o lit.npy"))
        EXPECT_EQ(value, (std::array<float, 3>{}));
}

void is_opaque(const Strangers& test) {
    for (const mesh::Material& material : test.mesh().materials)
        EXPECT_EQ(material.alpha, 1.0f) << material.name;
}

void pane_is_seen_through(const Strangers& test) {
    const mesh::LoadedMesh mesh = test.mesh();
    const auto pane = std::find_if(mesh.materials.begin(), mesh.materials.end(),
                                   [](const mesh::Material& each) { return each.name == "d"; });
    ASSERT_NE(pane, mesh.materials.end());
    EXPECT_EQ(pane->alpha, 0.25f);
    EXPECT_EQ(pane->alpha_mode, mesh::AlphaMode::Blend);
}

void is_128_of_srgb(const Strangers& test) {
    test.expect_colors(glm::vec3(0.21586f));
}
void is_188_of_srgb(const Strangers& test) {
    test.expect_colors(glm::vec3(0.50289f));
}
void is_linear(const Strangers& test) {
    test.expect_colors({0.7354f, 0.5371f, 0.3889f});
}

/// A ball of a radius of a metre is as round as at the origin, and options count as in the file.
void ball_is_round_and_places_are_those_of_the_file(const Strangers& test) {
    const mesh::LoadedMesh mesh = test.mesh();
    EXPECT_EQ(mesh.offset, glm::dvec3(691234, 202, 5334568));
    mesh::Bounds box = mesh::bounds(mesh);
    EXPECT_LT(box.diagonal(), 9.0f);
    test.precompute(test.own());
    const glm::dvec3 target = mesh.offset + glm::dvec3(box.center());
    const auto text = [](const glm::dvec3& place) {
        return fmt::format("{:.3f},{:.3f},{:.3f}", place.x, place.y, place.z);
    };
    const glm::dvec3 eye = target + glm::dvec3(0.2, 6.0, 9.0);
    const auto seen = test.picture(
        {"--size", "24x18", "--background", "none", "--eye", text(eye), "--target", text(target)});
    // The same mesh, moved to the origin by who made it.
    mesh::TriangleMesh moved = mesh;
    moved.offset = glm::dvec3(0.0);
    mesh::save(test.folder() / "moved.ply", moved);
    test.precompute("moved.ply");
    const auto at_origin =
        test.picture({"--size", "24x18", "--background", "none", "--eye", text(eye - mesh.offset),
                      "--target", text(target - mesh.offset)});
    for (std::size_t i = 0; i < seen.pixels.size(); ++i)
        EXPECT_LT(glm::distance(seen.pixels[i], at_origin.pixels[i]), 0.05f)
            << i % 24 << ' ' << i / 24;
    EXPECT_TRUE(std::any_of(seen.pixels.begin(), seen.pixels.end(),
                            [](const glm::vec3& pixel) { return pixel.r > 0.1f; }));
}

constexpr const char* SrgbPly = "colours are taken as sRGB, as other programs write whole numbers "
                                "into .ply; --vertex-colors linear takes them otherwise";
constexpr const char* SrgbObj = "colours are taken as sRGB, as other programs write them into "
                                ".obj; --vertex-colors linear takes them otherwise";
constexpr const char* SrgbOff = "colours are taken as sRGB, as other programs write them into "
                                ".off; --vertex-colors linear takes them otherwise";
constexpr const char* Split2 = "2 vertices are added behind the 4 of the file";
constexpr const char* Split16 = "16 vertices are added behind the 8 of the file";
constexpr const char* Of255 = "colours are taken as numbers of 0 to 255";

const std::vector<Input> Rows = {
    {"blender-glb-lamps-683/two_lamps.glb",
     Kind::Mesh,
     {"lights are divided by 683, with which Blender's exporter multiplies them and not emission"},
     "a bulb and a panel light the floor as in Cycles",
     bulb_and_panel_light_alike},
    {"blender-obj-too-bright/ball.obj",
     Kind::Mesh,
     {"Ks and Ns are read as Specular and roughness, as Blender writes them"},
     "as bright as the .glb of the same ball",
     ball_of_obj_is_that_of_glb},
    {"blender-obj-too-bright/ball.glb", Kind::Mesh, {}, "0.81 under a white sky"},
    {"blender-obj-too-bright/ball.mtl", Kind::Beside},
    {"closed-room-warning-and-exposure/m28_room_closed.glb",
     Kind::Mesh,
     {},
     "wound rightly, and exactly black",
     room_is_black_inside},
    {"closed-room-warning-and-exposure/m13_dome_unlit.glb",
     Kind::Mesh,
     {},
     "a dome around a ball is wound rightly",
     ball_under_a_dome_is_lit_by_it},
    {"closed-room-warning-and-exposure/sky.hdr", Kind::Beside},
    {"colours-0-255/colors_255_fractions.obj",
     Kind::Mesh,
     {Of255, SrgbObj},
     "colours within 1",
     colors_are_within_one},
    {"colours-0-255/colors_int255.ply",
     Kind::Mesh,
     {Of255, SrgbPly},
     "colours within 1",
     colors_are_within_one},
    {"contact-leak-plane/m30_ball_on_plane.glb",
     Kind::Mesh,
     {},
     "the contact is as dark as that with a slab",
     contact_is_that_of_a_slab},
    {"contact-leak-plane/m30_ball_on_slab.glb", Kind::Mesh, {}, "a slab"},
    {"contact-leak-plane/m30_ball_sunk_plane.glb",
     Kind::Mesh,
     {},
     "nothing is brighter than the sky",
     sunk_ball_has_a_dark_rim},
    {"contact-leak-plane/white.hdr", Kind::Beside},
    {"coplanar-speckle/m31_coplanar.glb",
     Kind::Mesh,
     {},
     "no speckles",
     one_of_two_faces_in_a_plane_wins},
    {"dotted-line-under-boxes/m01_ref.obj",
     Kind::Mesh,
     {},
     "no dark line on the floor",
     no_dark_line_along_the_floor},
    {"exr-chromaticities/e01_acescg.exr",
     Kind::Environment,
     {},
     "(1, 0.2, 0.05) of Rec. 709",
     is_red_of_acescg},
    {"exr-chromaticities/e07_primaries.hdr",
     Kind::Environment,
     {},
     "the same, by PRIMARIES",
     is_red_of_acescg},
    {"exr-layers/e04_layers.exr",
     Kind::Environment,
     {},
     "ViewLayer.Combined is the picture",
     is_the_plain_picture},
    {"exr-layers/e04_lower.exr",
     Kind::Environment,
     {},
     "r, g, b are R, G, B",
     is_the_plain_picture},
    {"exr-overscan/e03_overscan.exr",
     Kind::Environment,
     {},
     "cut to the display window",
     is_the_plain_picture},
    {"exr-overscan/e03_partly.exr",
     Kind::Environment,
     {},
     "cut to the display window",
     is_the_plain_picture},
    {"exr-xyz-channels/e02_xyz.exr",
     Kind::Environment,
     {},
     "(1, 0.2, 0.05) of Rec. 709",
     is_red_of_acescg},
    {"eye-fov-60-not-35/op.obj", Kind::Mesh, {}, "an eye sees 35 degrees", eye_sees_35_degrees},
    {"eye-fov-60-not-35/op.mtl", Kind::Beside},
    {"face-colours-dropped/facecol.ply",
     Kind::Mesh,
     {SrgbPly, Split2},
     "two colours",
     faces_have_their_colors},
    {"face-colours-dropped/mixed.off",
     Kind::Mesh,
     {SrgbOff, Split2},
     "two colours",
     faces_have_their_colors},
    {"face-colours-dropped/ml_f.off",
     Kind::Mesh,
     {SrgbOff, Split2},
     "two colours",
     faces_have_their_colors},
    {"face-colours-dropped/wedge.ply",
     Kind::Mesh,
     {"the image 'tex.png', which a comment names, is left out: textures of .ply are not read"},
     "uvs of wedges",
     wedges_have_their_uvs},
    {"fix-env-kills-sun/sun_float.exr", Kind::Environment, {}, "its sun is whole", sun_is_kept},
    {"fix-env-kills-sun/sun_half.exr",
     Kind::Refused,
     {"36 NaN/Inf and 0 negative pixels, first at (20, 8); use --fix-env"},
     "--fix-env keeps a third of the sun's light",
     sun_is_kept},
    {"fix-env-kills-sun/sun_cube_half.exr",
     Kind::Refused,
     {"347 NaN/Inf and 0 negative pixels, first at (20, 0); use --fix-env"},
     "--fix-env keeps a third of the sun's light",
     sun_is_kept},
    {"glb-colours-above-one/a.glb",
     Kind::Mesh,
     {},
     "lit .glb: COLOR_0 within 0 to 1",
     viewers_get_colors_up_to_one},
    {"glb-colours-above-one/sky.hdr", Kind::Beside},
    {"gltf-camera-roll-ortho/m23_cam_front.glb", Kind::Mesh, {}, "level", camera_is_level},
    {"gltf-camera-roll-ortho/m23_cam_roll.glb",
     Kind::Mesh,
     {},
     "turned about its view",
     camera_is_rolled},
    {"gltf-camera-roll-ortho/m23_cam_top.glb", Kind::Mesh, {}, "level", camera_is_level},
    {"gltf-camera-roll-ortho/m23_cam_top90.glb",
     Kind::Mesh,
     {},
     "the other picture, turned",
     camera_above_is_turned},
    {"gltf-lightmap-uv/m07_uv2.glb",
     Kind::Mesh,
     {},
     "lightmaps take TEXCOORD_1",
     lightmap_takes_the_unwrap},
    {"gltf-no-normals/m02_gltf_nonormals.glb",
     Kind::Mesh,
     {"12 faces without normals are flat; --crease 180 rounds them", Split16},
     "flat",
     is_flat},
    {"gltf-no-normals/m02_lowpoly_nonormals.glb",
     Kind::Mesh,
     {"100 faces without normals are flat", "168 vertices are added behind the 52 of the file"},
     "flat",
     is_flat},
    {"gltf-no-normals/m02_ref.glb", Kind::Mesh, {}, "flat", is_flat},
    {"gltf-shared-accessor/m32_shared_1.glb", Kind::Mesh, {}, "1,681 vertices", has_vertices_once},
    {"gltf-shared-accessor/m32_shared_200.glb",
     Kind::Mesh,
     {},
     "1,681 vertices",
     has_vertices_once},
    {"hot-pixel/e10_hot.hdr",
     Kind::Refused,
     {"1 NaN/Inf and 0 negative pixels, first at (40, 20); use --fix-env"},
     "--fix-env gives the even sky",
     hot_pixel_is_named_and_mended},
    {"invisible-collider/m12_collider.glb",
     Kind::Mesh,
     {"12 triangles have an alpha of 0 and are not seen: camera and floor are placed without "
      "them"},
     "the picture without the collider",
     collider_moves_nothing},
    {"invisible-collider/m12_collider_ref.glb", Kind::Mesh, {}, "no collider"},
    {"lightmap-closed-box-leak/m21_room_quads.glb",
     Kind::Mesh,
     {"all 12 triangles look inwards, as those of a room do"},
     "exactly black",
     lightmap_is_black_inside},
    {"lightmap-closed-box-leak/white.hdr", Kind::Beside},
    {"meshlab-obj-invisible/ml_w.obj",
     Kind::Mesh,
     {"Tr 1 is opaque, as MeshLab writes it",
      "Ks is left out: MeshLab writes it whatever it shows"},
     "opaque",
     is_opaque},
    {"meshlab-obj-invisible/dtr.obj", Kind::Mesh, {}, "d 1 and then Tr 1: opaque", is_opaque},
    {"meshlab-obj-invisible/dtr.exr",
     Kind::Refused,
     {"expected --layout angular, mirrorball or octahedral for a square picture"},
     "a picture"},
    {"meshlab-obj-invisible/dtr.mtl", Kind::Beside},
    {"meshlab-obj-invisible/ml_w.obj.mtl", Kind::Beside},
    {"meshlab-obj-invisible/tex.png", Kind::Beside},
    {"mtl-tr-1/tr1.obj",
     Kind::Mesh,
     {"Tr 1 is taken as opaque: as transparency it would be invisible"},
     "opaque",
     is_opaque},
    {"mtl-tr-1/tr1.mtl", Kind::Beside},
    {"obj-hard-edges/m01_obj_hard.obj", Kind::Mesh, {Split16}, "flat", is_flat},
    {"obj-hard-edges/m01_ref.obj", Kind::Mesh, {}, "flat", is_flat},
    {"obj-hard-edges/sky.hdr", Kind::Beside},
    {"ply-srgb-bytes/grey128.ply", Kind::Mesh, {SrgbPly}, "128 is 0.216", is_128_of_srgb},
    {"specgloss-pane-opaque/alpha.gltf",
     Kind::Mesh,
     {"4 faces without normals are flat", "the extension 'FB_ngon_encoding' is not read",
      "the material d is to be blended, with an alpha of 1 in KHR_materials_pbrSpecularGlossiness "
      "and 0.25 in baseColorFactor: it has 0.25"},
     "a pane of 0.25",
     pane_is_seen_through},
    {"specgloss-pane-opaque/alpha.obj", Kind::Mesh, {}, "a pane of 0.25", pane_is_seen_through},
    {"specgloss-pane-opaque/alpha.bin", Kind::Beside},
    {"specgloss-pane-opaque/alpha.mtl", Kind::Beside},
    {"utm-coordinates/utm.obj",
     Kind::Mesh,
     {"coordinates are far from the origin: (691234, 202, 5334568) is taken off them"},
     "round, and --eye counts as in the file",
     ball_is_round_and_places_are_those_of_the_file},
    {"vertex-colours-too-bright/grey188.obj",
     Kind::Mesh,
     {SrgbObj},
     "0.737 is 0.50",
     is_188_of_srgb},
    {"vertex-colours-too-bright/grey188.ply", Kind::Mesh, {SrgbPly}, "188 is 0.50", is_188_of_srgb},
    {"vertex-colours-too-bright/three_export.ply",
     Kind::Mesh,
     {"colours are taken as linear, since they are floats; --vertex-colors srgb takes them "
      "otherwise"},
     "floats as they are",
     is_linear},
};

TEST_P(Strangers, AreReadRightOrALineSaysWhyNot) {
    const Input& input = GetParam();
    if (path(input.file).empty())
        GTEST_SKIP() << absent_data(fs::path(Inputs) / input.file);
    const std::string file = own();
    switch (input.kind) {
    case Kind::Mesh: {
        const std::multiset<std::string> lines = lines_about(file, precompute(file));
        expect_said(lines, input.said);
        EXPECT_EQ(lines_of_info(succeed({"info", file})), lines);
        break;
    }
    case Kind::Environment: {
        precompute("octahedron.obj");
        const Result result = succeed({"relight", "scene.prt", file, "-o", "lit.npy"});
        expect_said(lines_about(file, result), input.said);
        break;
    }
    case Kind::Refused:
        precompute("octahedron.obj");
        fail({"relight", "scene.prt", file, "-o", "lit.npy"},
             {input.said.begin(), input.said.end()});
        break;
    case Kind::Beside:
        break;
    }
    if (input.holds != nullptr)
        input.holds(*this);
}

std::string name_of(const testing::TestParamInfo<Input>& row) {
    std::string name = row.param.file;
    for (char& each : name)
        if (std::isalnum(static_cast<unsigned char>(each)) == 0)
            each = '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(Bugs, Strangers, testing::ValuesIn(Rows), name_of);

TEST(StrangersFolder, EveryFileHasARow) {
    const fs::path folder = real_data(Inputs);
    if (folder.empty())
        GTEST_SKIP() << absent_data(Inputs);
    std::set<std::string> rows;
    for (const Input& input : Rows)
        EXPECT_TRUE(rows.insert(input.file).second) << input.file;
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().filename() != "README")
            files.insert(fs::relative(entry.path(), folder).generic_string());
    EXPECT_EQ(files, rows);
}

} // namespace
} // namespace relumine::app
