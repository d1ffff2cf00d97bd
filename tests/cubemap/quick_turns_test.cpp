#include "cubemap/quick_turns.h"

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::cubemap {
namespace {

constexpr float BrightestSun = 2e5f;

/// A soft sky with waves, a window, and suns: amid a face, at an edge, at a corner.
CubeMap lit_room(std::uint32_t resolution) {
    CubeMap map(resolution);
    for (const Face face : AllFaces)
        for (std::uint32_t y = 0; y < resolution; ++y)
            for (std::uint32_t x = 0; x < resolution; ++x) {
                const glm::dvec3 w = texel_direction(face, x, y, resolution);
                map.at(face, x, y) =
                    glm::vec3(1.2 + w.y, 1.0 + 0.5 * std::sin(9.0 * w.x), 1.0 + w.z * w.x);
                if (glm::distance(w, glm::normalize(glm::dvec3(0.2, 0.5, 1.0))) < 0.2)
                    map.at(face, x, y) += glm::vec3(30.0f);
            }
    map.at(Face::PositiveZ, 60, 50) = glm::vec3(1.0f, 0.5f, 0.25f) * BrightestSun;
    map.at(Face::PositiveX, 0, 70) = glm::vec3(1e5f);
    map.at(Face::NegativeY, resolution - 1, resolution - 1) = glm::vec3(1e5f);
    return map;
}

const std::array<glm::dmat3, 5> Turns = {turn_about_y(33.0), turn_about_y(1e-3), turn_about_y(45.0),
                                         turn_about_x(-31.0) * turn_about_y(77.0),
                                         turn_about_y(90.0)};

TEST(QuickTurns, AreNearExactOnes) {
    for (const std::uint32_t resolution : {128u, 150u}) {
        const auto map = std::make_shared<const CubeMap>(lit_room(resolution));
        const QuickTurns turns(map);
        for (const glm::dmat3& turn : Turns) {
            const CubeMap quick = turns.turned(turn), exact = turned(*map, turn);
            const double power = total_power(exact).y;
            EXPECT_NEAR(total_power(quick).y / power, 1.0, 3e-4);
            for (const glm::dvec3 normal : {glm::dvec3(0, 1, 0), glm::dvec3(0.6, 0, 0.8),
                                            glm::dvec3(-0.8, -0.6, 0), glm::dvec3(0, 0, -1)})
                EXPECT_NEAR(irradiance(quick, normal).y, irradiance(exact, normal).y, 3e-4 * power);
            for (std::size_t i = 0; i < exact.texels.size(); ++i) {
                // Where suns are, but for rounding.
                if (exact.texels[i].y > 100.0f) {
                    ASSERT_LT(glm::distance(quick.texels[i], exact.texels[i]),
                              1e-6f * exact.texels[i].y + 5e-7f * BrightestSun)
                        << i;
                }
                // Half of the window's step.
                ASSERT_NEAR(quick.texels[i].y, exact.texels[i].y, 0.1 * exact.texels[i].y + 15.0)
                    << i;
            }
        }
    }
}

TEST(QuickTurns, ConstantsAreKept) {
    const QuickTurns turns(std::make_shared<const CubeMap>(128, glm::vec3(2.0f)));
    for (const glm::dmat3& turn : Turns)
        for (const glm::vec3& texel : turns.turned(turn).texels)
            ASSERT_NEAR(texel.x, 2.0f, 1e-6f);
}

TEST(QuickTurns, SmallMapsAreRefused) {
    EXPECT_THROW(QuickTurns(std::make_shared<const CubeMap>(64)), std::invalid_argument);
}

} // namespace
} // namespace relumine::cubemap
