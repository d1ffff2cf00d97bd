// Frames of a sequence: updates of what changed, and views and arrays for many frames.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relight/binned_environment.h"
#include "relight/pictures/array_file.h"
#include "relight/relighter.h"
#include "tests/relight/arrays.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

using scenes::relit_scene;

class Frames : public testing::Test {
protected:
    Frames() = default;
    explicit Frames(const ShadowRays& rays)
        : relighter_(relit_scene().transfer, rays),
          binner_(relit_scene().transfer, rays.tolerance) {}

    UpdateReport show(cubemap::CubeMap map) {
        return relighter_.set_frame(binner_.bin(std::move(map)));
    }
    [[nodiscard]] std::vector<glm::vec3> afresh(const cubemap::CubeMap& map) const {
        return relight(relit_scene().transfer, map, relighter_.shadow_rays());
    }

    Relighter relighter_{relit_scene().transfer};
    EnvironmentBinner binner_{relit_scene().transfer, 0.0f};
};

class TracedFrames : public Frames {
protected:
    TracedFrames() : Frames(relit_scene().shadow_rays()) {}
};

/// A bright texel, moving, over a dim background.
cubemap::CubeMap spot_map(std::uint32_t frame) {
    cubemap::CubeMap map(64, glm::vec3(0.2f, 0.3f, 0.4f));
    map.at(cubemap::Face::PositiveY, 20 + frame, 30) = glm::vec3(3000.0f, 2000.0f, 1000.0f);
    return map;
}

TEST_F(Frames, TheFirstIsAFullRelighting) {
    const cubemap::CubeMap map = scenes::random_environment(32, 3);
    const UpdateReport report = show(map);
    EXPECT_TRUE(report.resummed);
    EXPECT_EQ(report.num_clusters, relit_scene().transfer.num_clusters());
    EXPECT_EQ(copy(relighter_.radiance()), afresh(map));
    EXPECT_EQ(relighter_.environment().texels, map.texels);
}

TEST_F(Frames, AStillFrameCostsNothingAndChangesNoBit) {
    const cubemap::CubeMap map = scenes::random_environment(32, 3);
    show(map);
    const std::vector<glm::vec3> before = copy(relighter_.radiance());
    const UpdateReport report = show(map);
    EXPECT_EQ(report.num_clusters, 0u);
    EXPECT_EQ(report.num_receivers, 0u);
    EXPECT_FALSE(report.resummed);
    EXPECT_EQ(copy(relighter_.radiance()), before);
}

TEST_F(Frames, AFewChangedClustersAreUpdated) {
    cubemap::CubeMap map = scenes::random_environment(64, 2);
    show(map);
    for (std::uint32_t frame = 0; frame < 20; ++frame) {
        map.at(cubemap::Face::PositiveY, 10 + frame, 20) = glm::vec3(80.0f, 20.0f, 0.0f);
        map.at(cubemap::Face::PositiveX, 40, 2 * frame) = glm::vec3(0.0f);
        const UpdateReport report = show(map);
        EXPECT_GT(report.num_clusters, 0u);
        EXPECT_LT(report.num_clusters, 10u);
        EXPECT_FALSE(report.resummed);
    }
    scenes::expect_close(relighter_.radiance(), afresh(map), 1e-5);
}

TEST_F(Frames, WhenMostClustersChangeAllAreSummed) {
    show(scenes::random_environment(32, 1));
    const cubemap::CubeMap map = scenes::random_environment(64, 2); // another resolution, too
    EXPECT_TRUE(show(map).resummed);
    EXPECT_EQ(copy(relighter_.radiance()), afresh(map));
}

TEST_F(TracedFrames, AMovingSunIsTracedAnew) {
    show(spot_map(0));
    ASSERT_FALSE(relighter_.sharp_lights().empty());
    for (std::uint32_t frame = 1; frame < 20; ++frame) {
        const UpdateReport report = show(spot_map(frame));
        EXPECT_GT(report.num_sharp_lights, 0u);
        EXPECT_FALSE(report.resummed);
        EXPECT_LT(report.num_clusters, 20u);
    }
    scenes::expect_close(relighter_.radiance(), afresh(spot_map(19)), 1e-5);
    EXPECT_EQ(show(spot_map(19)).num_sharp_lights, 0u) << "nothing moved";
    show(cubemap::CubeMap(64, glm::vec3(0.2f, 0.3f, 0.4f))); // and it sets
    EXPECT_TRUE(relighter_.sharp_lights().empty());
    scenes::expect_close(relighter_.radiance(),
                         afresh(cubemap::CubeMap(64, glm::vec3(0.2f, 0.3f, 0.4f))), 1e-5);
}

