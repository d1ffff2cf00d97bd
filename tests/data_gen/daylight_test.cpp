#include "data_gen/daylight.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "data_gen/environments.h"

namespace relumine::data_gen {
namespace {

double luminance(const glm::dvec3& c) {
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

// The paper's luminance, written down a second time: kcd/m^2.
double paper_zenith(double T, double theta_sun) {
    const double chi = (4.0 / 9.0 - T / 120.0) * (std::numbers::pi - 2.0 * theta_sun);
    return (4.0453 * T - 4.9710) * std::tan(chi) - 0.2155 * T + 2.4192;
}

double paper_luminance(double T, double theta_sun, double theta, double gamma) {
    const double A = 0.1787 * T - 1.4630;
    const double B = -0.3554 * T + 0.4275;
    const double C = -0.0227 * T + 5.3251;
    const double D = 0.1206 * T - 2.5771;
    const double E = -0.0670 * T + 0.3703;
    const auto F = [&](double t, double g) {
        return (1.0 + A * std::exp(B / std::cos(t))) *
               (1.0 + C * std::exp(D * g) + E * std::cos(g) * std::cos(g));
    };
    return paper_zenith(T, theta_sun) * F(theta, gamma) / F(0.0, theta_sun);
}

TEST(DaylightTest, AnglesRunFromZTowardsXAndUp) {
    const auto expect_near = [](const glm::dvec3& a, const glm::dvec3& b) {
        EXPECT_LT(glm::distance(a, b), 1e-12);
    };
    expect_near(direction_from_angles(0.0, 0.0), {0.0, 0.0, 1.0});
    expect_near(direction_from_angles(0.0, 90.0), {1.0, 0.0, 0.0});
    expect_near(direction_from_angles(90.0, 123.0), {0.0, 1.0, 0.0});
    expect_near(
        Daylight({.sun_elevation_degrees = 30.0, .sun_azimuth_degrees = -90.0}).sun_direction(),
        {-std::sqrt(0.75), 0.5, 0.0});
}

TEST(DaylightTest, LuminanceIsThePapers) {
    for (const double T : {2.0, 3.0, 6.0}) {
        for (const double elevation : {10.0, 35.0, 70.0}) {
            const Daylight daylight({.turbidity = T, .sun_elevation_degrees = elevation});
            const double theta_sun = (90.0 - elevation) * std::numbers::pi / 180.0;
            // Away from the sun's side too, where colours are inside Rec. 709 and nothing is
            // clamped.
            for (const double theta_degrees : {0.0, 20.0, 50.0, 80.0, 88.0}) {
                for (const double azimuth_degrees : {-60.0, 0.0, 45.0, 120.0}) {
                    const glm::dvec3 w =
                        direction_from_angles(90.0 - theta_degrees, azimuth_degrees);
                    const double gamma =
                        std::acos(std::min(1.0, glm::dot(w, daylight.sun_direction())));
                    const double expected = paper_luminance(
                        T, theta_sun, theta_degrees * std::numbers::pi / 180.0, gamma);
                    EXPECT_NEAR(luminance(daylight.sky(w)) / expected, 1.0, 2e-3)
                        << "turbidity " << T << " elevation " << elevation << " theta "
                        << theta_degrees;
                }
            }
        }
    }
}

TEST(DaylightTest, ZenithChromaticityIsThePapers) {
    const double T = 3.0;
    const double t = 55.0 * std::numbers::pi / 180.0;
    const double x = T * T * (0.00166 * t * t * t - 0.00375 * t * t + 0.00209 * t) +
                     T * (-0.02903 * t * t * t + 0.06377 * t * t - 0.03202 * t + 0.00394) +
                     (0.11693 * t * t * t - 0.21196 * t * t + 0.06052 * t + 0.25886);
    const double y = T * T * (0.00275 * t * t * t - 0.00610 * t * t + 0.00317 * t) +
                     T * (-0.04214 * t * t * t + 0.08970 * t * t - 0.04153 * t + 0.00516) +
                     (0.15346 * t * t * t - 0.26756 * t * t + 0.06670 * t + 0.26688);
    const glm::dvec3 c =
        Daylight({.turbidity = T, .sun_elevation_degrees = 35.0}).sky({0.0, 1.0, 0.0});
    const double X = 0.4124 * c.x + 0.3576 * c.y + 0.1805 * c.z;
    const double Y = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
    const double Z = 0.0193 * c.x + 0.1192 * c.y + 0.9505 * c.z;
    EXPECT_NEAR(X / (X + Y + Z), x, 1e-3);
    EXPECT_NEAR(Y / (X + Y + Z), y, 1e-3);
    EXPECT_GT(c.z, c.x) << "the zenith is blue";
}

TEST(DaylightTest, SunIsAsBrightAsTheRealOne) {
    const double sine = std::sin(Daylight::SunRadiusDegrees * std::numbers::pi / 180.0);
    const auto normal_klx = [&](double turbidity, double elevation) {
        return luminance(
                   Daylight({.turbidity = turbidity, .sun_elevation_degrees = elevation}).sun()) *
               std::numbers::pi * sine * sine;
    };
    // Above the atmosphere it is 128 klx; a clear day's high sun is known to give 90 to 110, haze
    // and low sun take it away.
    EXPECT_GT(normal_klx(2.0, 60.0), 90.0);
    EXPECT_LT(normal_klx(2.0, 60.0), 110.0);
    EXPECT_LT(normal_klx(5.0, 60.0), normal_klx(2.0, 60.0));
    EXPECT_LT(normal_klx(3.0, 10.0), 0.4 * normal_klx(3.0, 60.0));
    const glm::dvec3 high = Daylight({.sun_elevation_degrees = 60.0}).sun();
    const glm::dvec3 low = Daylight({.sun_elevation_degrees = 5.0}).sun();
    EXPECT_GT(low.x / low.z, 3.0 * high.x / high.z) << "a low sun is red";
}

TEST(DaylightTest, GroundReflectsSkyAndSun) {
    const DaylightOptions options{.ground_albedo = {0.3, 0.2, 0.1}};
    const glm::dvec3 irradiance = cubemap::irradiance(sun_and_sky(128, options), {0.0, 1.0, 0.0});
    const glm::dvec3 ground = Daylight(options).ground();
    for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(ground[channel] * std::numbers::pi /
                        (options.ground_albedo[channel] * irradiance[channel]),
                    1.0, 2e-3);
    }
}

TEST(DaylightTest, ScaleScalesEverything) {
    const Daylight one;
    const Daylight half({.scale = 0.5});
    const glm::dvec3 w = direction_from_angles(20.0, 100.0);
    EXPECT_LT(glm::distance(half.sky(w), 0.5 * one.sky(w)), 1e-12);
    EXPECT_LT(glm::distance(half.sun(), 0.5 * one.sun()), 1e-6);
    EXPECT_LT(glm::distance(half.ground(), 0.5 * one.ground()), 1e-12);
}

TEST(DaylightTest, StaysPositiveOverTheWholeRange) {
    for (const double T : {1.7, 2.0, 5.0, 10.0}) {
        for (const double elevation : {0.0, 3.0, 45.0, 90.0}) {
            const Daylight daylight({.turbidity = T, .sun_elevation_degrees = elevation});
            for (int theta = 0; theta <= 90; theta += 6) {
                for (int azimuth = 0; azimuth < 360; azimuth += 30) {
                    const glm::dvec3 c = daylight.sky(direction_from_angles(90.0 - theta, azimuth));
                    ASSERT_GT(luminance(c), 0.0)
                        << T << " " << elevation << " " << theta << " " << azimuth;
                    ASSERT_TRUE(c.x >= 0.0 && c.y >= 0.0 && c.z >= 0.0);
                }
            }
        }
    }
}

TEST(DaylightTest, RefusesOptionsOutOfRange) {
    EXPECT_THROW(Daylight({.turbidity = 1.0}), std::invalid_argument);
    EXPECT_THROW(Daylight({.turbidity = std::nan("")}), std::invalid_argument);
    EXPECT_THROW(Daylight({.sun_elevation_degrees = -1.0}), std::invalid_argument);
    EXPECT_THROW(Daylight({.sun_elevation_degrees = 91.0}), std::invalid_argument);
    EXPECT_THROW(Daylight({.ground_albedo = {0.2, 1.2, 0.2}}), std::invalid_argument);
    EXPECT_THROW(Daylight({.scale = 0.0}), std::invalid_argument);
}

} // namespace
} // namespace relumine::data_gen
