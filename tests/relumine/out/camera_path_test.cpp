#include "relumine/out/camera_path.h"

#include <random>
#include <stdexcept>
#include <string>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "files/output_file.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

CameraKey key_at(double frame, const glm::vec3& eye, float fov_degrees = 35.0f) {
    return {.frame = frame,
            .camera = Camera{.eye = eye, .target = glm::vec3(0.0f), .fov_degrees = fov_degrees}};
}

/// A way with uneven times and turns.
CameraPath winding() {
    return {.keys = {key_at(2, {0, 1, 4}, 30.0f), key_at(5, {3, 1, 2}, 50.0f),
                     key_at(15, {4, 2, -1}, 50.0f), key_at(16, {1, 2, -4}, 20.0f),
                     key_at(30, {-3, 1, -1}, 25.0f)},
            .names_fov = true};
}

TEST(CameraPath, GoesThroughItsKeysAndRestsOutsideOfThem) {
    const CameraPath path = winding();
    for (const CameraKey& key : path.keys) {
        const PlacedCamera camera = camera_at(path, key.frame);
        EXPECT_LT(glm::distance(camera.eye, key.camera.eye), 1e-6) << key.frame;
        EXPECT_FLOAT_EQ(camera.fov_degrees, key.camera.fov_degrees) << key.frame;
    }
    EXPECT_EQ(camera_at(path, 0.0), path.keys.front().camera);
    EXPECT_EQ(camera_at(path, 31.0), path.keys.back().camera);
    EXPECT_EQ(path.num_frames(), 31u);
    EXPECT_THROW(static_cast<void>(camera_at(CameraPath(), 0.0)), std::invalid_argument);
}

/// Between two keys the way is that of 3 t^2 - 2 t^3.
TEST(CameraPath, StartsAndStopsSoftly) {
    const CameraPath path{.keys = {key_at(0, {0, 0, 2}), key_at(8, {8, 0, 2})}};
    for (const double t : {0.125, 0.25, 0.5, 0.875})
        EXPECT_NEAR(camera_at(path, 8.0 * t).eye.x, 8.0 * t * t * (3.0 - 2.0 * t), 1e-5) << t;
}

/// The speed just before a key is that just after it.
TEST(CameraPath, PassesKeysWithoutAJerk) {
    const CameraPath path = winding();
    constexpr double Step = 2e-3;
    for (std::size_t i = 1; i + 1 < path.keys.size(); ++i) {
        const double frame = path.keys[i].frame;
        const glm::dvec3 here = camera_at(path, frame).eye;
        const glm::dvec3 before = here - camera_at(path, frame - Step).eye;
        const glm::dvec3 after = camera_at(path, frame + Step).eye - here;
        EXPECT_GT(glm::length(after), 1e-4) << i;
        EXPECT_LT(glm::length(after - before), 0.1 * glm::length(after)) << i;
    }
}

TEST(CameraPath, StandsStillBetweenKeysThatAreTheSame) {
    const CameraPath path{.keys = {key_at(0, {0, 0, 2}), key_at(4, {3, 0, 2}), key_at(9, {3, 0, 2}),
                                   key_at(12, {5, 1, 2})}};
    for (const double frame : {4.5, 6.0, 8.9})
        EXPECT_LT(glm::distance(camera_at(path, frame).eye, glm::dvec3(3, 0, 2)), 1e-6) << frame;
    EXPECT_GT(glm::distance(camera_at(path, 10.0).eye, glm::dvec3(3, 0, 2)), 0.1);
}

/// A slow way and then a fast one in the same direction: the camera never goes back.
TEST(CameraPath, DoesNotGoBackOnAStraightWay) {
    const CameraPath path{.keys = {key_at(0, {0, 0, 2}), key_at(20, {1, 0, 2}),
                                   key_at(21, {9, 0, 2}), key_at(40, {10, 0, 2})}};
    double last = -1e-6f;
    for (int i = 0; i <= 400; ++i) {
        const double x = camera_at(path, 0.1 * i).eye.x;
        EXPECT_GE(x, last - 1e-6) << i;
        last = x;
    }
}

TEST(CameraPath, KeepsTheFieldOfViewWithinItsKeys) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> fov(0.01f, 179.0f), gap(0.1f, 20.0f);
    CameraPath path{.names_fov = true};
    for (double frame = 0.0; path.keys.size() < 50; frame += gap(random))
        path.keys.push_back(key_at(frame, {0, 0, 2}, fov(random)));
    for (std::size_t i = 0; i + 1 < path.keys.size(); ++i) {
        const CameraKey &from = path.keys[i], &to = path.keys[i + 1];
        const float sign = to.camera.fov_degrees < from.camera.fov_degrees ? -1.0f : 1.0f;
        float last = from.camera.fov_degrees;
        for (int step = 1; step <= 20; ++step) {
            const double t = step / 20.0;
            const float now = camera_at(path, from.frame + t * (to.frame - from.frame)).fov_degrees;
            EXPECT_GE(sign * (now - last), -1e-4f) << i << " " << step;
            last = now;
        }
    }
}

