// Conventions of other programs, each written down here a second time, from the program's own
// lookup.
#include "cubemap/image/convention.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "cubemap/resample/convert.h"
#include "cubemap/resample/resample.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

/// A coloured light on each axis and a white mark that no mirror image or turn of the sphere leaves
/// in place.
glm::vec3 radiance(const glm::dvec3& w) {
    const std::array<std::pair<glm::dvec3, glm::dvec3>, 7> lights = {
        {{{1, 0, 0}, {1, 0, 0}},
         {{-1, 0, 0}, {0, 1, 1}},
         {{0, 1, 0}, {0, 1, 0}},
         {{0, -1, 0}, {1, 0, 1}},
         {{0, 0, 1}, {0, 0, 1}},
         {{0, 0, -1}, {1, 1, 0}},
         {{0.48, 0.64, 0.6}, {1, 1, 1}}}};
    glm::dvec3 sum(0.02);
    for (const auto& [direction, colour] : lights)
        sum += colour * std::exp(20.0 * (glm::dot(w, direction) - 1.0));
    return glm::vec3(sum);
}

/// Our axes from those of programs with Z up.
glm::dvec3 from_z_up(const glm::dvec3& w) {
    return {w.x, w.z, -w.y};
}

/// The world direction that a program sees at (u, v) of its picture, v down.
using Lookup = std::function<glm::dvec3(double u, double v)>;

glm::dvec3 spherical(double polar, double azimuth, int up) {
    const double across = std::sin(polar), height = std::cos(polar);
    return up == 2 ? glm::dvec3(across * std::cos(azimuth), across * std::sin(azimuth), height)
                   : glm::dvec3(across * std::sin(azimuth), height, across * std::cos(azimuth));
}

/// OpenGL 4.6, table 8.19: the direction at (s, t) of a face, its largest coordinate 1.
glm::dvec3 opengl_face(std::size_t face, double s, double t) {
    const double sc = 2.0 * s - 1.0, tc = 2.0 * t - 1.0;
    switch (face) {
    case 0:
        return {1.0, -tc, -sc}; // sc = -rz, tc = -ry
    case 1:
        return {-1.0, -tc, sc}; // sc = rz, tc = -ry
    case 2:
        return {sc, 1.0, tc}; // sc = rx, tc = rz
    case 3:
        return {sc, -1.0, -tc}; // sc = rx, tc = -rz
    case 4:
        return {sc, -tc, 1.0}; // sc = rx, tc = -ry
    default:
        return {-sc, -tc, -1.0}; // sc = -rx, tc = -ry
    }
}

/// The six faces stacked as a Cube.
Lookup stacked(const std::function<glm::dvec3(const glm::dvec3&)>& world) {
    return [world](double u, double v) {
        const double face = std::min(std::floor(6.0 * v), 5.0);
        return world(opengl_face(static_cast<std::size_t>(face), u, 6.0 * v - face));
    };
}

struct Known {
    const char* name;
    Layout layout;
    Lookup lookup;
};

