#include "relight/pictures/picture_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "prt/receivers/mesh_point.h"
#include "tests/prt/scenes.h"
#include "tests/relight/environments.h"

namespace relumine::relight {
namespace {

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
    cubemap::CubeMap environment = axes_environment();

    [[nodiscard]] Picture picture(const std::vector<glm::vec3>& radiance, const Camera& camera,
                                  const PictureOptions& options) const {
        return PictureView(mesh, rays, camera, options)
            .draw({.radiance = radiance}, map_backdrop(environment));
    }
};

const glm::vec3& pixel(const Picture& picture, std::uint32_t x, std::uint32_t y) {
    return picture.pixels[std::size_t{y} * picture.width + x];
}

TEST(PictureView, ShowsTheSideThatFacesTheEyeOfASurfaceThatIsThereTwice) {
    Drawn scene;
    const std::size_t n = scene.mesh.num_vertices();
    // The same square once more, seen from behind: other vertices, corners in another order.
    for (std::size_t i = 0; i < n; ++i) {
        scene.mesh.positions.push_back(scene.mesh.positions[i]);
        scene.mesh.normals.emplace_back(0, 0, -1);
    }
    scene.mesh.triangles.push_back({5, 4, 7});
    scene.mesh.triangles.push_back({6, 7, 4});
    // Bright in front, red towards the right; dark behind.
    std::vector<glm::vec3> radiance = {{0, 1, 0}, {1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
    radiance.resize(2 * n, glm::vec3(0.0f));
    // Whichever comes first.
    for (int order = 0; order < 2; ++order) {
        scene.rays = prt::RayScene(scene.mesh);
        const Picture picture = scene.picture(radiance, FrontCamera,
                                              {.width = 64, .height = 64, .samples_per_axis = 2});
        for (std::uint32_t y = 18; y < 46; ++y)
            for (std::uint32_t x = 18; x < 46; ++x) {
                const float right = (static_cast<float>(x) + 0.5f - 16.0f) / 32.0f;
                EXPECT_NEAR(pixel(picture, x, y).g, 1.0f, 1e-4f) << x << ' ' << y;
                EXPECT_NEAR(pixel(picture, x, y).r, right, 1e-2f) << x << ' ' << y;
            }
        std::reverse(scene.mesh.triangles.begin(), scene.mesh.triangles.end());
    }
}

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance) {
    EXPECT_LE(glm::length(a - b), tolerance)
        << a.r << ' ' << a.g << ' ' << a.b << " is not " << b.r << ' ' << b.g << ' ' << b.b;
}

TEST(PictureView, ASquareBeforeABackground) {
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

TEST(PictureView, RightIsRightAndUpIsUp) {
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

TEST(PictureView, BackgroundLiesWhereTheAxesAre) {
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

TEST(PictureView, WidePicturesShowMoreAtTheSidesNotLess) {
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

TEST(PictureView, SamplesOfAPixelAreAveraged) {
    // The square's edge halves a column of pixels: 15 pixels over 4 units, the edge at 11.25.
    const Drawn drawn;
    const Picture picture =
        drawn.picture(std::vector<glm::vec3>(4, glm::vec3(8.0f, 0.0f, 0.5f)), FrontCamera,
                      {.width = 15, .height = 15, .samples_per_axis = 4});
    expect_near(pixel(picture, 11, 7), {2.0f, 0.0f, 0.5f}, 1e-4f);
}

TEST(PictureView, TheNearestSurfaceIsSeen) {
    const mesh::TriangleMesh front = square();
    mesh::TriangleMesh behind = square();
    for (glm::vec3& position : behind.positions)
        position.z -= 0.5f;
    const mesh::TriangleMesh both = scenes::joined(behind, front);
    std::vector<glm::vec3> radiance(4, glm::vec3(1.0f, 0.0f, 0.0f));
    radiance.resize(8, glm::vec3(0.0f, 1.0f, 0.0f));
    const prt::RayScene rays(both);
    const Picture picture =
        PictureView(both, rays, FrontCamera, {.width = 8, .height = 8, .samples_per_axis = 1})
            .cut_out({.radiance = radiance});
    expect_near(pixel(picture, 4, 4), {0.0f, 1.0f, 0.0f}, 1e-5f);
}

TEST(PictureView, AnyNumberOfThreadsGivesTheSameBits) {
    const Drawn drawn;
    std::vector<glm::vec3> first;
    for (const std::size_t num_threads : {1u, 2u}) {
        const files::ThreadLimit threads(num_threads);
        const Picture picture = drawn.picture({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                              FrontCamera, {.width = 33, .height = 21});
        if (!first.empty()) {
            EXPECT_EQ(picture.pixels, first);
        }
        first = picture.pixels;
    }
}

TEST(PictureView, RefusesBadSizesAndCameras) {
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
    const PictureView view(drawn.mesh, drawn.rays, FrontCamera);
    const std::span<const glm::vec3> three = std::span(white).first(3);
    EXPECT_THROW(static_cast<void>(view.cut_out({.radiance = three})), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(view.cut_out({.radiance = white, .albedo = three})),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(map_backdrop({})), std::invalid_argument);
}

TEST(PictureView, KeptRaysDrawWhatTracedOnesDraw) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const prt::RayScene rays(mesh);
    const cubemap::CubeMap sky = scenes::smooth_environment(16);
    const PictureOptions options{.width = 40, .height = 30, .samples_per_axis = 2};
    const Camera camera{.eye = {4.0f, 3.0f, 5.0f}};
    const std::vector<glm::vec3> radiance(mesh.num_vertices(), glm::vec3(0.5f));
    const std::vector<SharpLight> lights = {
        {.direction = {0.6, 0.8, 0.0}, .irradiance = {{0.6, 0.8, 0.0}, {}, {}}}};
    const MeshLight light{.radiance = radiance, .lights = lights, .bias = 1e-3f};
    const PictureView kept(mesh, rays, camera, options);
    const PictureView traced(mesh, rays, camera, options, {}, 100);
    EXPECT_EQ(kept.draw(light, map_backdrop(sky)).pixels,
              traced.draw(light, map_backdrop(sky)).pixels);
}

/// A square of two metres a metre above a floor of twenty.
mesh::TriangleMesh plate_above_floor() {
    mesh::TriangleMesh mesh = scenes::floor_grid(2, 20.0f);
    mesh::TriangleMesh plate;
    plate.positions = {{-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}};
    plate.normals.assign(4, {0, 1, 0});
    plate.triangles = {{0, 1, 2}, {0, 2, 3}};
    return scenes::joined(mesh, plate);
}

TEST(PictureView, ShadowsOfTracedLightsAreAsSharpAsThePicture) {
    // The floor has four vertices, and none of them is in the shadow.
    const mesh::TriangleMesh mesh = plate_above_floor();
    const prt::RayScene rays(mesh);
    const std::vector<glm::vec3> soft(mesh.num_vertices(), glm::vec3(0.25f));
    const glm::dvec3 w = glm::normalize(glm::dvec3(1.0, 1.0, 0.0));
    const std::vector<SharpLight> lights = {
        {.direction = w,
         .irradiance = {std::numbers::pi * w, 2.0 * std::numbers::pi * w, glm::dvec3(0.0)}}};
    const std::vector<glm::vec3> albedo(mesh.num_vertices(), glm::vec3(0.5f));
    // From under the plate the camera sees the floor alone, two pixels a metre.
    const Camera camera{.eye = {-1.0f, 0.9f, 0.0f},
                        .target = {-1.0f, 0.0f, 0.0f},
                        .fov_degrees =
                            2.0f * std::atan(4.0f / 0.9f) * 180.0f / std::numbers::pi_v<float>};
    const Picture picture =
        PictureView(mesh, rays, camera, {.width = 16, .height = 16, .samples_per_axis = 3})
            .cut_out({.radiance = soft, .lights = lights, .albedo = albedo, .bias = 1e-4f});
    const auto cosine = static_cast<float>(w.y);
    for (std::uint32_t row = 0; row < 16; ++row)
        for (std::uint32_t column = 0; column < 16; ++column) {
            // The shadow of [-1, 1] x [-1, 1] is moved by a metre to -X.
            const float x = -1.0f + (static_cast<float>(column) + 0.5f - 8.0f) / 2.0f;
            const float z = (static_cast<float>(row) + 0.5f - 8.0f) / 2.0f;
            const bool is_dark = x > -2.0f && x < 0.0f && std::abs(z) < 1.0f;
            expect_near(pixel(picture, column, row),
                        glm::vec3(0.25f) +
                            (is_dark ? 0.0f : 0.5f * cosine) * glm::vec3(1.0f, 2.0f, 0.0f),
                        1e-4f);
        }
}

TEST(PictureView, TheTerminatorOfATracedLightIsSmooth) {
    // A sphere of few facets with smooth normals, lit from the side: E max(n.w, 0) with no facet
    // in its own shadow.
    const mesh::TriangleMesh sphere = scenes::icosphere(2, 1.0f, glm::vec3(0.0f));
    const prt::RayScene rays(sphere);
    const std::vector<glm::vec3> black(sphere.num_vertices(), glm::vec3(0.0f));
    const glm::dvec3 w(1.0, 0.0, 0.0);
    const std::vector<SharpLight> lights = {{.direction = w, .irradiance = {w, w, w}}};
    const Camera camera{.eye = {0, 0, 5}};
    const PictureOptions options{.width = 64, .height = 64, .samples_per_axis = 1};
    const Picture picture = PictureView(sphere, rays, camera, options)
                                .cut_out({.radiance = black, .lights = lights, .bias = 1e-4f});
    const prt::PictureRays grid(camera, 64, 64, 1);
    std::size_t num_lit = 0;
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x)
            if (const auto hit = rays.closest_hit(camera.eye, grid.direction(x, y, 0))) {
                const float cosine =
                    prt::shading_normal(sphere, {hit->triangle, hit->barycentric}).x;
                EXPECT_NEAR(pixel(picture, x, y).r,
                            std::max(cosine, 0.0f) / std::numbers::pi_v<float>, 1e-5f)
                    << x << ' ' << y;
                num_lit += cosine > 0.0f ? 1u : 0u;
            }
    EXPECT_GT(num_lit, 400u);
}

TEST(PictureView, TheFloorFadesIntoWhatIsBehind) {
    const mesh::TriangleMesh mesh = scenes::floor_grid(9, 8.0f);
    const prt::RayScene rays(mesh);
    const std::vector<glm::vec3> white(mesh.num_vertices(), glm::vec3(1.0f));
    const FadingFloor floor{
        .first_vertex = 0, .center = {0.0f, 0.0f}, .opaque_radius = 1.0f, .end_radius = 3.0f};
    EXPECT_EQ(floor.opacity({1, 0, 0}), 1.0f);
    EXPECT_EQ(floor.opacity({0, 0, 2}), 0.5f);
    EXPECT_EQ(floor.opacity({3, 0, 0}), 0.0f);
    const float fov = 2.0f * std::atan(4.0f / 20.0f) * 180.0f / std::numbers::pi_v<float>;
    const PictureView view(mesh, rays, {.eye = {0, 20, 0}, .fov_degrees = fov},
                           {.width = 16, .height = 16, .samples_per_axis = 1}, floor);
    const Picture cut_out = view.cut_out({.radiance = white});
    const Picture picture =
        view.draw({.radiance = white}, plain_backdrop(glm::vec3(0.0f, 4.0f, 0.0f)));
    for (std::uint32_t y = 0; y < 16; ++y)
        for (std::uint32_t x = 0; x < 16; ++x) {
            const float opacity = floor.opacity({(static_cast<float>(x) - 7.5f) / 2.0f, 0.0f,
                                                 (static_cast<float>(y) - 7.5f) / 2.0f});
            EXPECT_NEAR(cut_out.alpha[y * 16 + x], opacity, 1e-4f);
            expect_near(pixel(cut_out, x, y), glm::vec3(opacity), 2e-4f);
            expect_near(pixel(picture, x, y), {opacity, opacity + 4.0f * (1.0f - opacity), opacity},
                        1e-3f);
        }
}

} // namespace
} // namespace relumine::relight
