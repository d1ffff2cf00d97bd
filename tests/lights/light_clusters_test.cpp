#include "lights/light_clusters.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/lights/importance_lights.h"
#include "tests/lights/test_maps.h"

namespace relumine::lights {
namespace {

/// A sun of one pixel that moves around the map's edge at one pixel a frame, over a dim sky.
FrameImages moving_sun(std::uint32_t width = 64) {
    return [=](std::size_t frame) {
        const auto sun = static_cast<std::uint32_t>((width - 5 + frame) % width);
        return lat_long(width, width / 2, [&](std::uint32_t x, std::uint32_t y) {
            return x == sun && y == width / 8
                       ? glm::vec3(500.0f, 450.0f, 300.0f)
                       : glm::vec3(0.2f, 0.3f, 0.5f) / (1.0f + static_cast<float>(y));
        });
    };
}

FrameSample sample(const glm::dvec3& direction, std::uint32_t frame, double strength = 1.0) {
    return {.direction = glm::normalize(direction),
            .irradiance = glm::dvec3(strength, 0.5 * strength, 2.0 * strength),
            .solid_angle = 0.01,
            .luminance = 100.0,
            .frame = frame};
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(a[channel], b[channel], tolerance) << channel;
}

constexpr std::array AllStrengths = {StrengthOptions{},
                                     StrengthOptions{.strength = Strength::Even, .fade = 3},
                                     StrengthOptions{.strength = Strength::Even, .fade = 50},
                                     StrengthOptions{.strength = Strength::Followed},
                                     StrengthOptions{.strength = Strength::Followed, .fade = 2}};

TEST(FrameSamples, AddUpToTheirFrame) {
    const FrameImages images = [](std::size_t frame) {
        return wild(32, 16, static_cast<unsigned>(frame) + 1);
    };
    const FrameSamples samples = sample_frames(images, 4, {.samples_per_frame = 100});
    for (std::uint32_t frame = 0; frame < 4; ++frame) {
        std::vector<FrameSample> of_frame;
        for (const FrameSample& s : samples.samples)
            if (s.frame == frame)
                of_frame.push_back(s);
        EXPECT_EQ(of_frame.size(), 100u);
        const glm::dvec3 expected = power(images(frame));
        expect_near(total_irradiance(of_frame), expected, 1e-9 * expected.r);
    }
}

TEST(FrameSamples, LuminanceIsTheMapsWhereTheSampleStands) {
    const FrameSamples samples = sample_frames(moving_sun(), 3, {.samples_per_frame = 50});
    const LatLongGrid grid(moving_sun()(0));
    for (const FrameSample& s : samples.samples) {
        const auto image = moving_sun()(s.frame);
        const double across = std::atan2(s.direction.x, s.direction.z); // the left edge is +pi
        const auto x =
            static_cast<std::size_t>((0.5 - 0.5 * across / std::numbers::pi) * 64.0) % 64;
        const auto y = static_cast<std::size_t>(std::acos(s.direction.y) / std::numbers::pi * 32.0);
        EXPECT_DOUBLE_EQ(s.luminance, luminance(image.pixels[y * 64 + x]));
    }
}

TEST(FrameSamples, SeedsAndStrata) {
    const FrameImages still = [](std::size_t) {
        return wild(32, 16);
    };
    const auto directions = [&](const FrameSamplesOptions& options) {
        std::vector<std::vector<glm::dvec3>> result(2);
        for (const FrameSample& s : sample_frames(still, 2, options).samples)
            result[s.frame].push_back(s.direction);
        return result;
    };
    const auto same = directions({.samples_per_frame = 20});
    EXPECT_EQ(same[0], same[1]);
    const auto other = directions({.samples_per_frame = 20, .seed_per_frame = true});
    EXPECT_NE(other[0], other[1]);
    // Independent samples: the right luminance in sum, equal for each; the right direction on
    // average.
    const FrameSamples independent =
        sample_frames(still, 1, {.samples_per_frame = 512, .seed = 3, .stratified = false});
    const glm::dvec3 expected = power(still(0));
    EXPECT_NEAR(luminance(total_irradiance(independent.samples)), luminance(expected),
                1e-9 * luminance(expected));
    for (const FrameSample& s : independent.samples)
        EXPECT_NEAR(luminance(s.irradiance), luminance(expected) / 512.0,
                    1e-9 * luminance(expected));
    EXPECT_NEAR(total_irradiance(independent.samples).r, expected.r, 0.2 * expected.r);
}

TEST(FrameSamples, BadFramesAndBlackOnes) {
    const FrameImages bad = [](std::size_t frame) {
        return constant(8, 4,
                        glm::vec3(frame == 2 ? std::numeric_limits<float>::quiet_NaN() : 1.0f));
    };
    try {
        static_cast<void>(sample_frames(bad, 4, {.samples_per_frame = 4}));
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("frame 2: expected radiance that is finite"));
    }
    EXPECT_THROW(static_cast<void>(sample_frames(bad, 1, {.samples_per_frame = 0})),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(sample_frames(bad, 1, {.samples_per_frame = 33})),
                 std::invalid_argument);

