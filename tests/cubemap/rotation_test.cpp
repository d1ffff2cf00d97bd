#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/cube_map.h"
#include "cubemap/spherical_overlap.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

CubeMap random_map(std::uint32_t resolution) {
    CubeMap map(resolution);
    fill_randomly(map.texels, resolution);
    return map;
}

/// Centre of light, unit.
glm::dvec3 brightest(const CubeMap& map) {
    glm::dvec3 sum(0.0);
    for (const Face face : AllFaces) {
        for (std::uint32_t y = 0; y < map.resolution; ++y) {
            for (std::uint32_t x = 0; x < map.resolution; ++x)
                sum += double{map.at(face, x, y).x} * texel_direction(face, x, y, map.resolution);
        }
    }
    return glm::normalize(sum);
}

TEST(Rotation, NothingAndWholeTurnsChangeNothing) {
    for (const std::uint32_t resolution : {1u, 4u, 7u}) {
        const CubeMap map = random_map(resolution);
        for (const double degrees : {0.0, 360.0, -720.0})
            EXPECT_EQ(rotated(map, degrees).texels, map.texels);
    }
}

TEST(Rotation, QuarterTurnsAreExactAndGoTheRightWay) {
    const CubeMap map = random_map(5);
    const CubeMap turned = rotated(map, 90.0);
    // What came from +Z comes from +X, from +X from -Z, and so on; upright as before.
    for (std::uint32_t y = 0; y < 5; ++y) {
        for (std::uint32_t x = 0; x < 5; ++x) {
            ASSERT_EQ(turned.at(Face::PositiveX, x, y), map.at(Face::PositiveZ, x, y));
            ASSERT_EQ(turned.at(Face::NegativeZ, x, y), map.at(Face::PositiveX, x, y));
            ASSERT_EQ(turned.at(Face::NegativeX, x, y), map.at(Face::NegativeZ, x, y));
            ASSERT_EQ(turned.at(Face::PositiveZ, x, y), map.at(Face::NegativeX, x, y));
        }
    }
    EXPECT_EQ(rotated(turned, 270.0).texels, map.texels);
    EXPECT_EQ(rotated(turned, 90.0).texels, rotated(map, 180.0).texels);
    EXPECT_EQ(rotated(map, -90.0).texels, rotated(map, 270.0).texels);
}

TEST(Rotation, ALightTurnsCounterClockwiseSeenFromAbove) {
    CubeMap map(64);
    map.at(Face::PositiveZ, 20, 30) = glm::vec3(1e4f);
    const glm::dvec3 before = brightest(map);
    for (const double degrees : {1.0, 30.0, 45.0, 89.999, 90.0, 123.4, -77.0, 359.0}) {
        const CubeMap turned = rotated(map, degrees);
        const double angle = degrees * std::numbers::pi / 180.0;
        const glm::dvec3 expected(std::cos(angle) * before.x + std::sin(angle) * before.z, before.y,
                                  std::cos(angle) * before.z - std::sin(angle) * before.x);
        EXPECT_LT(glm::distance(brightest(turned), expected), 0.02) << degrees;
        EXPECT_NEAR(total_power(turned).x / total_power(map).x, 1.0, 1e-5) << degrees;
    }
}

TEST(Rotation, PowerAndConstantsAreKept) {
    for (const std::uint32_t resolution : {1u, 2u, 9u, 64u}) {
        const CubeMap map = random_map(resolution);
        const CubeMap constant(resolution, glm::vec3(2.0f));
        for (const double degrees : {0.1, 33.0, 45.0, 200.0}) {
            EXPECT_NEAR(total_power(rotated(map, degrees)).y / total_power(map).y, 1.0, 1e-6);
            for (const glm::vec3& texel : rotated(constant, degrees).texels)
                ASSERT_NEAR(texel.x, 2.0f, 1e-6f);
        }
    }
}

/// A texel of a turned map by itself, and the largest radiance that it meets.
struct PlainTexel {
    glm::dvec3 mean = glm::dvec3(0.0);
    double largest = 0.0;
};
PlainTexel turned_texel(const CubeMap& map, const glm::dmat3& turn, Face face, std::uint32_t x,
                        std::uint32_t y) {
    const double n = map.resolution;
    const auto corner = [&](std::uint32_t i, std::uint32_t j) {
        return glm::transpose(turn) * cube_point(face, i / n, j / n);
    };
    std::array<glm::dvec3, 4> corners = {corner(x, y), corner(x + 1, y), corner(x + 1, y + 1),
                                         corner(x, y + 1)};
    if (glm::determinant(turn) < 0.0)
        std::swap(corners[1], corners[3]);
    PlainTexel result;
    double weights = 0.0;
    TexelOverlaps(map.resolution)
        .find(corners, [&](Face from, std::uint32_t column, std::uint32_t row, double weight) {
            const glm::dvec3 texel(map.at(from, column, row));
            result.mean += texel * weight;
            result.largest = std::max({result.largest, texel.x, texel.y, texel.z});
            weights += weight;
        });
    result.mean /= weights;
    return result;
}