std::vector<Known> known() {
    return {
        // ImfEnvmap.h: longitude pi at the left, -pi at the right, 0 is +Z and pi/2 is +X.
        {"openexr", Layout::LatLong,
         [](double u, double v) {
             return spherical(std::numbers::pi * v, std::numbers::pi - 2.0 * std::numbers::pi * u,
                              1);
         }},
        {"usd", Layout::LatLong,
         [](double u, double v) {
             return spherical(std::numbers::pi * v, std::numbers::pi - 2.0 * std::numbers::pi * u,
                              1);
         }},
        // envmap.cpp: u = atan2(x, -z) / 2 pi.
        {"mitsuba", Layout::LatLong,
         [](double u, double v) {
             return glm::dvec3(
                 std::sin(std::numbers::pi * v) * std::sin(2.0 * std::numbers::pi * u),
                 std::cos(std::numbers::pi * v),
                 -std::sin(std::numbers::pi * v) * std::cos(2.0 * std::numbers::pi * u));
         }},
        // Cycles: u = (atan2(y, x) - pi) / -2 pi.
        {"blender", Layout::LatLong,
         [](double u, double v) {
             return from_z_up(
                 spherical(std::numbers::pi * v, std::numbers::pi - 2.0 * std::numbers::pi * u, 2));
         }},
        // Cycles: d = 2 sqrt(-(y - 1) / 2); u = (x / d + 1) / 2 and upwards (z / d + 1) / 2. So
        // with p = (2u - 1, 1 - 2v): y = 2 |p|^2 - 1.
        {"blender", Layout::MirrorBall,
         [](double u, double v) {
             const double out =
                 std::max(std::hypot(2.0 * u - 1.0, 1.0 - 2.0 * v), 1.0); // corners show the rim
             const double x = (2.0 * u - 1.0) / out, z = (1.0 - 2.0 * v) / out;
             const double y = 2.0 * (x * x + z * z) - 1.0;
             const double d = 2.0 * std::sqrt(std::max(0.5 * (1.0 - y), 0.0));
             return from_z_up({x * d, y, z * d});
         }},
        // ShaderChunk common: u = atan2(z, x) / 2 pi + 1/2.
        {"threejs", Layout::LatLong,
         [](double u, double v) {
             const double angle = 2.0 * std::numbers::pi * (u - 0.5);
             return glm::dvec3(std::sin(std::numbers::pi * v) * std::cos(angle),
                               std::cos(std::numbers::pi * v),
                               std::sin(std::numbers::pi * v) * std::sin(angle));
         }},
        // Right-handed scenes: the middle is -Z, the left quarter -X.
        {"babylonjs", Layout::LatLong,
         [](double u, double v) {
             const double angle = 2.0 * std::numbers::pi * (u - 0.5);
             return glm::dvec3(std::sin(std::numbers::pi * v) * std::sin(angle),
                               std::cos(std::numbers::pi * v),
                               -std::sin(std::numbers::pi * v) * std::cos(angle));
         }},
        // Cube textures are looked up at (flipEnvMap x, y, z) with flipEnvMap = -1.
        {"threejs", Layout::Cube,
         stacked([](const glm::dvec3& w) { return glm::dvec3(-w.x, w.y, w.z); })},
        {"opengl", Layout::Cube, stacked([](const glm::dvec3& w) { return w; })},
        // The same lookup with left-handed coordinates.
        {"directx", Layout::Cube,
         stacked([](const glm::dvec3& w) { return glm::dvec3(w.x, w.y, -w.z); })},
        // EqualAreaSquareToSphere() for one quadrant at a time: r = 1 - |d|, phi = pi/4 ((v - u) /
        // r + 1).
        {"pbrt", Layout::Octahedral,
         [](double u, double v) {
             const double x = std::abs(2.0 * u - 1.0), y = std::abs(2.0 * v - 1.0), d = 1.0 - x - y;
             const double r = 1.0 - std::abs(d), phi = std::numbers::pi / 4.0 * ((y - x) / r + 1.0);
             const double across = r * std::sqrt(2.0 - r * r);
             return from_z_up({(u < 0.5 ? -1.0 : 1.0) * across * std::cos(phi),
                               (v < 0.5 ? -1.0 : 1.0) * across * std::sin(phi),
                               d < 0.0 ? r * r - 1.0 : 1.0 - r * r});
         }},
        // InfiniteAreaLight: s = phi / 2 pi, t = theta / pi.
        {"pbrt-v2", Layout::LatLong,
         [](double u, double v) {
             return from_z_up(spherical(std::numbers::pi * v, 2.0 * std::numbers::pi * u, 2));
         }},
    };
}

/// The picture that makes a program see the lights.
EnvironmentImage painted(const Known& each, std::uint32_t face_resolution) {
    const ImageSize size = natural_size(each.layout, face_resolution);
    EnvironmentImage image =
        black_image(each.layout, Sampling::TexelCentres, size.width, size.height);
    for (std::uint32_t y = 0; y < size.height; ++y) {
        for (std::uint32_t x = 0; x < size.width; ++x) {
            const double u = (x + 0.5) / size.width, v = (y + 0.5) / size.height;
            image.pixels[std::size_t{y} * size.width + x] =
                radiance(glm::normalize(each.lookup(u, v)));
        }
    }
    return image;
}

