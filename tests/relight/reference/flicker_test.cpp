#include "relight/reference/flicker.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lights/light_clusters.h"
#include "lights/place_lights.h"
#include "relight/pictures/array_file.h"
#include "relight/relighter.h"
#include "relight/sharp/shadow_rays.h"
#include "tests/lights/importance_lights.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

namespace fs = std::filesystem;
using RadianceFrames = std::vector<std::vector<glm::dvec3>>;

std::vector<glm::dvec3> grey(std::initializer_list<double> values) {
    std::vector<glm::dvec3> result;
    for (const double value : values)
        result.emplace_back(value);
    return result;
}

TEST(Flicker, HandWorkedValues) {
    const RadianceFrames reference = {grey({1.0, 2.0}), grey({1.5, 2.0}), grey({1.5, 1.0})};
    const RadianceFrames frames = {grey({1.2, 2.0}), grey({1.5, 2.4}), grey({1.5, 1.0})};
    const FlickerReport report = measure_flicker(frames, reference);
    ASSERT_EQ(report.inconsistency.size(), 2u);
    // t = 0: weights 1.2 and 1; dX - dX' = (-0.3 + 0.5, -0.4 - 0)
    EXPECT_NEAR(report.inconsistency[0], (1.2 * 0.2 + 1.0 * 0.4) / 2.0, 1e-12);
    // t = 1: weights 1 and 1.4; (0 - 0, 1.4 - 1)
    EXPECT_NEAR(report.inconsistency[1], (0.0 + 1.4 * 0.4) / 2.0, 1e-12);
    EXPECT_NEAR(report.mean_inconsistency, 0.5 * (0.32 + 0.28), 1e-12);
    EXPECT_NEAR(report.worst_inconsistency, 0.32, 1e-12);
    ASSERT_EQ(report.relative_l2.size(), 3u);
    EXPECT_NEAR(report.relative_l2[0], 0.2 / std::sqrt(5.0), 1e-12);
    EXPECT_NEAR(report.relative_l2[1], 0.4 / 2.5, 1e-12);
    EXPECT_EQ(report.relative_l2[2], 0.0);
    EXPECT_NEAR(report.mean_relative_l2, (0.2 / std::sqrt(5.0) + 0.16) / 3.0, 1e-12);
    // Exposure goes into the weight, too: all of t = 0 by hand at twice the light.
    EXPECT_NEAR(measure_flicker(frames, reference, 2.0).inconsistency[0],
                (1.4 * 0.4 + 1.0 * 0.8) / 2.0, 1e-12);
}

TEST(Flicker, OfColoursIsThatOfLuminance) {
    const RadianceFrames reference = {{glm::dvec3(0.0)}, {glm::dvec3(0.0)}};
    const RadianceFrames frames = {{glm::dvec3(0.0)}, {glm::dvec3(1.0, 2.0, 4.0)}};
    EXPECT_NEAR(measure_flicker(frames, reference).inconsistency[0],
                0.2125 + 2 * 0.7154 + 4 * 0.0721, 1e-12);
}

TEST(Flicker, AConstantErrorIsNoFlicker) {
    const RadianceFrames reference = {grey({1.0, 0.0}), grey({3.0, 2.0}), grey({0.5, 0.0})};
    RadianceFrames frames = reference;
    EXPECT_EQ(measure_flicker(frames, reference).mean_inconsistency, 0.0);
    for (auto& frame : frames)
        for (glm::dvec3& value : frame)
            value += 0.25;
    EXPECT_NEAR(measure_flicker(frames, reference).mean_inconsistency, 0.0, 1e-15);
    EXPECT_GT(measure_flicker(frames, reference).mean_relative_l2, 0.0);
    EXPECT_EQ(measure_flicker(RadianceFrames{reference[0]}, RadianceFrames{reference[0]})
                  .mean_inconsistency,
              0.0);
}

TEST(Flicker, BadFrames) {
    FlickerMeter meter;
    EXPECT_THROW(meter.add_frame(std::vector<glm::dvec3>{}, std::vector<glm::dvec3>{}),
                 std::invalid_argument);
    EXPECT_THROW(meter.add_frame(grey({1.0, 2.0}), grey({1.0})), std::invalid_argument);
    meter.add_frame(grey({1.0}), grey({1.0}));
    EXPECT_THROW(meter.add_frame(grey({1.0, 2.0}), grey({1.0, 2.0})), std::invalid_argument);
    EXPECT_THROW(meter.add_frame(grey({std::numeric_limits<double>::quiet_NaN()}), grey({1.0})),
                 std::invalid_argument);
    meter.add_frame(grey({1.5}), grey({1.0})); // as if the bad ones had not been there
    EXPECT_NEAR(meter.report().mean_inconsistency, 0.5, 1e-12);
    EXPECT_THROW(static_cast<void>(measure_flicker(RadianceFrames(2, grey({1.0})),
                                                   RadianceFrames(1, grey({1.0})))),
                 std::invalid_argument);
}

