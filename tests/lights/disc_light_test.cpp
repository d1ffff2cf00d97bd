#include "tests/lights/disc_light.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::lights {
namespace {

double cap_solid_angle(double radius) {
    return 4.0 * std::numbers::pi * std::pow(std::sin(0.5 * radius), 2);
}

/// Mean of max(n.w, 0) over a cap around +Z, over that of n.w for n = +Z, by brute force.
double reference(double angle, double radius) {
    const glm::dvec3 normal(std::sin(angle), 0.0, std::cos(angle));
    double sum = 0.0, facing = 0.0;
    const int num_rings = 1500, num_steps = 1500;
    for (int ring = 0; ring < num_rings; ++ring) {
        const double z = 1.0 - (ring + 0.5) / num_rings * (1.0 - std::cos(radius));
        const double across = std::sqrt(1.0 - z * z);
        for (int step = 0; step < num_steps; ++step) {
            const double turn = 2.0 * std::numbers::pi * (step + 0.5) / num_steps;
            const glm::dvec3 w(across * std::cos(turn), across * std::sin(turn), z);
            sum += std::max(0.0, glm::dot(normal, w));
            facing += z;
        }
    }
    return sum / facing;
}

TEST(DiscLight, AgreesWithBruteForceAsItSets) {
    for (const double radius : {0.0046, 0.05, 0.5, 1.2}) {
        const DistantLight light{.direction = {0.0, 0.0, 1.0},
                                 .irradiance = {1.0, 2.0, 0.0},
                                 .solid_angle = cap_solid_angle(radius)};
        for (const double offset : {-2.0, -1.01, -0.99, -0.5, -0.1, 0.0, 0.1, 0.5, 0.99, 1.01}) {
            const double angle = 0.5 * std::numbers::pi + offset * radius;
            if (angle < 0.0)
                continue;
            const glm::dvec3 result = irradiance(light, {std::sin(angle), 0.0, std::cos(angle)});
            EXPECT_NEAR(result.x, reference(angle, radius), 1e-4 * radius)
                << radius << ' ' << offset;
            EXPECT_NEAR(result.y, 2.0 * result.x, 1e-12);
            EXPECT_EQ(result.z, 0.0);
        }
    }
}

TEST(DiscLight, APointIsACosine) {
    const DistantLight light{.direction = {0.0, 1.0, 0.0}, .irradiance = {3.0, 3.0, 3.0}};
    EXPECT_EQ(irradiance(light, {0.0, 1.0, 0.0}).x, 3.0);
    EXPECT_NEAR(irradiance(light, {0.8, 0.6, 0.0}).x, 1.8, 1e-12);
    EXPECT_EQ(irradiance(light, {0.0, -1.0, 0.0}).x, 0.0);
}

TEST(DiscLight, HugeAndTinyStayFinite) {
    for (const double solid_angle : {1e-12, 1e-9, 2.0 * std::numbers::pi, 4.0 * std::numbers::pi})
        for (const double y : {-1.0, -1e-6, 0.0, 1e-6, 1.0}) {
            const double value =
                irradiance({.irradiance = glm::dvec3(1.0), .solid_angle = solid_angle},
                           {std::sqrt(1.0 - y * y), y, 0.0})
                    .x;
            EXPECT_GE(value, 0.0);
            EXPECT_LE(value, 1.0 + 1e-12);
        }
}

} // namespace
} // namespace relumine::lights