TEST_F(TracedFrames, ASunThatDimsLeavesItsClusterWhole) {
    show(spot_map(0));
    for (int frame = 1; frame <= 10; ++frame) {
        cubemap::CubeMap map = spot_map(0);
        map.at(cubemap::Face::PositiveY, 20, 30) *= 1.0f - 0.03f * static_cast<float>(frame);
        show(map);
        scenes::expect_close(relighter_.radiance(), afresh(map), 1e-5);
    }
}

TEST_F(TracedFrames, LightListsAndRegionUpdatesMayComeBetween) {
    const lights::DistantLight light{.direction = {0.0, 1.0, 0.0}, .irradiance = glm::dvec3(2.0)};
    show(spot_map(0));
    relighter_.set_lights({&light, 1});
    EXPECT_TRUE(show(spot_map(1)).resummed);
    EXPECT_EQ(copy(relighter_.radiance()), afresh(spot_map(1)));

    const std::vector<glm::vec3> patch(4, glm::vec3(5.0f));
    cubemap::CubeMap map = spot_map(1);
    update_region(relighter_,
                  {.face = cubemap::Face::PositiveX, .x0 = 8, .y0 = 8, .x1 = 10, .y1 = 10}, patch);
    show(spot_map(1)); // takes it away again
    scenes::expect_close(relighter_.radiance(), afresh(map), 1e-5);
}

TEST_F(Frames, AnUpdateLeavesTheFrameThatOthersKeep) {
    const cubemap::CubeMap map = scenes::random_environment(16, 2);
    const BinnedEnvironment kept = binner_.bin(map);
    relighter_.set_frame(kept);
    EXPECT_EQ(&relighter_.environment(), kept.map.get()) << "shared";
    const std::vector<glm::vec3> before = copy(relighter_.radiance());
    const std::vector<glm::vec3> patch(4, glm::vec3(50.0f));
    for (const std::uint32_t x : {2u, 8u})
        update_region(relighter_,
                      {.face = cubemap::Face::PositiveX, .x0 = x, .y0 = 8, .x1 = x + 2, .y1 = 10},
                      patch);
    EXPECT_EQ(kept.map->texels, map.texels);
    EXPECT_EQ(relighter_.environment().at(cubemap::Face::PositiveX, 2, 8), patch[0]);
    EXPECT_EQ(relighter_.environment().at(cubemap::Face::PositiveX, 8, 8), patch[0]);
    EXPECT_NE(copy(relighter_.radiance()), before);
    relighter_.set_frame(kept);
    scenes::expect_close(relighter_.radiance(), before, 1e-5);
}

TEST_F(Frames, WhatDoesNotFitIsRefused) {
    const cubemap::CubeMap map = scenes::random_environment(16, 2);
    show(map);
    const std::vector<glm::vec3> before = copy(relighter_.radiance());
    EXPECT_THROW(relighter_.set_frame({}), std::invalid_argument);
    BinnedEnvironment other = binner_.bin(map);
    other.sums.pop_back();
    EXPECT_THROW(relighter_.set_frame(other), std::invalid_argument);
    other = binner_.bin(map);
    other.map.reset();
    EXPECT_THROW(relighter_.set_frame(other), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(binner_.bin(cubemap::CubeMap())), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(binner_.bin(nullptr)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(binner_.bin(cubemap::CubeMap(4, glm::vec3(-1.0f)))),
                 std::invalid_argument);
    EXPECT_EQ(copy(relighter_.radiance()), before);
}

TEST(NpyFrames, AreTheFramesOneAfterTheOther) {
    const std::string path = testing::TempDir() + "relumine-frames.npy";
    const std::vector<glm::vec3> first = {{1, 2, 3}, {4, 5, 6}};
    const std::vector<glm::vec3> second = {{7, 8, 9}, {10, 11, 12}};
    const auto content = [&] {
        std::ifstream file(path, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    std::remove(path.c_str());
    {
        NpyFrames frames(path, 2, 2);
        frames.append(first);
        EXPECT_THROW(frames.commit(), std::invalid_argument);
        EXPECT_THROW(frames.append({}), std::invalid_argument);
    }
    EXPECT_FALSE(std::ifstream(path)) << "a part of the frames is no file";
    NpyFrames frames(path, 2, 2);
    frames.append(first);
    frames.append(second);
    EXPECT_THROW(frames.append(second), std::invalid_argument);
    frames.commit();
    const std::string bytes = content();
    ASSERT_EQ(bytes.size() % 64, 48u); // 12 floats after a header of whole 64 bytes
    EXPECT_NE(bytes.find("'shape': (2, 2, 3)"), std::string::npos);
    std::vector<float> values(12);
    std::memcpy(values.data(), bytes.data() + bytes.size() - 48, 48);
    for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_EQ(values[i], static_cast<float>(i + 1));
    std::remove(path.c_str());
}

} // namespace
} // namespace relumine::relight
