#include "relight/pictures/picture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include "cubemap/image/image_file.h"
#include "files/output_file.h"
#include "tests/prt/damaged_file.h"
#include "tests/prt/scenes.h"

namespace relumine::relight {
namespace {

namespace fs = std::filesystem;

/// A square in the plane z = 0 that faces +Z, [-1, 1] x [-1, 1]; vertices left to right, bottom to
/// top.
mesh::TriangleMesh square() {
    mesh::TriangleMesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}};
    mesh.normals.assign(4, glm::vec3(0, 0, 1));
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
    return mesh;
}

/// One colour for each axis direction: a face of radiance (1, 0, 0) for +X, (0.5, 0, 0) for -X,
/// green and blue likewise.
cubemap::CubeMap axes_environment() {
    cubemap::CubeMap environment(8);
    for (const cubemap::Face face : cubemap::AllFaces) {
        glm::vec3 colour(0.0f);
        colour[static_cast<int>(face) / 2] = static_cast<int>(face) % 2 == 0 ? 1.0f : 0.5f;
        for (std::uint32_t i = 0; i < 64; ++i)
            environment.at(face, i % 8, i / 8) = colour;
    }
    return environment;
}

// From (0, 0, 4) with half-angle atan(1/2) the picture spans [-2, 2] of the plane z = 0: the square
// fills the middle half.
const Camera FrontCamera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 2.0f * 26.5650512f};

struct Drawn {
    mesh::TriangleMesh mesh = square();
    prt::RayScene rays{mesh};

    [[nodiscard]] Picture picture(const std::vector<glm::vec3>& radiance, const Camera& camera,
                                  const PictureOptions& options) const {
        return draw(mesh, rays, radiance, axes_environment(), camera, options);
    }
};

const glm::vec3& pixel(const Picture& picture, std::uint32_t x, std::uint32_t y) {
    return picture.pixels[std::size_t{y} * picture.width + x];
}

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance) {
    EXPECT_LE(glm::length(a - b), tolerance)
        << a.r << ' ' << a.g << ' ' << a.b << " is not " << b.r << ' ' << b.g << ' ' << b.b;
}

TEST(Picture, ASquareBeforeABackground) {
    const Drawn drawn;
    const Picture picture =
        drawn.picture(std::vector<glm::vec3>(4, glm::vec3(7.0f, 8.0f, 9.0f)), FrontCamera,
                      {.width = 16, .height = 16, .samples_per_axis = 2});
    ASSERT_EQ(picture.pixels.size(), 256u);
    for (std::uint32_t y = 0; y < 16; ++y)
        for (std::uint32_t x = 0; x < 16; ++x) {
            const bool inside = x >= 4 && x < 12 && y >= 4 && y < 12;
            // Looking along -Z, the background is the -Z face.
            expect_near(pixel(picture, x, y),
                        inside ? glm::vec3(7.0f, 8.0f, 9.0f) : glm::vec3(0.0f, 0.0f, 0.5f), 1e-4f);
        }
}

