#include "viewer/orbit_camera.h"

#include <algorithm>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include "relumine/out/level_camera.h"
#include "viewer/look.h"
#include "viewer/panel_layout.h"

namespace relumine::viewer {
namespace {

constexpr PixelRectangle Viewport{.x = 30, .y = 40, .width = 400, .height = 300};

/// Where a point appears in the window.
glm::vec2 seen_at(const OrbitCamera& camera, const glm::vec3& point) {
    const glm::vec4 clip = clip_from_world(camera, Viewport, 10.0f) * glm::vec4(point, 1.0f);
    return {30.0f + 400.0f * (0.5f + 0.5f * clip.x / clip.w),
            40.0f + 300.0f * (0.5f - 0.5f * clip.y / clip.w)};
}

TEST(OrbitCamera, SeesWhatTheCameraItWasMadeFromSees) {
    const relight::Camera other{
        .eye = {3.0f, 2.0f, 4.0f}, .target = {0.5f, 1.0f, -1.0f}, .fov_degrees = 40.0f};
    const OrbitCamera camera = orbit_camera(other);
    EXPECT_LT(glm::length(camera.eye() - other.eye), 1e-5f);
    EXPECT_EQ(camera.target, other.target);
    EXPECT_EQ(camera.fov_degrees, 40.0f);
}

/// Straight down, a turn about the view is a direction.
TEST(OrbitCamera, StraightDownItTakesTheTurnOfAFilesCamera) {
    for (const float roll : {0.0f, 90.0f, -30.0f}) {
        const relight::Camera above{
            .eye = {1, 5, 2}, .target = {1, 0, 2}, .fov_degrees = 40.0f, .roll_degrees = roll};
        EXPECT_EQ(leveled(above).roll_degrees, 0.0f);
        const OrbitCamera camera = orbit_camera(above);
        const glm::vec3 up = mesh::rolled_axes({0, -1, 0}, roll).up;
        const glm::vec3 found = glm::normalize(frame(camera, Viewport).up);
        EXPECT_LT(glm::distance(found, up), 0.02f) << roll;
    }
    EXPECT_EQ(leveled({.eye = {1, 2, 3}, .target = {0, 0, 0}, .roll_degrees = 30}).roll_degrees,
              30.0f);
}

TEST(OrbitCamera, OptionsCountAsInTheMeshsFile) {
    const OrbitCamera camera{.target = {0.5f, 1.0f, -0.25f}, .distance = 3.0f};
    EXPECT_EQ(camera_options(camera, glm::dvec3(0.0)),
              "--camera 0.00,0.00,3,35 --target 0.5,1,-0.25");
    EXPECT_EQ(camera_options(camera, {691234, 520, 5334567}),
              "--camera 0.00,0.00,3,35 --target 691234.5,521,5334566.75");
}

TEST(OrbitCamera, FromTheFrontXIsToTheRightAndYUp) {
    const OrbitCamera camera{.distance = 5.0f};
    EXPECT_GT(seen_at(camera, {1, 0, 0}).x, seen_at(camera, {0, 0, 0}).x);
    EXPECT_LT(seen_at(camera, {0, 1, 0}).y, seen_at(camera, {0, 0, 0}).y);
}

TEST(OrbitCamera, RayThroughAPixelMeetsThePointThatIsSeenThere) {
    const OrbitCamera camera{
        .target = {0.2f, 0.1f, 0.3f}, .distance = 4.0f, .yaw = 0.7f, .pitch = 0.4f};
    const glm::vec3 point(0.6f, -0.4f, 0.9f);
    const Ray ray = ray_through(camera, Viewport, seen_at(camera, point));
    EXPECT_LT(glm::length(glm::cross(ray.direction, glm::normalize(point - ray.origin))), 1e-4f);
}

TEST(OrbitCamera, SidesOfThePictureGoThroughItsEdges) {
    const OrbitCamera camera{
        .target = {0.2f, 0.1f, 0.3f}, .distance = 4.0f, .yaw = 0.7f, .pitch = 0.4f};
    const auto x = static_cast<float>(Viewport.x), y = static_cast<float>(Viewport.y),
               right = x + static_cast<float>(Viewport.width),
               bottom = y + static_cast<float>(Viewport.height);
    const auto least = [&](const glm::vec2& pixel) {
        const Ray ray = ray_through(camera, Viewport, pixel);
        float result = 1.0f;
        for (const glm::vec4& side : picture_sides(camera, Viewport))
            result = std::min(result, glm::dot(glm::vec3(side), ray.origin + 3.0f * ray.direction) +
                                          side.w);
        return result;
    };
    EXPECT_GT(least({0.5f * (x + right), 0.5f * (y + bottom)}), 0.1f);
    for (const glm::vec2& edge :
         {glm::vec2(x, y + 20.0f), {right, y + 30.0f}, {x + 20.0f, y}, {x + 30.0f, bottom}}) {
        EXPECT_NEAR(least(edge), 0.0f, 1e-4f);
    }
}

TEST(OrbitCamera, PanningMovesTheTargetWithThePointer) {
    OrbitCamera camera{.target = {1, 2, 3}, .distance = 4.0f, .yaw = 0.5f, .pitch = 0.3f};
    const glm::vec3 point = camera.target;
    const glm::vec2 before = seen_at(camera, point);
    camera.pan({25.0f, -13.0f}, Viewport);
    const glm::vec2 after = seen_at(camera, point);
    EXPECT_NEAR(after.x - before.x, 25.0f, 0.1f);
    EXPECT_NEAR(after.y - before.y, -13.0f, 0.1f);
}

TEST(OrbitCamera, LookingAroundKeepsTheEyeAndFlyingGoesWhereItLooks) {
    OrbitCamera camera{.target = {1, 2, 3}, .distance = 4.0f, .yaw = 0.5f, .pitch = 0.3f};
    const glm::vec3 eye = camera.eye();
    const glm::vec3 right = frame(camera, Viewport).right;
    camera.look({50.0f, 0.0f});
    EXPECT_LT(glm::length(camera.eye() - eye), 1e-5f);
    EXPECT_GT(glm::dot(frame(camera, Viewport).forward, right), 0.0f) << "to the right";
    const float before = camera.pitch;
    camera.look({0.0f, 30.0f});
    EXPECT_GT(camera.pitch, before) << "down";
    const CameraFrame axes = frame(camera, Viewport);
    camera.fly({0.0f, 0.0f, 2.0f});
    EXPECT_LT(glm::length(camera.eye() - eye - 2.0f * axes.forward), 1e-5f);
    camera.fly({3.0f, 1.0f, -2.0f});
    EXPECT_LT(
        glm::length(camera.eye() - eye - 3.0f * glm::normalize(axes.right) - glm::vec3(0, 1, 0)),
        1e-5f);
}

TEST(OrbitCamera, DraggingToTheRightTurnsTheFrontToTheRightAndNeverGoesOverTheTop) {
    OrbitCamera camera{.distance = 5.0f};
    camera.orbit({40.0f, 0.0f});
    EXPECT_GT(seen_at(camera, {0, 0, 1}).x, seen_at(camera, {0, 0, 0}).x);
    camera.orbit({0.0f, 1e6f});
    EXPECT_LT(camera.pitch, 1.5708f);
    EXPECT_GT(camera.eye().y, 4.9f);
}

TEST(PanelLayout, PanelsFillTheWindowWithoutOverlaps) {
    for (const int width : {320, 800, 1440, 4000})
        for (const int height : {320, 600, 860, 2000}) {
            const PanelLayout layout = panel_layout(width, height);
            const std::vector<PixelRectangle> panels = {
                layout.scene_tools, layout.scene,  layout.environment_tools,
                layout.environment, layout.layers, layout.status};
            for (int y = 0; y < height; y += 7)
                for (int x = 0; x < width; x += 13)
                    EXPECT_LE(
                        std::count_if(panels.begin(), panels.end(),
                                      [&](const PixelRectangle& p) { return p.contains(x, y); }),
                        1);
            EXPECT_EQ(layout.environment.x + layout.environment.width, width);
            EXPECT_EQ(layout.status.y + layout.status.height, height);
        }
}

} // namespace
} // namespace relumine::viewer
