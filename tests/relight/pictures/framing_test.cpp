#include "relight/pictures/framing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"

namespace relumine::relight {
namespace {

/// Where a point lies in the picture: both coordinates in [-1, 1] when it is seen, up and right
/// positive.
glm::dvec2 projected(const glm::dvec3& point, const Camera& camera, double aspect) {
    const glm::dvec3 eye(camera.eye);
    const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.target) - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
    const glm::dvec3 offset = point - eye;
    const double half_height =
        std::tan(0.5 * static_cast<double>(camera.fov_degrees) * std::numbers::pi / 180.0) *
        glm::dot(offset, forward);
    return {glm::dot(offset, right) / (half_height * aspect),
            glm::dot(offset, glm::cross(right, forward)) / half_height};
}

TEST(Framing, FillsTwoThirdsAndIsInTheMiddle) {
    for (const float scale : {1e-6f, 1.0f, 1e6f})
        for (const glm::vec3& size :
             {glm::vec3(1.0f), glm::vec3(5.0f, 0.1f, 1.0f), glm::vec3(0.01f, 3.0f, 0.01f)})
            for (const float fov : {10.0f, 35.0f, 90.0f})
                for (const float aspect : {4.0f / 3.0f, 1.0f / 3.0f, 1.0f}) {
                    const glm::vec3 low = scale * glm::vec3(-3, 2, 7);
                    const mesh::TriangleMesh mesh = scenes::box(low, low + scale * size);
                    const Camera camera = framed(mesh, {.fov_degrees = fov, .aspect = aspect});
                    EXPECT_EQ(camera.fov_degrees, fov);
                    const glm::vec3 forward = glm::normalize(camera.target - camera.eye);
                    EXPECT_LT(forward.z, -0.5f) << "from the front";
                    EXPECT_LT(forward.y, 0.0f) << "from above";
                    EXPECT_LT(forward.x, 0.0f) << "from the right";
                    glm::dvec2 lowest(2.0), highest(-2.0);
                    for (const glm::vec3& position : mesh.positions) {
                        const glm::dvec2 at =
                            projected(position, camera, static_cast<double>(aspect));
                        lowest = glm::min(lowest, at);
                        highest = glm::max(highest, at);
                    }
                    const glm::dvec2 filled = 0.5 * (highest - lowest);
                    EXPECT_NEAR(std::max(filled.x, filled.y), 2.0 / 3.0, 2e-3);
                    const glm::dvec2 middle = 0.5 * (highest + lowest);
                    const bool is_wide = filled.x > filled.y;
                    EXPECT_NEAR(is_wide ? middle.x : middle.y, 0.0, 2e-3);
                    EXPECT_NEAR(is_wide ? middle.y : middle.x, 0.0, 0.25);
                }
}

TEST(Framing, StandsWhereTheAnglesSay) {
    const mesh::TriangleMesh mesh = scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f));
    const auto eye = [&](const CameraAngles& angles, const glm::dvec3& front = {0, 0, 1}) {
        const Camera camera = framed(mesh, {.angles = angles, .front = front});
        return glm::normalize(camera.eye - camera.target);
    };
    const auto expect_near = [](const glm::vec3& a, const glm::vec3& b) {
        EXPECT_LT(glm::distance(a, b), 1e-5f) << a.x << ' ' << a.y << ' ' << a.z;
    };
    expect_near(eye({.azimuth = 0, .elevation = 0}), {0, 0, 1});
    expect_near(eye({.azimuth = 90, .elevation = 0}), {1, 0, 0});
    expect_near(eye({.azimuth = -90, .elevation = 0}), {-1, 0, 0});
    expect_near(eye({.azimuth = 0, .elevation = 90}), {0, 1, 0});
    expect_near(eye({.azimuth = 0, .elevation = -90}), {0, -1, 0});
    expect_near(eye({.azimuth = 180, .elevation = 30}), {0, 0.5f, -std::sqrt(0.75f)});
    // The front of another side; its right is the camera's right then.
    expect_near(eye({.azimuth = 0, .elevation = 0}, {1, 0, 0}), {1, 0, 0});
    expect_near(eye({.azimuth = 90, .elevation = 0}, {1, 0, 0}), {0, 0, -1});
    expect_near(eye({.azimuth = 90, .elevation = 0}, {0, 0, -1}), {-1, 0, 0});
    const Camera far = framed(mesh, {.angles = {.azimuth = 10, .elevation = 5, .distance = 50.0}});
    EXPECT_NEAR(glm::distance(far.eye, far.target), 50.0f, 1e-3f);
}