    const FrameImages black = [](std::size_t) {
        return constant(8, 4, glm::vec3(0.0f));
    };
    const LightClusters none = cluster_lights(sample_frames(black, 3, {.samples_per_frame = 4}));
    EXPECT_TRUE(none.clusters.empty());
    EXPECT_EQ(frame_lights(none).num_frames(), 3u);
}

TEST(LightClusters, SunsEitherSideOfTheSeamAreOneCluster) {
    // One pixel from either edge of the map, and a far one between them in texel space.
    const FrameImages images = [](std::size_t frame) {
        const std::uint32_t sun = frame == 0 ? 0 : 63;
        return lat_long(64, 32, [&](std::uint32_t x, std::uint32_t y) {
            return glm::vec3(y == 12 && (x == sun || x == 32) ? 100.0f : 0.0f);
        });
    };
    const LightClusters clusters =
        cluster_lights(sample_frames(images, 2, {.samples_per_frame = 64}), {.num_clusters = 2});
    ASSERT_EQ(clusters.clusters.size(), 2u);
    const LightCluster& seam =
        clusters.clusters[0].light.direction.z < 0.0 ? clusters.clusters[0] : clusters.clusters[1];
    EXPECT_NEAR(seam.light.direction.x, 0.0, 0.02);
    EXPECT_LT(seam.light.direction.z, -0.9);
    EXPECT_EQ(seam.num_samples, 64u); // half of each frame's
    EXPECT_EQ(seam.num_frames(), 2u);
}

TEST(LightClusters, ALightOfASingleFrame) {
    // [S, Eq. 8]: without the + 1 its radiance would be infinite.
    FrameSamples samples{.num_frames = 6, .samples = {}};
    for (std::uint32_t frame = 0; frame < 6; ++frame) {
        samples.samples.push_back(sample({0, 1, 0}, frame));
        if (frame == 3) {
            samples.samples.push_back(sample({1, 0, 0}, frame, 5.0));
            samples.samples.push_back(sample({1, 0, 0.002}, frame, 3.0));
        }
    }
    const LightClusters clusters = cluster_lights(samples, {.num_clusters = 2, .seed = 4});
    ASSERT_EQ(clusters.clusters.size(), 2u);
    for (const LightCluster& cluster : clusters.clusters) {
        const bool flash = cluster.light.direction.x > 0.5;
        EXPECT_EQ(cluster.first_frame, flash ? 3u : 0u);
        EXPECT_EQ(cluster.last_frame, flash ? 3u : 5u);
        expect_near(cluster.light.irradiance, (flash ? 8.0 : 1.0) * glm::dvec3(1.0, 0.5, 2.0),
                    1e-12);
        EXPECT_NEAR(cluster.light.solid_angle, flash ? 0.02 : 0.01, 1e-12);
        EXPECT_NEAR(glm::length(cluster.light.direction), 1.0, 1e-12);
    }
    EXPECT_NEAR(clusters.mean_live(), 7.0 / 6.0, 1e-12);
    const FrameLights lights = frame_lights(clusters);
    EXPECT_EQ(lights.at(2).size(), 1u);
    EXPECT_EQ(lights.at(3).size(), 2u);
}

TEST(LightClusters, OneLightAtConstantSpeed) {
    // One sample a frame on the horizon, one degree further each time, 60 frames into 6 clusters.
    // Each is a run of frames, and its light stands over the middle of the run.
    FrameSamples samples{.num_frames = 60, .samples = {}};
    for (std::uint32_t frame = 0; frame < 60; ++frame) {
        const double angle = frame * std::numbers::pi / 180.0;
        samples.samples.push_back(sample({std::sin(angle), 0.0, std::cos(angle)}, frame));
    }
    const LightClusters clusters = cluster_lights(samples, {.num_clusters = 6});
    EXPECT_NEAR(clusters.mean_live(), 1.0, 1e-12); // the spans do not overlap and leave no gap
    for (const LightCluster& cluster : clusters.clusters) {
        EXPECT_EQ(cluster.num_samples, cluster.num_frames());
        const double middle =
            0.5 * (cluster.first_frame + cluster.last_frame) * std::numbers::pi / 180.0;
        expect_near(cluster.light.direction, {std::sin(middle), 0.0, std::cos(middle)}, 1e-12);
        expect_near(cluster.light.irradiance, {1.0, 0.5, 2.0}, 1e-12);
    }
}

TEST(LightClusters, LightOverAllFramesIsThatOfTheSamples) {
    const FrameSamples samples = sample_frames(moving_sun(), 30, {.samples_per_frame = 128});
    const glm::dvec3 expected = total_irradiance(samples.samples);
    const LightClusters clusters = cluster_lights(samples, {.num_clusters = 60});
    for (const StrengthOptions& strength : AllStrengths)
        expect_near(total_irradiance(frame_lights(clusters, strength)), expected,
                    1e-9 * expected.r);
}

TEST(LightClusters, FollowedLightsHaveThePowerOfEachFrame) {
    const FrameImages images = [](std::size_t frame) { // brightens by half
        return constant(32, 16,
                        glm::vec3(1.0f, 2.0f, 0.5f) * (1.0f + 0.05f * static_cast<float>(frame)));
    };
    const LightClusters clusters =
        cluster_lights(sample_frames(images, 11, {.samples_per_frame = 64}), {.num_clusters = 30});
    const FrameLights lights = frame_lights(clusters, {.strength = Strength::Followed});
    for (std::size_t frame = 0; frame < 11; ++frame)
        expect_near(total_irradiance(lights.frames[frame]), power(images(frame)), 1e-6);
}

TEST(LightClusters, FadesComeAndGoSmoothly) {
    // One light in frames 10 to 19 of 30, at strength 1. A fade of 1 has the kernel 1/4, 1/2, 1/4.
    FrameSamples samples{.num_frames = 30, .samples = {}};
    for (std::uint32_t frame = 10; frame < 20; ++frame)
        samples.samples.push_back(sample({0, 1, 0}, frame));
    const LightClusters clusters = cluster_lights(samples, {.num_clusters = 1});
    const FrameLights lights = frame_lights(clusters, {.fade = 1});
    EXPECT_TRUE(lights.at(8).empty());
    EXPECT_NEAR(lights.at(9)[0].irradiance.r, 0.25, 1e-12);
    EXPECT_NEAR(lights.at(10)[0].irradiance.r, 0.75, 1e-12);
    EXPECT_NEAR(lights.at(11)[0].irradiance.r, 1.0, 1e-12);
    EXPECT_NEAR(lights.at(20)[0].irradiance.b, 0.5, 1e-12);
    EXPECT_NEAR(lights.at(20)[0].solid_angle, 0.0025, 1e-12);
    EXPECT_TRUE(lights.at(21).empty());
}

TEST(LightClusters, LightThatStandsStillStandsStill) {
    // Of 40 equal frames every light lives in all, at one strength, whatever gamma is.
    const FrameImages still = [](std::size_t) {
        return wild(32, 16);
    };
    const FrameSamples samples = sample_frames(still, 40, {.samples_per_frame = 100});
    for (const double gamma : {0.0, 1.0, 100.0}) {
        const LightClusters clusters =
            cluster_lights(samples, {.num_clusters = 64, .weights = {.time = gamma}});
        for (const StrengthOptions& strength : {StrengthOptions{.strength = Strength::Even},
                                                StrengthOptions{.strength = Strength::Followed}}) {
            const FrameLights lights = frame_lights(clusters, strength);
            ASSERT_GT(lights.at(0).size(), 40u);
            for (std::size_t frame = 1; frame < 40; ++frame) {
                ASSERT_EQ(lights.at(frame).size(), lights.at(0).size());
                for (std::size_t i = 0; i < lights.at(0).size(); ++i) {
                    EXPECT_EQ(lights.at(frame)[i].direction, lights.at(0)[i].direction);
                    EXPECT_EQ(lights.at(frame)[i].irradiance, lights.at(0)[i].irradiance);
                }
            }
        }
    }
}

TEST(LightClusters, AFrameShownTwiceChangesNothing) {
    const FrameImages sun = moving_sun();
    const FrameImages slow = [&](std::size_t frame) {
        return sun(frame / 2);
    };
    const LightClusters once =
        cluster_lights(sample_frames(sun, 12, {.samples_per_frame = 64}), {.num_clusters = 1});
    const LightClusters twice =
        cluster_lights(sample_frames(slow, 24, {.samples_per_frame = 64}), {.num_clusters = 1});
    EXPECT_NEAR(once.k_means.centres[0].time, twice.k_means.centres[0].time, 1e-12);
    EXPECT_NEAR(2.0 * once.k_means.objective[0], twice.k_means.objective[0],
                0.05 * twice.k_means.objective[0]);
    expect_near(once.clusters[0].light.irradiance, twice.clusters[0].light.irradiance, 1e-9);
}

TEST(ImportanceLights, AreThoseOfEachFrame) {
    const FrameLights lights = importance_lights(moving_sun(), 5, 20, {.seed = 2});
    ASSERT_EQ(lights.num_frames(), 5u);
    for (std::size_t frame = 0; frame < 5; ++frame) {
        EXPECT_EQ(lights.at(frame).size(), 20u);
        const glm::dvec3 expected = power(moving_sun()(frame));
        expect_near(total_irradiance(lights.frames[frame]), expected, 1e-9 * expected.r);
    }
}

} // namespace
} // namespace relumine::lights