TEST(Picture, RightIsRightAndUpIsUp) {
    // Radiance by position: red grows to +X, green to +Y.
    const Drawn drawn;
    const Picture picture = drawn.picture({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, FrontCamera,
                                          {.width = 16, .height = 16, .samples_per_axis = 1});
    for (std::uint32_t y = 4; y < 12; ++y)
        for (std::uint32_t x = 4; x < 12; ++x) {
            const float right = (static_cast<float>(x) - 4.0f + 0.5f) / 8.0f;
            const float down = (static_cast<float>(y) - 4.0f + 0.5f) / 8.0f;
            expect_near(pixel(picture, x, y), {right, 1.0f - down, 0.0f}, 1e-5f);
        }
}

TEST(Picture, BackgroundLiesWhereTheAxesAre) {
    const Drawn drawn;
    const std::vector<glm::vec3> black(4, glm::vec3(0.0f));
    struct View {
        glm::vec3 direction;
        /// Directions seen there at 45 degrees and a little more
        glm::vec3 centre, right, left, top, bottom;
    };
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    for (const View& view :
         {View{-z, -z, x, -x, y, -y}, View{z, z, -x, x, y, -y}, View{x, x, z, -z, y, -y},
          View{-x, -x, -z, z, y, -y}, View{y, y, -x, x, -z, z}, View{-y, -y, x, -x, -z, z}}) {
        // Far off the square, a picture of 100 degrees reaches past the neighbouring faces' edges.
        const glm::vec3 eye(100.0f, 200.0f, 300.0f);
        const Picture picture = drawn.picture(
            black, {.eye = eye, .target = eye + view.direction, .fov_degrees = 100.0f},
            {.width = 41, .height = 41, .samples_per_axis = 1});
        const auto colour = [](const glm::vec3& axis) {
            const glm::vec3 positive = glm::max(axis, 0.0f), negative = glm::max(-axis, 0.0f);
            return positive + 0.5f * negative;
        };
        // Bilinear samples near a face's edge mix both faces: the neighbour's share is what counts.
        const auto has = [&](std::uint32_t px, std::uint32_t py, const glm::vec3& axis) {
            const glm::vec3 expected = colour(axis);
            const glm::vec3& seen = pixel(picture, px, py);
            for (int c = 0; c < 3; ++c)
                if (expected[c] > 0.0f) {
                    EXPECT_NEAR(seen[c], expected[c], 0.5f * expected[c]);
                }
        };
        expect_near(pixel(picture, 20, 20), colour(view.centre), 1e-5f);
        has(40, 20, view.right);
        has(0, 20, view.left);
        has(20, 0, view.top);
        has(20, 40, view.bottom);
    }
}

TEST(Picture, WidePicturesShowMoreAtTheSidesNotLess) {
    const Drawn drawn;
    const std::vector<glm::vec3> white(4, glm::vec3(5.0f));
    const Picture wide =
        drawn.picture(white, FrontCamera, {.width = 32, .height = 16, .samples_per_axis = 1});
    EXPECT_EQ(pixel(wide, 11, 8), glm::vec3(0.0f, 0.0f, 0.5f));
    EXPECT_EQ(pixel(wide, 12, 8), glm::vec3(5.0f));
    EXPECT_EQ(pixel(wide, 19, 8), glm::vec3(5.0f));
    EXPECT_EQ(pixel(wide, 20, 8), glm::vec3(0.0f, 0.0f, 0.5f));
    EXPECT_EQ(pixel(wide, 16, 3), glm::vec3(0.0f, 0.0f, 0.5f));
    EXPECT_EQ(pixel(wide, 16, 4), glm::vec3(5.0f));
}

TEST(Picture, SamplesOfAPixelAreAveraged) {
    // The square's edge halves a column of pixels: 15 pixels over 4 units, the edge at 11.25.
    const Drawn drawn;
    const Picture picture =
        drawn.picture(std::vector<glm::vec3>(4, glm::vec3(8.0f, 0.0f, 0.5f)), FrontCamera,
                      {.width = 15, .height = 15, .samples_per_axis = 4});
    expect_near(pixel(picture, 11, 7), {2.0f, 0.0f, 0.5f}, 1e-4f);
}

TEST(Picture, TheNearestSurfaceIsSeen) {
    const mesh::TriangleMesh front = square();
    mesh::TriangleMesh behind = square();
    for (glm::vec3& position : behind.positions)
        position.z -= 0.5f;
    const mesh::TriangleMesh both = scenes::joined(behind, front);
    std::vector<glm::vec3> radiance(4, glm::vec3(1.0f, 0.0f, 0.0f));
    radiance.resize(8, glm::vec3(0.0f, 1.0f, 0.0f));
    const Picture picture = draw(both, prt::RayScene(both), radiance, axes_environment(),
                                 FrontCamera, {.width = 8, .height = 8, .samples_per_axis = 1});
    expect_near(pixel(picture, 4, 4), {0.0f, 1.0f, 0.0f}, 1e-5f);
}

TEST(Picture, AnyNumberOfThreadsGivesTheSameBits) {
    const Drawn drawn;
    std::vector<glm::vec3> first;
    for (const std::size_t num_threads : {1u, 2u}) {
        const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                          num_threads);
        const Picture picture = drawn.picture({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                              FrontCamera, {.width = 33, .height = 21});
        if (!first.empty()) {
            EXPECT_EQ(picture.pixels, first);
        }
        first = picture.pixels;
    }
}

/// Where a point lies in the picture: both coordinates in [-1, 1] when it is seen, up and right
/// positive.
glm::dvec2 projected(const glm::dvec3& point, const Camera& camera, double aspect) {
    const glm::dvec3 eye(camera.eye);
    const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.target) - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
    const glm::dvec3 offset = point - eye;
    const double half_height =
        std::tan(0.5 * static_cast<double>(camera.fov_degrees) * std::numbers::pi / 180.0) *
        glm::dot(offset, forward);
    return {glm::dot(offset, right) / (half_height * aspect),
            glm::dot(offset, glm::cross(right, forward)) / half_height};
}