TEST(Framing, OfAMeshFarFromTheOrigin) {
    // Map coordinates in metres: floats are half a metre apart there.
    const glm::vec3 low(500000.0f, 30.0f, 5000000.0f);
    const Camera camera = framed(scenes::box(low, low + glm::vec3(40.0f, 20.0f, 40.0f)));
    const Camera near = framed(scenes::box(glm::vec3(0.0f), glm::vec3(40.0f, 20.0f, 40.0f)));
    EXPECT_LT(glm::distance(glm::normalize(camera.eye - camera.target),
                            glm::normalize(near.eye - near.target)),
              0.01f);
    EXPECT_NEAR(glm::distance(camera.eye, camera.target), glm::distance(near.eye, near.target),
                1.0f);
    const auto has_direction = [](const mesh::TriangleMesh& mesh) {
        const Camera seen = framed(mesh);
        return glm::distance(seen.eye, seen.target) > 0.0f;
    };
    EXPECT_TRUE(has_direction(scenes::box(glm::vec3(1e9f), glm::vec3(1.0001e9f))));
    mesh::TriangleMesh point;
    point.positions = {{1, 2, 3}};
    EXPECT_TRUE(has_direction(point));
    EXPECT_TRUE(has_direction({}));
}

TEST(Framing, LooksAtWhatStandsOnTheGround) {
    const mesh::TriangleMesh sphere = scenes::icosphere(1, 1.0f, {2.0f, 1.5f, 3.0f});
    const Camera alone = framed(sphere);
    const Camera with_ground = framed(scenes::joined(scenes::floor_grid(5, 50.0f), sphere));
    EXPECT_LT(glm::distance(with_ground.eye, alone.eye), 1e-4f);
    EXPECT_LT(glm::distance(glm::normalize(with_ground.target - with_ground.eye),
                            glm::normalize(alone.target - alone.eye)),
              1e-5f);
    // A ground alone is looked at itself.
    const Camera ground = framed(scenes::floor_grid(5, 50.0f));
    EXPECT_LT(ground.target.y, ground.eye.y);
    EXPECT_GT(glm::length(ground.eye), 25.0f);
}

TEST(Framing, AGroundPlateOfTheFileDoesNotShrinkWhatStandsOnIt) {
    const mesh::TriangleMesh sphere = scenes::icosphere(2, 1.0f, {2.0f, 1.0f, 3.0f});
    const mesh::TriangleMesh plate =
        scenes::box(glm::vec3(-40.0f, -0.5f, -40.0f), glm::vec3(40.0f, 0.0f, 40.0f));
    const Camera alone = framed(sphere);
    const Camera on_plate = framed(scenes::joined(plate, sphere));
    EXPECT_LT(glm::distance(on_plate.eye, alone.eye),
              0.05f * glm::distance(alone.eye, alone.target));
    EXPECT_NEAR(subject_bounds(scenes::joined(plate, sphere)).size().x, 2.0f, 0.1f);
    // A pedestal is part of the object.
    const mesh::TriangleMesh pedestal =
        scenes::box(glm::vec3(0.8f, -0.02f, 1.8f), glm::vec3(3.2f, 0.0f, 4.2f));
    EXPECT_NEAR(subject_bounds(scenes::joined(pedestal, sphere)).size().x, 2.4f, 1e-4f);
}

/// A box whose faces look inwards, without its side at +Z if that is open.
mesh::TriangleMesh chamber(bool is_open) {
    mesh::TriangleMesh mesh =
        scenes::box(glm::vec3(-2.0f, 0.0f, -2.5f), glm::vec3(2.0f, 2.8f, 2.5f));
    std::erase_if(mesh.triangles, [&](const mesh::Triangle& triangle) {
        return is_open && std::all_of(triangle.begin(), triangle.end(),
                                      [&](std::uint32_t v) { return mesh.positions[v].z > 2.0f; });
    });
    for (mesh::Triangle& triangle : mesh.triangles)
        std::swap(triangle[1], triangle[2]);
    return mesh;
}