TEST(Convention, EveryOneIsTested) {
    for (const Convention& convention : conventions()) {
        bool found = false;
        for (const Known& each : known())
            found =
                found || (each.name == convention.name && each.layout == convention.usual_layout);
        EXPECT_TRUE(found) << convention.name;
        EXPECT_TRUE(convention.reads(convention.usual_layout));
        EXPECT_EQ(find_convention(convention.name), &convention);
    }
    EXPECT_EQ(find_convention("maya"), nullptr);
}

TEST(Convention, LightsComeFromWhereTheProgramSeesThem) {
    for (const Known& each : known()) {
        const Convention& convention = *find_convention(each.name);
        EnvironmentImage image = painted(each, 48);
        if (convention.swaps_z_faces)
            swap_z_faces(image);
        const EnvironmentImage cube =
            convert(image, {Layout::Cube, Sampling::TexelCentres, 24, 144},
                    convention.world_from(each.layout));
        double largest = 0.0;
        for_each_pixel(shape_of(cube), [&](std::size_t i, const PixelPlace& place) {
            // The last ring of the ball is 16 degrees wide.
            if (each.layout == Layout::MirrorBall && place.direction.z < -0.9)
                return;
            largest =
                std::max<double>(largest, glm::distance(cube.pixels[i], radiance(place.direction)));
        });
        EXPECT_LT(largest, 0.06) << each.name << ' ' << name(each.layout);
    }
}

TEST(Convention, WrittenPicturesAreThoseTheProgramsWouldSee) {
    EnvironmentImage cube = black_image(Layout::Cube, Sampling::TexelCentres, 96);
    paint(cube, radiance);
    for (const Known& each : known()) {
        const Convention& convention = *find_convention(each.name);
        const EnvironmentImage expected = painted(each, 32);
        EnvironmentImage written =
            convert(cube, shape_of(expected), glm::transpose(convention.world_from(each.layout)));
        if (convention.swaps_z_faces)
            swap_z_faces(written);
        double sum = 0.0, weight = 0.0;
        for_each_pixel(shape_of(expected), [&](std::size_t i, const PixelPlace& place) {
            sum += place.solid_angle * glm::distance(written.pixels[i], expected.pixels[i]);
            weight += place.solid_angle;
        });
        EXPECT_LT(sum / weight, each.layout == Layout::MirrorBall ? 0.01 : 0.005)
            << each.name << ' ' << name(each.layout);
    }
}

TEST(Convention, OpenGlsCubeIsOpenExrsWithZNegatedAndItsFacesExchanged) {
    for (std::size_t face = 0; face < NumFaces; ++face) {
        const std::size_t exchanged = face < 4 ? face : 9 - face;
        for (const glm::dvec2& p : {glm::dvec2(0.2, 0.9), {0.7, 0.4}}) {
            const glm::dvec3 ours = cube_point(AllFaces[exchanged], p.x, p.y);
            EXPECT_LT(
                glm::distance(opengl_face(face, p.x, p.y), glm::dvec3(ours.x, ours.y, -ours.z)),
                1e-15);
        }
    }
}

TEST(Convention, CubesAndLatLongsChangeHandsWithoutLosingABit) {
    EnvironmentImage cube = black_image(Layout::Cube, Sampling::TexelCentres, 8);
    fill_randomly(cube.pixels, 1);
    EnvironmentImage lat_long = black_image(Layout::LatLong, Sampling::TexelCentres, 16);
    fill_randomly(lat_long.pixels, 2);
    for (const Convention& convention : conventions()) {
        for (const EnvironmentImage* image : {&cube, &lat_long}) {
            if (!convention.reads(image->layout))
                continue;
            EnvironmentImage there = convert(*image, shape_of(*image),
                                             glm::transpose(convention.world_from(image->layout)));
            const EnvironmentImage back =
                convert(there, shape_of(*image), convention.world_from(image->layout));
            EXPECT_EQ(back.pixels, image->pixels) << convention.name;
        }
    }
}

} // namespace
} // namespace relumine::cubemap
