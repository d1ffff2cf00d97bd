#include "cubemap/face.h"

#include <cmath>
#include <numbers>
#include <random>

#include <ImfEnvmap.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::cubemap {
namespace {

TEST(Face, SolidAngleOfWholeFacesIsTheSphere) {
    EXPECT_NEAR(6.0 * solid_angle(0, 0, 1, 1), 4.0 * std::numbers::pi, 1e-14);
}

TEST(Face, SolidAnglesOfTexelsSumToTheFace) {
    for (const int resolution : {1, 2, 3, 7, 16, 31, 32, 33, 256}) {
        double sum = 0.0;
        const double n = resolution;
        for (int y = 0; y < resolution; ++y) {
            for (int x = 0; x < resolution; ++x)
                sum += solid_angle(x / n, y / n, (x + 1) / n, (y + 1) / n);
        }
        EXPECT_NEAR(sum / (4.0 * std::numbers::pi / 6.0), 1.0, 1e-10) << resolution;
    }
}

TEST(Face, SolidAngleOfATinyTexelIsItsAreaTimesTheDensity) {
    // Where the rectangle is so small that the density is constant over it.
    for (const double h : {1e-4, 1e-7, 1e-10}) {
        for (const double s : {0.0, 0.25, 0.5, 0.9}) {
            const double u = 2.0 * s + h - 1.0, v = 2.0 * 0.3 + h - 1.0;
            const double expected = 4.0 * h * h / std::pow(1.0 + u * u + v * v, 1.5);
            EXPECT_NEAR(solid_angle(s, 0.3, s + h, 0.3 + h) / expected, 1.0, 1e-6) << h << " " << s;
        }
    }
}

TEST(Face, SolidAngleIsAdditiveWhereTheFormulaChanges) {
    // 1/32 of a face is the largest rectangle that is integrated numerically.
    const double whole = solid_angle(0.1, 0.2, 0.1 + 1.0 / 31.0, 0.2 + 1.0 / 31.0);
    double parts = 0.0;
    for (int i = 0; i < 4; ++i)
        parts += solid_angle(0.1 + i / 124.0, 0.2, 0.1 + (i + 1) / 124.0, 0.2 + 1.0 / 31.0);
    EXPECT_NEAR(parts / whole, 1.0, 1e-10);
}

TEST(Face, DirectionAndFacePointAreInverse) {
    for (const Face face : AllFaces) {
        for (int i = 1; i < 64; ++i) {
            for (int j = 1; j < 64; ++j) {
                const FacePoint point = face_point(3.7 * direction(face, i / 64.0, j / 64.0));
                ASSERT_EQ(point.face, face);
                ASSERT_NEAR(point.s, i / 64.0, 1e-14);
                ASSERT_NEAR(point.t, j / 64.0, 1e-14);
            }
        }
    }
}

TEST(Face, DirectionsOfEdgesAndCornersComeBackToTheSameDirection) {
    for (const Face face : AllFaces) {
        for (int i = 0; i <= 8; ++i) {
            for (const auto& [s, t] :
                 {std::pair{i / 8.0, 0.0}, {i / 8.0, 1.0}, {0.0, i / 8.0}, {1.0, i / 8.0}}) {
                const FacePoint point = face_point(cube_point(face, s, t));
                EXPECT_LE(point.face, face) << "a tie goes to the first face";
                EXPECT_GE(point.s, 0.0);
                EXPECT_LE(point.t, 1.0);
                EXPECT_NEAR(
                    glm::distance(direction(point.face, point.s, point.t), direction(face, s, t)),
                    0.0, 1e-15);
            }
        }
    }
}

TEST(Face, AxesLieInTheMiddleOfTheirFaces) {
    const std::array<glm::dvec3, NumFaces> axes = {glm::dvec3{1, 0, 0}, {-1, 0, 0}, {0, 1, 0},
                                                   {0, -1, 0},          {0, 0, 1},  {0, 0, -1}};
    for (std::size_t i = 0; i < NumFaces; ++i) {
        EXPECT_EQ(face_point(axes[i]).face, AllFaces[i]);
        EXPECT_EQ(direction(AllFaces[i], 0.5, 0.5), axes[i]);
    }
}

TEST(Face, EveryFaceIsSeenFromInsideUnmirrored) {
    for (const Face face : AllFaces) {
        const glm::dvec3 out = cube_point(face, 0.5, 0.5);
        const glm::dvec3 right = cube_point(face, 1.0, 0.5) - out;
        const glm::dvec3 down = cube_point(face, 0.5, 1.0) - out;
        EXPECT_EQ(glm::cross(right, down), out);
    }
}

TEST(Face, AgreesWithOpenExr) {
    constexpr int Size = 17;
    const Imath::Box2i window({0, 0}, {Size - 1, 6 * Size - 1});
    std::mt19937 generator(1);
    std::normal_distribution<float> normal;
    for (int i = 0; i < 2000; ++i) {
        const Imath::V3f w(normal(generator), normal(generator), normal(generator));
        Imf::CubeMapFace face{};
        Imath::V2f in_face;
        Imf::CubeMap::faceAndPixelPosition(w, window, face, in_face);
        const Imath::V2f pixel = Imf::CubeMap::pixelPosition(face, window, in_face);
        const FacePoint ours = face_point({w.x, w.y, w.z});
        ASSERT_EQ(static_cast<int>(ours.face), static_cast<int>(face));
        ASSERT_NEAR(ours.s * (Size - 1), pixel.x, 1e-4);
        ASSERT_NEAR(ours.t * (Size - 1) + static_cast<int>(face) * Size, pixel.y, 1e-3);
        // and back: OpenEXR's own inverse for its position in the face
        const Imath::V3f back = Imf::CubeMap::direction(face, window, in_face).normalized();
        const glm::dvec3 ours_back = direction(ours.face, ours.s, ours.t);
        ASSERT_NEAR(glm::distance(ours_back, glm::dvec3(back.x, back.y, back.z)), 0.0, 1e-5);
    }
}

} // namespace
} // namespace relumine::cubemap