TEST(Framing, RoomsAreSeenFromInside) {
    for (const bool is_open : {false, true}) {
        const std::optional<Camera> camera = inside_room(chamber(is_open));
        ASSERT_TRUE(camera) << is_open;
        EXPECT_GT(camera->eye.y, 1.0f);
        EXPECT_LT(camera->eye.y, 2.0f);
        EXPECT_LT(glm::abs(camera->eye.x), 2.0f);
        EXPECT_LT(glm::abs(camera->eye.z), 2.5f);
        if (is_open) {
            EXPECT_GT(camera->eye.z, 2.0f) << "its back to the open side";
        }
    }
    EXPECT_FALSE(inside_room(scenes::box(glm::vec3(-2.0f), glm::vec3(2.0f))));
    // A chest: walls with two sides.
    EXPECT_FALSE(inside_room(scenes::joined(
        chamber(false), scenes::box(glm::vec3(-2.1f, -0.1f, -2.6f), glm::vec3(2.1f, 2.9f, 2.6f)))));
    EXPECT_FALSE(inside_room(scenes::icosphere(2, 1.0f, {0.0f, 1.0f, 0.0f})));
    EXPECT_FALSE(inside_room(scenes::floor_grid(5, 50.0f)));
    EXPECT_FALSE(inside_room({}));
}

TEST(Framing, AShelfIsSeenFromOutside) {
    mesh::TriangleMesh shelf =
        scenes::box(glm::vec3(-0.5f, 0.0f, -0.5f), glm::vec3(0.5f, 4.0f, 0.5f));
    std::erase_if(shelf.triangles, [&](const mesh::Triangle& triangle) {
        return std::all_of(triangle.begin(), triangle.end(),
                           [&](std::uint32_t v) { return shelf.positions[v].z == 0.5f; });
    });
    for (mesh::Triangle& triangle : shelf.triangles)
        std::swap(triangle[1], triangle[2]);
    EXPECT_TRUE(inside_room(shelf)) << "a high room";
    for (const float y : {1.0f, 2.0f, 3.0f})
        shelf = scenes::joined(
            shelf, scenes::box(glm::vec3(-0.5f, y - 0.02f, -0.5f), glm::vec3(0.5f, y, 0.5f)));
    EXPECT_FALSE(inside_room(shelf));
}

TEST(Framing, AnOpenSideIsSeenRatherThanAWall) {
    const auto side_of = [](const mesh::TriangleMesh& mesh) {
        const Camera camera = framed_from_open_side(mesh);
        return glm::normalize(camera.eye - camera.target);
    };
    // A stage in thick walls, open to one side.
    for (const glm::vec3& open :
         {glm::vec3(0, 0, 1), glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::vec3(-1, 0, 0)}) {
        mesh::TriangleMesh stage;
        for (const glm::vec3& wall :
             {glm::vec3(0, 0, 1), glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::vec3(-1, 0, 0),
              glm::vec3(0, 1, 0), glm::vec3(0, -1, 0)}) {
            if (wall == open)
                continue;
            const glm::vec3 low =
                glm::min(1.9f * wall, 2.0f * wall) - 2.0f * (glm::vec3(1.0f) - glm::abs(wall));
            const glm::vec3 high =
                glm::max(1.9f * wall, 2.0f * wall) + 2.0f * (glm::vec3(1.0f) - glm::abs(wall));
            stage = stage.positions.empty() ? scenes::box(low, high)
                                            : scenes::joined(stage, scenes::box(low, high));
        }
        EXPECT_GT(glm::dot(side_of(stage), open), 0.7f) << open.x << " " << open.z;
    }
    // All else is seen from where framed() stands, sheets from behind, too.
    mesh::TriangleMesh facade =
        scenes::box(glm::vec3(-2.0f, 0.0f, -1.0f), glm::vec3(2.0f, 3.0f, 1.0f));
    std::erase_if(facade.triangles, [&](const mesh::Triangle& triangle) {
        return std::all_of(triangle.begin(), triangle.end(),
                           [&](std::uint32_t v) { return facade.positions[v].z < 0.0f; });
    });
    for (const mesh::TriangleMesh& mesh :
         {scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f)), facade, scenes::floor_grid(5, 2.0f),
          scenes::icosphere(2, 1.0f, {0.0f, 1.0f, 0.0f}), mesh::TriangleMesh()})
        EXPECT_EQ(framed_from_open_side(mesh).eye, framed(mesh).eye);
}

} // namespace
} // namespace relumine::relight