TEST(Picture, AutomaticCameraSeesTheWholeMeshAndFillsThePicture) {
    for (const float scale : {1e-6f, 1.0f, 1e6f})
        for (const glm::vec3& size :
             {glm::vec3(1.0f), glm::vec3(5.0f, 0.1f, 1.0f), glm::vec3(0.01f, 3.0f, 0.01f)})
            for (const float fov : {10.0f, 35.0f, 90.0f})
                for (const PictureOptions& options :
                     {PictureOptions{}, {.width = 300, .height = 900}, {.width = 4, .height = 4}}) {
                    const glm::vec3 low = scale * glm::vec3(-3, 2, 7);
                    const mesh::TriangleMesh mesh = scenes::box(low, low + scale * size);
                    const Camera camera = automatic_camera(mesh, options, fov);
                    EXPECT_EQ(camera.fov_degrees, fov);
                    const glm::vec3 forward = glm::normalize(camera.target - camera.eye);
                    EXPECT_LT(forward.z, -0.5f) << "from the front";
                    EXPECT_LT(forward.y, 0.0f) << "from above";
                    EXPECT_LT(forward.x, 0.0f) << "from the right";
                    double widest = 0.0;
                    for (const glm::vec3& position : mesh.positions) {
                        const glm::dvec2 at = projected(
                            position, camera, static_cast<double>(options.width) / options.height);
                        widest = std::max({widest, std::abs(at.x), std::abs(at.y)});
                    }
                    EXPECT_LT(widest, 1.0);
                    EXPECT_GT(widest, 0.6);
                }
}

TEST(Picture, AutomaticCameraOfAMeshFarFromTheOrigin) {
    // Map coordinates in metres: floats are half a metre apart there.
    const glm::vec3 low(500000.0f, 30.0f, 5000000.0f);
    const Camera camera = automatic_camera(scenes::box(low, low + glm::vec3(40.0f, 20.0f, 40.0f)));
    const Camera near =
        automatic_camera(scenes::box(glm::vec3(0.0f), glm::vec3(40.0f, 20.0f, 40.0f)));
    EXPECT_LT(glm::distance(glm::normalize(camera.eye - camera.target),
                            glm::normalize(near.eye - near.target)),
              0.01f);
    EXPECT_NEAR(glm::distance(camera.eye, camera.target), glm::distance(near.eye, near.target),
                1.0f);
    EXPECT_NO_THROW(
        static_cast<void>(automatic_camera(scenes::box(glm::vec3(1e9f), glm::vec3(1.0001e9f)))));
}

TEST(Picture, AutomaticCameraLooksAtWhatStandsOnTheGround) {
    const mesh::TriangleMesh sphere = scenes::icosphere(1, 1.0f, {2.0f, 1.5f, 3.0f});
    const Camera alone = automatic_camera(sphere);
    const Camera with_ground =
        automatic_camera(scenes::joined(scenes::floor_grid(5, 50.0f), sphere));
    EXPECT_EQ(with_ground.eye, alone.eye);
    EXPECT_EQ(with_ground.target, alone.target);
    // A ground alone is looked at itself.
    const Camera ground = automatic_camera(scenes::floor_grid(5, 50.0f));
    EXPECT_EQ(ground.target, glm::vec3(0.0f));
    EXPECT_GT(glm::length(ground.eye), 25.0f);
}

TEST(Picture, RefusesBadSizesAndCameras) {
    const Drawn drawn;
    const std::vector<glm::vec3> white(4, glm::vec3(1.0f));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto refused = [&](const Camera& camera, const PictureOptions& options) {
        EXPECT_THROW(static_cast<void>(drawn.picture(white, camera, options)),
                     std::invalid_argument);
    };
    refused(FrontCamera, {.width = 0});
    refused(FrontCamera, {.height = 0});
    refused(FrontCamera, {.width = 16385, .height = 1});
    refused(FrontCamera, {.width = 1, .height = 16385});
    refused(FrontCamera, {.width = 8, .height = 8, .samples_per_axis = 0});
    refused(FrontCamera, {.width = 8, .height = 8, .samples_per_axis = 1000});
    refused({.eye = {1, 2, 3}, .target = {1, 2, 3}}, {});
    refused({.eye = {nan, 0, 4}}, {});
    refused({.eye = {0, 0, std::numeric_limits<float>::infinity()}}, {});
    for (const float fov : {0.0f, -10.0f, 180.0f, 400.0f, nan})
        refused({.eye = {0, 0, 4}, .fov_degrees = fov}, {});
    EXPECT_THROW(static_cast<void>(draw(drawn.mesh, drawn.rays, std::span(white).first(3),
                                        axes_environment(), FrontCamera)),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(draw(drawn.mesh, drawn.rays, white, {}, FrontCamera)),
                 std::invalid_argument);
}