/// The way does not depend on the axes: a path turned about +Y is the way turned.
TEST(CameraPath, TurnsWithItsKeys) {
    const auto turned = [](const glm::dvec3& point) {
        constexpr double Cosine = 0.6, Sine = 0.8;
        return glm::dvec3(Cosine * point.x + Sine * point.z, point.y,
                          Cosine * point.z - Sine * point.x);
    };
    const CameraPath path = winding();
    CameraPath other = path;
    for (CameraKey& key : other.keys)
        key.camera.eye = turned(key.camera.eye);
    for (double frame = 2.0; frame < 30.0; frame += 0.7)
        EXPECT_LT(glm::distance(camera_at(other, frame).eye, turned(camera_at(path, frame).eye)),
                  1e-5)
            << frame;
}

TEST(CameraPath, TellsWhereEyeAndTargetMeet) {
    CameraPath path{.keys = {key_at(0, {0, 0, 1}), key_at(2, {0, 0, -1})}};
    EXPECT_TRUE(has_direction(camera_at(path, 0.5)));
    EXPECT_FALSE(has_direction(camera_at(path, 1.0)));
}

class CameraPathFile : public scenes::InFolder {
protected:
    [[nodiscard]] CameraPath load(const std::string& text) const {
        files::save_text(file("path.json"), text);
        return load_camera_path(file("path.json"));
    }
    /// What is said of a file with these key frames.
    [[nodiscard]] std::string message(const std::string& frames) const {
        return tests::message_of(
            [&] { (void)load("{\"version\": 1,\n\"frames\": [" + frames + "]}"); });
    }
};

const std::string First = R"({"frame": 3, "eye": [0, 0, 4], "target": [0, 1, 0]})";

TEST_F(CameraPathFile, HasItsKeys) {
    const CameraPath path = load(R"({"version": 1, "frames": [
        {"frame": 0, "eye": [0, 1, 4], "target": [0, 0, 0], "fov_degrees": 40},
        {"frame": 7.5, "eye": [3, 1, 3], "target": [0, 0, 1]},
        {"frame": 9, "eye": [3, 1, 2], "target": [0, 0, 1], "fov_degrees": 20}]})");
    ASSERT_EQ(path.keys.size(), 3u);
    EXPECT_TRUE(path.names_fov);
    EXPECT_EQ(path.keys[1].frame, 7.5);
    EXPECT_EQ(path.keys[1].camera, (Camera{{3, 1, 3}, {0, 0, 1}, 40.0f}));
    EXPECT_EQ(path.keys[2].camera.fov_degrees, 20.0f);
    EXPECT_EQ(path.num_frames(), 10u);
    EXPECT_FALSE(load(R"({"version": 1, "frames": [)" + First +
                      R"(, {"frame": 4, "eye": [0, 0, 5], "target": [0, 1, 0]}]})")
                     .names_fov);
}

TEST_F(CameraPathFile, WhatIsWrongIsToldWithItsLine) {
    using testing::HasSubstr;
    const auto second = [](const std::string& members) {
        return First + ",\n{" + members + "}";
    };
    EXPECT_THAT(message(""), HasSubstr("path.json:2: expected at least 2 key frames, got 0"));
    EXPECT_THAT(message(First), HasSubstr("path.json:2: expected at least 2 key frames, got 1"));
    for (const char* frame : {"3", "1"})
        EXPECT_THAT(message(second(R"("eye": [0, 0, 4], "target": [0, 1, 0], "frame": )" +
                                   std::string(frame))),
                    HasSubstr("path.json:3: expected a frame after 3, got " + std::string(frame)));
    EXPECT_THAT(message(second(R"("frame": 5, "eye": [1, 2, 3], "target": [1, 2, 3])")),
                HasSubstr("path.json:3: expected a target other than the eye, got the same point"));
    EXPECT_THAT(message(second(R"("frame": 5, "eye": [1, 2], "target": [0, 0, 0])")),
                HasSubstr("path.json:3: expected \"eye\" of 3 numbers, got 2"));
    EXPECT_THAT(message(second(R"("frame": 5, "eye": [1e30, 2, 3], "target": [0, 0, 0])")),
                HasSubstr("path.json:3: expected \"eye\" within"));
    EXPECT_THAT(message(second(R"("frame": 1e6, "eye": [1, 2, 3], "target": [0, 0, 0])")),
                HasSubstr("path.json:3: expected \"frame\" from 0 to 99999"));
    EXPECT_THAT(
        message(second(R"("frame": 5, "eye": [1, 2, 3], "target": [0, 0, 0], "fov_degrees": 20)")),
        HasSubstr("path.json:3: expected \"fov_degrees\" at the first key frame, too"));
    EXPECT_THAT(message(R"({"frame": 5, "eye": [1, 2, 3], "target": [0, 0, 0], "fov_degrees": 0})"),
                HasSubstr("path.json:2: expected \"fov_degrees\" from 0.01 to 179, got 0"));
    EXPECT_THAT(message(second(R"("frame": 5, "eye": [1, 2, 3], "targt": [0, 0, 0])")),
                HasSubstr("\"targt\""));
    EXPECT_THROW(static_cast<void>(load(R"({"version": 2, "frames": []})")), std::runtime_error);
    EXPECT_THROW(static_cast<void>(load_camera_path(file("none.json"))), std::runtime_error);
}

} // namespace
} // namespace relumine
