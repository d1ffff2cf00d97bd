#include "prt/receivers/camera.h"

#include <limits>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

// From (0, 0, 4) with half-angle atan(1/2) the picture spans [-2, 2] of the plane z = 0.
const Camera FrontCamera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 2.0f * 26.5650512f};

/// Where a ray from FrontCamera's eye meets z = 0.
glm::vec3 on_plane(const glm::vec3& direction) {
    return FrontCamera.eye + direction * (4.0f / -direction.z);
}

void expect_near(const glm::vec3& a, const glm::vec3& b) {
    EXPECT_LT(glm::length(a - b), 1e-5f) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(PictureRays, GoThroughTheCentresOfPixels) {
    const PictureRays rays(FrontCamera, 4, 4, 1);
    expect_near(on_plane(rays.direction(0, 0, 0)), {-1.5f, 1.5f, 0.0f});
    expect_near(on_plane(rays.direction(3, 1, 0)), {1.5f, 0.5f, 0.0f});
    EXPECT_NEAR(glm::length(rays.direction(3, 1, 0)), 1.0f, 1e-6f);
}

TEST(PictureRays, SamplesAreARegularGridRowByRow) {
    const PictureRays rays(FrontCamera, 8, 4, 2); // twice as wide: [-4, 4]
    EXPECT_EQ(rays.samples_per_pixel(), 4u);
    expect_near(on_plane(rays.direction(0, 0, 0)), {-3.75f, 1.75f, 0.0f});
    expect_near(on_plane(rays.direction(0, 0, 1)), {-3.25f, 1.75f, 0.0f});
    expect_near(on_plane(rays.direction(0, 0, 2)), {-3.75f, 1.25f, 0.0f});
    expect_near(on_plane(rays.direction(7, 3, 3)), {3.75f, -1.75f, 0.0f});
}

TEST(PictureRays, ARollTurnsThePicture) {
    Camera camera = FrontCamera;
    camera.roll_degrees = 90.0f; // the camera's right goes up
    const PictureRays rays(camera, 4, 4, 1);
    expect_near(on_plane(rays.direction(0, 0, 0)), {-1.5f, -1.5f, 0.0f});
    expect_near(on_plane(rays.direction(3, 1, 0)), {-0.5f, 1.5f, 0.0f});
}

TEST(PictureRays, LookingDownMinusZIsUp) {
    const PictureRays rays({.eye = {0, 5, 0}}, 2, 2, 1);
    EXPECT_LT(rays.direction(0, 0, 0).z, 0.0f);
    EXPECT_LT(rays.direction(0, 0, 0).x, 0.0f);
    EXPECT_GT(rays.direction(1, 1, 0).z, 0.0f);
}

TEST(PictureRays, RefusesWhatIsNoCamera) {
    EXPECT_THROW(PictureRays({.eye = {1, 2, 3}, .target = {1, 2, 3}}, 2, 2, 1),
                 std::invalid_argument);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(PictureRays({.eye = {nan, 2, 3}}, 2, 2, 1), std::invalid_argument);
    for (const float fov : {0.0f, -20.0f, 180.0f, nan})
        EXPECT_THROW(PictureRays({.eye = {1, 2, 3}, .fov_degrees = fov}, 2, 2, 1),
                     std::invalid_argument);
    EXPECT_THROW(PictureRays({.eye = {1, 2, 3}, .roll_degrees = nan}, 2, 2, 1),
                 std::invalid_argument);
    EXPECT_THROW(PictureRays(FrontCamera, 0, 2, 1), std::invalid_argument);
    EXPECT_THROW(PictureRays(FrontCamera, 2, MaxPictureSize + 1, 1), std::invalid_argument);
    EXPECT_THROW(PictureRays(FrontCamera, 2, 2, 0), std::invalid_argument);
    EXPECT_THROW(PictureRays(FrontCamera, 2, 2, MaxSamplesPerAxis + 1), std::invalid_argument);
}

} // namespace
} // namespace relumine::prt