class SavePictureTest : public testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    /// [height * width * 3] bytes of a PNG file.
    static std::vector<std::uint8_t> decoded(const fs::path& path, int& width, int& height) {
        int channels = 0;
        stbi_uc* bytes = stbi_load(path.c_str(), &width, &height, &channels, 0);
        if (bytes == nullptr) {
            ADD_FAILURE() << stbi_failure_reason();
            return {};
        }
        EXPECT_EQ(channels, 3);
        std::vector<std::uint8_t> result(bytes, bytes + std::ptrdiff_t{width} * height * 3);
        stbi_image_free(bytes);
        return result;
    }
    fs::path folder_ =
        fs::path(testing::TempDir()) /
        ("picture_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(SavePictureTest, PngHoldsTheSrgbCurve) {
    // Bytes from IEC 61966-2-1: 0.0031308 is where the line ends (12.92 x = 0.04045); 0.2140 is
    // half of the scale; 0.18 is 118.
    const Picture picture{.width = 4,
                          .height = 2,
                          .pixels = {{0.0f, 1.0f, 0.5f},
                                     {0.18f, 0.21404114f, 0.0031308f},
                                     {0.001f, 2.0f, 1e30f},
                                     {-1.0f, 0.0001f, 0.9f},
                                     {1.0f, 0.0f, 0.0f},
                                     {0.0f, 1.0f, 0.0f},
                                     {0.0f, 0.0f, 1.0f},
                                     {1.0f, 1.0f, 1.0f}}};
    const fs::path path = folder_ / "picture.png";
    save_picture(path, picture);
    int width = 0, height = 0;
    const std::vector<std::uint8_t> expected = {0,   255, 188, 118, 128, 10,  3,   255,
                                                255, 0,   0,   243, 255, 0,   0,   0,
                                                255, 0,   0,   0,   255, 255, 255, 255};
    EXPECT_EQ(decoded(path, width, height), expected);
    EXPECT_EQ(width, 4);
    EXPECT_EQ(height, 2);
}

TEST_F(SavePictureTest, ExposureDoublesPerStop) {
    const Picture picture{.width = 1, .height = 1, .pixels = {{0.1f, 0.2f, 0.4f}}};
    const auto bytes = [&](double ev) {
        save_picture(folder_ / "p.png", picture, ev);
        int width = 0, height = 0;
        return decoded(folder_ / "p.png", width, height);
    };
    const auto zero = bytes(0.0), up = bytes(1.0), down = bytes(-1.0);
    EXPECT_EQ(up[0], zero[1]);
    EXPECT_EQ(up[1], zero[2]);
    EXPECT_EQ(down[1], zero[0]);
    EXPECT_EQ(down[2], zero[1]);
    const auto exr = [&](double ev) {
        save_picture(folder_ / "p.exr", picture, ev);
        return cubemap::decode_exr(files::read(folder_ / "p.exr"), "p.exr").pixels.at(0);
    };
    EXPECT_EQ(exr(0.0), picture.pixels[0]);
    EXPECT_EQ(exr(1.0), 2.0f * picture.pixels[0]);
    EXPECT_EQ(exr(-3.0), 0.125f * picture.pixels[0]);
}

TEST_F(SavePictureTest, ExrIsLinearFloatRowByRowFromTheTop) {
    Picture picture{.width = 3, .height = 2};
    for (int i = 0; i < 6; ++i)
        picture.pixels.emplace_back(i, 1e-3f * static_cast<float>(i), 1e6f * static_cast<float>(i));
    save_picture(folder_ / "p.exr", picture);
    const cubemap::ImageFile image = cubemap::decode_exr(files::read(folder_ / "p.exr"), "p.exr");
    EXPECT_EQ(image.width, 3u);
    EXPECT_EQ(image.height, 2u);
    EXPECT_EQ(image.pixels, picture.pixels);
    EXPECT_FALSE(image.envmap) << "a picture is no environment";
}

TEST_F(SavePictureTest, RefusesOtherNamesAndUnwritablePlaces) {
    const Picture picture{.width = 1, .height = 1, .pixels = {glm::vec3(1.0f)}};
    for (const char* name : {"p.jpg", "p", "p.hdr", "png"})
        EXPECT_THROW(save_picture(folder_ / name, picture), std::invalid_argument);
    const fs::path missing = folder_ / "missing" / "p.png";
    scenes::expect_refused(missing, "cannot write", [&] { save_picture(missing, picture); });
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SavePictureTest, RefusesAPictureShortOfPixels) {
    const Picture picture{.width = 4, .height = 4, .pixels = {glm::vec3(1.0f)}};
    EXPECT_THROW(save_picture(folder_ / "p.png", picture), std::invalid_argument);
    EXPECT_THROW(save_picture(folder_ / "p.exr", picture), std::invalid_argument);
    EXPECT_TRUE(fs::is_empty(folder_));
}

} // namespace
} // namespace relumine::relight
