// Angular map, mirror ball and octahedral map: their mathematics, their pixels' footprints, and
// what becomes of light in them.
#include "cubemap/image/projection.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/image/footprint.h"
#include "cubemap/resample/resample.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

constexpr std::array<Layout, 3> Projected = {Layout::AngularMap, Layout::MirrorBall,
                                             Layout::Octahedral};

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
    EXPECT_LT(glm::distance(a, b), tolerance)
        << a.x << ' ' << a.y << ' ' << a.z << " and " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(Projection, ShowsTheAxesWhereItsDescriptionSays) {
    const Projection& angular = *projection(Layout::AngularMap);
    expect_near(angular.direction({0.5, 0.5}), {0, 0, -1});
    expect_near(angular.direction({0.75, 0.5}), {1, 0, 0}); // a quarter of the way is 90 degrees
    expect_near(angular.direction({0.5, 0.25}), {0, 1, 0});
    expect_near(angular.direction({1.0, 0.5}), {0, 0, 1});
    expect_near(angular.direction({0.5, 1.0}), {0, 0, 1});

    const Projection& ball = *projection(Layout::MirrorBall);
    const double side =
        0.5 * std::sin(std::numbers::pi /
                       4.0); // where the ball's normal is half way between +Z and the axis
    expect_near(ball.direction({0.5, 0.5}), {0, 0, 1});
    expect_near(ball.direction({0.5 + side, 0.5}), {1, 0, 0});
    expect_near(ball.direction({0.5, 0.5 - side}), {0, 1, 0});
    expect_near(ball.direction({0.0, 0.5}), {0, 0, -1});

    const Projection& square = *projection(Layout::Octahedral);
    expect_near(square.direction({0.5, 0.5}), {0, 1, 0});
    expect_near(square.direction({1.0, 0.5}), {1, 0, 0});
    expect_near(square.direction({0.5, 1.0}), {0, 0, -1});
    expect_near(square.direction({0.5, 0.0}), {0, 0, 1});
    for (const glm::dvec2& corner : {glm::dvec2(0, 0), {1, 0}, {0, 1}, {1, 1}})
        expect_near(square.direction(corner), {0, -1, 0});
}