TEST(Rotation, LargeMapsTurnAsTexelByTexel) {
    const glm::dmat3 mirror = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
    for (const std::uint32_t resolution : {128u, 200u, 513u}) {
        CubeMap map = random_map(resolution);
        // Suns beside dark texels.
        for (std::size_t i = 0; i < map.texels.size(); i += 977)
            map.texels[i] *= 1e5f;
        for (const glm::dmat3& turn :
             {turn_about_y(33.0), turn_about_y(1e-3), turn_about_y(45.0), turn_about_x(71.0),
              turn_about_x(-90.0) * turn_about_y(13.0),
              turn_about_x(90.0) * turn_about_y(33.0) * turn_about_x(-90.0),
              mirror * turn_about_y(40.0), turn_about_x(20.0) * mirror,
              turn_about_y(20.0) * turn_about_x(-50.0) * mirror}) {
            const CubeMap result = turned(map, turn);
            EXPECT_NEAR(total_power(result).y / total_power(map).y, 1.0, 1e-6);
            // Prime to the width, so that all columns come.
            for (std::size_t i = 0; i < map.texels.size(); i += 61) {
                const std::size_t in_face = i % (std::size_t{resolution} * resolution);
                const auto face = static_cast<Face>(i / (std::size_t{resolution} * resolution));
                const PlainTexel plain =
                    turned_texel(map, turn, face, static_cast<std::uint32_t>(in_face % resolution),
                                 static_cast<std::uint32_t>(in_face / resolution));
                for (int channel = 0; channel < 3; ++channel)
                    ASSERT_NEAR(double{result.texels[i][channel]}, plain.mean[channel],
                                2e-6 * plain.mean[channel] + 5e-7 * plain.largest)
                        << resolution << " " << i;
            }
        }
    }
}

TEST(Rotation, ATexelThatMeetsNoLightStaysDark) {
    CubeMap map(256);
    map.at(Face::PositiveZ, 100, 120) = glm::vec3(1e6f);
    const glm::dmat3 turn = turn_about_y(17.0) * turn_about_x(-31.0);
    const CubeMap result = turned(map, turn);
    std::size_t num_lit = 0;
    for (std::size_t i = 0; i < map.texels.size(); ++i) {
        if (result.texels[i].x == 0.0f)
            continue;
        ++num_lit;
        const auto face = static_cast<Face>(i / (256u * 256u));
        const PlainTexel plain = turned_texel(map, turn, face, static_cast<std::uint32_t>(i % 256u),
                                              static_cast<std::uint32_t>(i / 256u % 256u));
        EXPECT_NEAR(double{result.texels[i].x}, plain.mean.x, 0.5) << i;
    }
    EXPECT_GE(num_lit, 4u);
    EXPECT_LE(num_lit, 16u);
}

TEST(Rotation, DifferencesOfMapsTurnToo) {
    const CubeMap map = random_map(256);
    CubeMap negative = map;
    for (glm::vec3& texel : negative.texels)
        texel = -texel;
    const CubeMap there = rotated(map, 33.0), negative_there = rotated(negative, 33.0);
    for (std::size_t i = 0; i < map.texels.size(); ++i)
        ASSERT_LT(glm::distance(negative_there.texels[i], -there.texels[i]), 1e-6f) << i;
}

TEST(Rotation, MemoryOfAMapIsWrittenOver) {
    for (const std::uint32_t resolution : {64u, 256u}) {
        const CubeMap map = random_map(resolution);
        for (const double degrees : {33.0, 90.0}) {
            const CubeMap expected = rotated(map, degrees);
            CubeMap memory(resolution, glm::vec3(7.0f));
            const glm::vec3* const texels = memory.texels.data();
            const CubeMap result = rotated(map, degrees, std::move(memory));
            EXPECT_EQ(result.texels, expected.texels);
            EXPECT_EQ(result.texels.data(), texels);
            EXPECT_EQ(rotated(map, degrees, CubeMap(16)).texels, expected.texels);
        }
    }
}

TEST(Rotation, IrradianceTurnsWithTheLight) {
    CubeMap map(96);
    for (const Face face : AllFaces) {
        for (std::uint32_t y = 0; y < 96; ++y) {
            for (std::uint32_t x = 0; x < 96; ++x) {
                const glm::dvec3 w = texel_direction(face, x, y, 96);
                map.at(face, x, y) = glm::vec3(
                    glm::dvec3(std::exp(8.0 * (glm::dot(w, glm::dvec3(0.6, 0.0, 0.8)) - 1.0))));
            }
        }
    }
    const CubeMap turned = rotated(map, 50.0);
    const double angle = 50.0 * std::numbers::pi / 180.0;
    const auto turn = [&](const glm::dvec3& w) {
        return glm::dvec3(std::cos(angle) * w.x + std::sin(angle) * w.z, w.y,
                          std::cos(angle) * w.z - std::sin(angle) * w.x);
    };
    for (const glm::dvec3 normal :
         {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0), glm::normalize(glm::dvec3(2, 1, 1))})
        EXPECT_NEAR(irradiance(turned, turn(normal)).x / irradiance(map, normal).x, 1.0, 1e-3);
}

TEST(Turned, TiltsAboutXAndMirrors) {
    EXPECT_EQ(turn_about_x(90.0) * glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1));
    EXPECT_EQ(turn_about_x(-90.0) * glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0));
    CubeMap map(24);
    for (std::size_t i = 0; i < map.texels.size(); ++i)
        map.texels[i] = glm::vec3(static_cast<float>(i % 97), static_cast<float>(i % 31), 1.0f);
    // A turn by parts comes near the turn at once, also in a mirror.
    const glm::dmat3 mirror = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
    for (const glm::dmat3& turn :
         {turn_about_x(35.0), turn_about_y(20.0) * turn_about_x(-50.0) * mirror}) {
        const CubeMap there = turned(map, turn);
        EXPECT_NEAR(total_power(there).x / total_power(map).x, 1.0, 1e-6);
        for (const glm::dvec3& normal : {glm::dvec3(0, 1, 0), glm::dvec3(0.6, 0, 0.8)})
            EXPECT_NEAR(irradiance(there, turn * normal).x / irradiance(map, normal).x, 1.0, 1e-2);
    }
    EXPECT_EQ(turned(turned(map, mirror), mirror).texels, map.texels);
}

} // namespace
} // namespace relumine::cubemap
