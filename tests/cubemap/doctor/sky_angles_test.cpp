#include "cubemap/doctor/sky_angles.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::cubemap {
namespace {

TEST(SkyAngles, Axes) {
    const auto expect = [](const glm::dvec3& w, double elevation, double azimuth) {
        const SkyAngles angles = sky_angles(w);
        EXPECT_NEAR(angles.elevation_degrees, elevation, 1e-12);
        EXPECT_NEAR(angles.azimuth_degrees, azimuth, 1e-12);
    };
    expect({0, 0, 2}, 0, 0);
    expect({3, 0, 0}, 0, 90);
    expect({0, 0, -1}, 0, 180);
    expect({-0.0, 0, -1}, 0, 180); // not -180
    expect({-1, 0, 0}, 0, -90);
    expect({0, 1, 0}, 90, 0);
    expect({0, -1, 0}, -90, 0);
    expect({1, std::sqrt(2.0), 1}, 45, 45);
}

TEST(SkyAngles, ThereAndBack) {
    for (const double elevation : {-80.0, -10.0, 0.0, 35.0, 89.0}) {
        for (const double azimuth : {-179.0, -60.0, 0.0, 30.0, 120.0, 180.0}) {
            const glm::dvec3 w = direction(SkyAngles{elevation, azimuth});
            EXPECT_NEAR(glm::length(w), 1.0, 1e-12);
            const SkyAngles back = sky_angles(w);
            EXPECT_NEAR(back.elevation_degrees, elevation, 1e-9);
            EXPECT_NEAR(back.azimuth_degrees, azimuth, 1e-9);
        }
    }
}

TEST(SkyAngles, DiscDiameter) {
    constexpr double Pi = std::numbers::pi;
    EXPECT_EQ(disc_diameter_degrees(0.0), 0.0);
    EXPECT_NEAR(disc_diameter_degrees(2.0 * Pi), 180.0, 1e-9); // a hemisphere
    EXPECT_NEAR(disc_diameter_degrees(4.0 * Pi), 360.0, 1e-6);
    const double radius = 0.2665 * Pi / 180.0;
    EXPECT_NEAR(disc_diameter_degrees(2.0 * Pi * (1.0 - std::cos(radius))), 0.533, 1e-6);
}

} // namespace
} // namespace relumine::cubemap