TEST(Projection, PointsAndDirectionsAreInverse) {
    std::mt19937 generator(3);
    std::normal_distribution<double> normal;
    for (const Layout layout : Projected) {
        const Projection& picture = *projection(layout);
        for (int i = 0; i < 1000; ++i) {
            const glm::dvec3 w =
                glm::normalize(glm::dvec3(normal(generator), normal(generator), normal(generator)));
            expect_near(picture.direction(picture.point(w)), w, 1e-9);
        }
        for (const glm::dvec3& axis :
             {glm::dvec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
            expect_near(picture.direction(picture.point(axis)), axis, 1e-7);
    }
}

TEST(Projection, DensityIsTheSolidAngleOfSmallSquares) {
    for (const Layout layout : Projected) {
        const Projection& picture = *projection(layout);
        for (const glm::dvec2& point :
             {glm::dvec2(0.31, 0.42), {0.47, 0.71}, {0.13, 0.55}, {0.62, 0.18}}) {
            constexpr double H = 1e-4;
            const glm::dvec3 across = picture.direction(point + glm::dvec2(H, 0)) -
                                      picture.direction(point - glm::dvec2(H, 0));
            const glm::dvec3 down = picture.direction(point + glm::dvec2(0, H)) -
                                    picture.direction(point - glm::dvec2(0, H));
            const double turn =
                glm::dot(glm::cross(across, down), picture.direction(point)) / (4 * H * H);
            EXPECT_NEAR(std::abs(turn) / picture.density(point), 1.0, 1e-5) << name(layout);
            EXPECT_EQ(turn < 0.0, picture.is_mirrored()) << name(layout);
        }
    }
}

TEST(ProjectionFootprints, PixelsTileTheSphereAtEveryResolution) {
    for (const Layout layout : Projected) {
        for (const std::uint32_t n : {1u, 2u, 3u, 7u, 16u, 33u, 100u}) {
            double sum = 0.0;
            for_each_pixel({layout, Sampling::TexelCentres, n, n},
                           [&](std::size_t, const PixelPlace& place) { sum += place.solid_angle; });
            EXPECT_NEAR(sum / (4.0 * std::numbers::pi), 1.0, 1e-5) << name(layout) << ' ' << n;
        }
    }
}

TEST(ProjectionFootprints, RimPixelsOfAMirrorBallHaveTheirShareOfTheDisc) {
    // Equal areas are equal solid angles, so the area of a square's part in the disc is known: here
    // by counting.
    constexpr std::uint32_t N = 9;
    ProjectionFootprints pieces(*projection(Layout::MirrorBall), N, N);
    for (std::uint32_t y = 0; y < N; ++y) {
        for (std::uint32_t x = 0; x < N; ++x) {
            double angle = 0.0;
            pieces.visit(
                x, y, [&](std::span<const glm::dvec3> corners) { angle += solid_angle(corners); });
            constexpr int K = 400;
            int inside = 0;
            for (int i = 0; i < K * K; ++i)
                inside += glm::distance(glm::dvec2((x + (i % K + 0.5) / K) / N,
                                                   (y + (static_cast<int>(i / K) + 0.5) / K) / N),
                                        glm::dvec2(0.5)) < 0.5;
            EXPECT_NEAR(angle, 16.0 * inside / (K * K) / (N * N), 16.0 * 2e-3 / (N * N))
                << x << ' ' << y;
        }
    }
}

TEST(ProjectionResample, ConstantsStayAndPowerIsKept) {
    for (const Layout layout : Projected) {
        for (const std::uint32_t n : {1u, 5u, 32u, 61u}) {
            EnvironmentImage image = black_image(layout, Sampling::TexelCentres, n);
            image.pixels.assign(image.pixels.size(), glm::vec3(3.0f));
            for (const glm::vec3& texel : resample(image, 20).texels)
                EXPECT_EQ(texel, glm::vec3(3.0f)) << name(layout);
            fill_randomly(image.pixels, n);
            const CubeMap map = resample(image, 20);
            EXPECT_NEAR(total_power(map).y / total_power(image).y, 1.0, 2e-5)
                << name(layout) << ' ' << n;
            const EnvironmentImage back = to_image(map, layout, n, n);
            EXPECT_NEAR(total_power(back).y / total_power(map).y, 1.0, 2e-5)
                << name(layout) << ' ' << n;
        }
    }
}

TEST(ProjectionResample, NothingBecomesNegativeBesideABrightTexel) {
    CubeMap map(40);
    for (const Face face : AllFaces)
        for (std::uint32_t i = 3; i < 40; i += 9)
            map.at(face, i, 40 - i) = glm::vec3(1e6f);
    for (const Layout layout :
         {Layout::AngularMap, Layout::MirrorBall, Layout::Octahedral, Layout::LatLong}) {
        const ImageSize size = natural_size(layout, 40);
        for (const glm::vec3& pixel : to_image(map, layout, size.width, size.height).pixels)
            EXPECT_GE(pixel.x, 0.0f) << name(layout);
    }
}

TEST(ProjectionResample, LightAtTheRimSurvives) {
    // The rim is one direction only, and every pixel along it shows it.
    for (const auto& [layout, rim] : {std::pair(Layout::AngularMap, glm::dvec3(0, 0, 1)),
                                      std::pair(Layout::MirrorBall, glm::dvec3(0, 0, -1))}) {
        CubeMap map(64);
        const FacePoint point = face_point(rim);
        map.at(point.face, 31, 31) = map.at(point.face, 32, 32) = glm::vec3(1e5f);
        const EnvironmentImage image = to_image(map, layout, 256, 256);
        EXPECT_NEAR(total_power(image).x / total_power(map).x, 1.0, 1e-4) << name(layout);
        const CubeMap back = resample(image, 64);
        EXPECT_NEAR(total_power(back).x / total_power(map).x, 1.0, 1e-4) << name(layout);
        EXPECT_NEAR(irradiance(back, rim).x / irradiance(map, rim).x, 1.0,
                    layout == Layout::AngularMap ? 1e-3 : 1e-2)
            << name(layout);
    }
}

} // namespace
} // namespace relumine::cubemap
