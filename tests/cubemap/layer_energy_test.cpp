// The light of every region against closed forms: in many places, at many resolutions, from far
// below a texel to half the sphere.
#include <array>
#include <cmath>
#include <functional>
#include <span>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/layers/layer_composite.h"
#include "tests/cubemap/layer_places.h"

namespace relumine::cubemap {
namespace {

/// A fifth of what users are promised (0.5 %).
constexpr double Tolerance = 1e-3;

CubeMap lit(std::uint32_t resolution, const Region& region) {
    const LightLayer layer{.name = "light", .region = region, .effect = Emit{{1.0f, 2.0f, 0.0f}}};
    return composite(CubeMap(resolution), std::span(&layer, 1));
}

/// Calls check(resolution, place) for resolutions from 8 to 1024 in all places (the largest in a
/// few).
void everywhere(const std::function<void(std::uint32_t, const glm::dvec3&)>& check) {
    for (const std::uint32_t resolution : {8u, 33u, 128u}) {
        for (const glm::dvec3& place : Places)
            check(resolution, place);
    }
    for (const std::size_t i : {3u, 5u, 9u})
        check(1024u, Places[i]);
}

void expect_power(const CubeMap& map, double expected) {
    const glm::dvec3 power = total_power(map);
    EXPECT_NEAR(power.x / expected, 1.0, Tolerance) << "R = " << map.resolution;
    EXPECT_NEAR(power.y / expected, 2.0, 2.0 * Tolerance);
    EXPECT_EQ(power.z, 0.0);
}

void expect_power(const Region& region, std::uint32_t resolution, double expected) {
    expect_power(lit(resolution, region), expected);
}

/// Irradiance of a receiver that faces the region, where texels are small enough for it.
void expect_irradiance(const CubeMap& map, const glm::dvec3& normal, double expected) {
    if (map.resolution >= 128) {
        EXPECT_NEAR(irradiance(map, glm::normalize(normal)).x / expected, 1.0, Tolerance);
    }
}

TEST(LayerEnergy, OfADisc) {
    for (const double degrees : {0.001, 0.2665, 3.0, 20.0, 90.0}) {
        const double a = radians(degrees);
        everywhere([&](std::uint32_t resolution, const glm::dvec3& place) {
            const CubeMap map = lit(resolution, Disc{place, degrees, 0.0});
            expect_power(map, 2.0 * Pi * (1.0 - std::cos(a)));
            expect_irradiance(map, place, Pi * std::sin(a) * std::sin(a));
        });
    }
    expect_power(Disc{{1, 2, 3}, 180.0, 0.0}, 16, 4.0 * Pi);
    expect_power(Disc{{1, 2, 3}, 150.0, 0.0}, 16, 2.0 * Pi * (1.0 - std::cos(radians(150.0))));
}

TEST(LayerEnergy, OfASoftDisc) {
    for (const double softness : {1e-6, 0.1, 0.5, 1.0}) {
        for (const double degrees : {0.01, 1.0, 15.0, 80.0}) {
            const double outer = std::cos(radians(degrees));
            const double inner = std::cos(radians(degrees * (1.0 - softness)));
            everywhere([&](std::uint32_t resolution, const glm::dvec3& place) {
                expect_power(Disc{place, degrees, softness}, resolution,
                             2.0 * Pi * (1.0 - 0.5 * (outer + inner)));
            });
        }
    }
}

TEST(LayerEnergy, OfARectangle) {
    for (const auto& [width, height] :
         {std::array{0.002, 0.003}, std::array{0.5, 4.0}, std::array{20.0, 2.0},
          std::array{90.0, 60.0}, std::array{175.0, 170.0}}) {
        const double x = std::tan(radians(0.5 * width)), y = std::tan(radians(0.5 * height));
        const double solid_angle = 4.0 * std::atan(x * y / std::sqrt(1.0 + x * x + y * y));
        const double nx = std::sqrt(1.0 + x * x), ny = std::sqrt(1.0 + y * y);
        const double facing = 2.0 * (x / nx * std::atan(y / nx) + y / ny * std::atan(x / ny));
        everywhere([&, w = width, h = height](std::uint32_t resolution, const glm::dvec3& place) {
            for (const double roll : {0.0, 30.0}) {
                const CubeMap map = lit(resolution, Rectangle{place, w, h, roll, 0.0});
                expect_power(map, solid_angle);
                expect_irradiance(map, place, facing);
            }
        });
    }
}

TEST(LayerEnergy, OfASoftRectangle) {
    for (const double softness : {0.01, 0.4, 1.0}) {
        const Rectangle shape{{0, 0, 1}, 30.0, 16.0, 20.0, softness};
        const double x = std::tan(radians(15.0)), y = std::tan(radians(8.0));
        // Midpoint rule on the plane, where the coverage is a product.
        constexpr int N = 2000;
        const auto profile = [&](double part) {
            const double t = std::min(1.0, (1.0 - std::abs(part)) / softness);
            return t * t * (3.0 - 2.0 * t);
        };
        double expected = 0.0;
        for (int j = 0; j < N; ++j) {
            for (int i = 0; i < N; ++i) {
                const double px = (2.0 * i + 1.0) / N - 1.0, py = (2.0 * j + 1.0) / N - 1.0;
                const double q = 1.0 + px * px * x * x + py * py * y * y;
                expected += profile(px) * profile(py) / (q * std::sqrt(q)) * 4.0 * x * y / N / N;
            }
        }
        everywhere([&](std::uint32_t resolution, const glm::dvec3& place) {
            Rectangle rectangle = shape;
            rectangle.direction = place;
            expect_power(rectangle, resolution, expected);
        });
    }
}

/// Solid angle of a polygon: its angles' sum less that of a flat one. Irradiance: Lambert's sum
/// over its edges.
struct PolygonLight {
    explicit PolygonLight(const Lasso& lasso, const glm::dvec3& normal) {
        const std::size_t n = lasso.points.size();
        for (std::size_t i = 0; i < n; ++i) {
            const glm::dvec3 before = glm::normalize(lasso.points[(i + n - 1) % n]);
            const glm::dvec3 here = glm::normalize(lasso.points[i]);
            const glm::dvec3 after = glm::normalize(lasso.points[(i + 1) % n]);
            // The turn at a corner, positive to the left.
            const glm::dvec3 in = glm::normalize(glm::cross(before, here));
            const glm::dvec3 out = glm::normalize(glm::cross(here, after));
            turns += std::atan2(glm::dot(here, glm::cross(in, out)), glm::dot(in, out));
            irradiance += 0.5 * std::acos(glm::dot(here, after)) * glm::dot(out, normal);
        }
    }
    double turns = 0.0;
    double irradiance = 0.0;
    [[nodiscard]] double solid_angle() const { return 2.0 * Pi - turns; }
};

TEST(LayerEnergy, OfALasso) {
    for (const double size : {0.01, 0.5, 6.0, 50.0}) {
        const double a = radians(size);
        // A triangle, a quadrangle with a notch, a star.
        for (const std::vector<double>& angles :
             {std::vector{a, a, a}, std::vector{a, 0.6 * a, a, 0.2 * a},
              std::vector{a, 0.5 * a, a, 0.4 * a, 0.9 * a, 0.5 * a, a, 0.45 * a}}) {
            everywhere([&](std::uint32_t resolution, const glm::dvec3& place) {
                const Lasso lasso = lasso_around(place, angles);
                const PolygonLight light(lasso, glm::normalize(place));
                const CubeMap map = lit(resolution, lasso);
                // The excess of small polygons drowns in rounding.
                if (size > 0.1)
                    expect_power(map, light.solid_angle());
                expect_irradiance(map, place, light.irradiance);
            });
        }
    }
}

TEST(LayerEnergy, OfASoftLassoIsThatOfAShrunkOne) {
    // Of a square with soft sides of b: the profile's mean distance from the side is b / 2, and
    // corners round nothing off inside.
    constexpr double Half = 0.02, Band = 0.004; // small, so nearly flat
    double expected = 0.0;
    constexpr int N = 1000;
    for (int j = 0; j < N; ++j) {
        for (int i = 0; i < N; ++i) {
            const double x = Half * ((2.0 * i + 1.0) / N - 1.0),
                         y = Half * ((2.0 * j + 1.0) / N - 1.0);
            const double t = std::min(1.0, (Half - std::max(std::abs(x), std::abs(y))) / Band);
            expected += t * t * (3.0 - 2.0 * t) * 4.0 * Half * Half / N / N;
        }
    }
    const double corner = Half * std::sqrt(2.0);
    everywhere([&](std::uint32_t resolution, const glm::dvec3& place) {
        Lasso lasso = lasso_around(place, {corner, corner, corner, corner});
        lasso.softness_degrees = Band * 180.0 / Pi;
        expect_power(lasso, resolution, expected);
    });
}

TEST(LayerEnergy, OfAStroke) {
    for (const double radius : {0.05, 1.0, 10.0}) {
        const double a = radians(radius);
        for (const double length : {0.0, 0.7, 2.5}) {
            everywhere([&](std::uint32_t resolution, const glm::dvec3& place) {
                const Frame frame(place);
                Stroke stroke{{frame.at(0.0, 1.0)}, radius, 0.0};
                if (length > 0.0) // a straight line in three parts
                    stroke.points.insert(stroke.points.end(),
                                         {frame.at(0.2 * length, 1.0), frame.at(0.5 * length, 1.0),
                                          frame.at(length, 1.0)});
                expect_power(stroke, resolution,
                             2.0 * Pi * (1.0 - std::cos(a)) + 2.0 * length * std::sin(a));
            });
        }
    }
}

TEST(LayerEnergy, OfADabIsThatOfADisc) {
    const glm::dvec3 place(0.9, 1.0, 0.1);
    EXPECT_EQ(lit(64, Stroke{{place}, 7.0, 0.3}).texels, lit(64, Disc{place, 7.0, 0.3}).texels);
}

} // namespace
} // namespace relumine::cubemap