TEST(Flicker, OfFilesIsThatOfArrays) {
    const fs::path folder = fs::path(testing::TempDir()) / "relumine_flicker_test";
    fs::create_directories(folder);
    const std::vector<std::vector<glm::vec3>> frames = {{glm::vec3(1.0f), glm::vec3(0.5f)},
                                                        {glm::vec3(2.0f), glm::vec3(0.25f)}};
    std::vector<fs::path> a;
    std::vector<fs::path> b;
    for (std::size_t t = 0; t < 2; ++t) {
        a.push_back(folder / fmt::format("a{}.npy", t));
        b.push_back(folder / fmt::format("b{}.npy", t));
        save_npy(a[t], frames[t]);
        save_npy(b[t], frames[0]);
    }
    // weights 1: the frames begin equal
    EXPECT_NEAR(measure_flicker(a, b).mean_inconsistency, (1.0 + 0.25) / 2.0, 1e-7);
    // the same frames in one file, as [2 x 2 x 3]
    const fs::path both = folder / "both.npy";
    std::string description = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 3), }";
    std::ofstream file(both, std::ios::binary);
    file << std::string("\x93NUMPY\x01\x00", 8) << static_cast<char>(description.size()) << '\0'
         << description;
    for (const auto& frame : frames)
        file.write(reinterpret_cast<const char*>(frame.data()), static_cast<std::streamsize>(24));
    file.close();
    EXPECT_EQ(measure_flicker(std::vector{both}, b).inconsistency,
              measure_flicker(a, b).inconsistency);
    EXPECT_THROW(static_cast<void>(measure_flicker(std::vector{both}, std::vector{b[0]})),
                 std::runtime_error);
    EXPECT_THROW(static_cast<void>(measure_flicker(std::vector{a[0]}, std::vector{both})),
                 std::runtime_error);
    save_npy(b[1], std::vector<glm::vec3>(3));
    try {
        static_cast<void>(measure_flicker(a, b));
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("a1.npy: frame 1 against"),
                                                 testing::HasSubstr("expected 2 values")));
    }
    fs::remove_all(folder);
}

/// RadianceFrames of a method on the test scene, all receivers.
template<class Light>
RadianceFrames rendered(std::size_t num_frames, const Light& light) {
    RadianceFrames frames;
    for (std::size_t frame = 0; frame < num_frames; ++frame)
        frames.push_back(light(frame));
    return frames;
}

TEST(Flicker, NoneInALightThatStandsStill) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    const cubemap::CubeMap map = scenes::random_environment(16, 1);
    const lights::FrameImages still = [&](std::size_t) {
        return lights::lat_long_of(map);
    };
    std::vector<std::uint32_t> all(scene.receivers.positions.size());
    for (std::uint32_t i = 0; i < all.size(); ++i)
        all[i] = i;
    constexpr std::size_t NumFrames = 5;
    Relighter relighter(scene.transfer, scene.shadow_rays());
    const RadianceFrames transfer = rendered(NumFrames, [&](std::size_t) {
        relighter.set_environment(map);
        return std::vector<glm::dvec3>(relighter.radiance().begin(), relighter.radiance().end());
    });
    const lights::FrameLights lights = lights::frame_lights(lights::cluster_lights(
        lights::sample_frames(still, NumFrames, {.samples_per_frame = 64}), {.num_clusters = 32}));
    const RadianceFrames clusters = rendered(NumFrames, [&](std::size_t frame) {
        return radiance_under(lights.at(frame), scene.receivers.normals, all, scene.shadow_rays());
    });
    const lights::FrameLights jumping =
        lights::importance_lights(still, NumFrames, 32, {.seed_per_frame = true});
    const RadianceFrames importance = rendered(NumFrames, [&](std::size_t frame) {
        return radiance_under(jumping.at(frame), scene.receivers.normals, all, scene.shadow_rays());
    });
    // The reference may be any that stands still.
    const RadianceFrames reference(NumFrames, transfer[0]);
    EXPECT_EQ(measure_flicker(transfer, reference).mean_inconsistency, 0.0);
    EXPECT_EQ(measure_flicker(clusters, reference).mean_inconsistency, 0.0);
    EXPECT_GT(measure_flicker(importance, reference).mean_inconsistency, 1e-3);
}

} // namespace
} // namespace relumine::relight
