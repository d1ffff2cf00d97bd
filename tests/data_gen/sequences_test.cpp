#include "data_gen/sequences.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <gtest/gtest.h>

#include "data_gen/environments.h"

namespace relumine::data_gen {
namespace {

const Sequence& named(std::string_view name) {
    for (const Sequence& sequence : sequences())
        if (sequence.name == name)
            return sequence;
    throw std::out_of_range(std::string(name));
}

double disc_solid_angle(double radius_degrees) {
    return 2.0 * std::numbers::pi * (1.0 - std::cos(glm::radians(radius_degrees)));
}

TEST(Sequences, TheSunIsWhereItIsSaidToBe) {
    constexpr std::size_t NumFrames = 5;
    const FrameMaker make = named("sun").make({.num_frames = NumFrames, .face_resolution = 64});
    for (std::size_t frame = 0; frame < NumFrames; ++frame) {
        const cubemap::CubeMap map = make(frame);
        std::size_t brightest = 0;
        glm::dvec3 where(0.0);
        for (const cubemap::Face face : cubemap::AllFaces)
            for (std::uint32_t y = 0; y < 64; ++y)
                for (std::uint32_t x = 0; x < 64; ++x)
                    if (const std::size_t i = map.index(face, x, y);
                        map.texels[i].g > map.texels[brightest].g || i == 0) {
                        brightest = i;
                        where = cubemap::texel_direction(face, x, y, 64);
                    }
        const double cosine = glm::dot(where, cubemap::direction(sun_angles(frame, NumFrames)));
        EXPECT_LT(glm::degrees(std::acos(std::min(cosine, 1.0))), 1.3) << frame; // within a texel
    }
    EXPECT_DOUBLE_EQ(sun_angles(0, NumFrames).azimuth_degrees, 100.0);
    EXPECT_DOUBLE_EQ(sun_angles(4, NumFrames).azimuth_degrees, -100.0);
    EXPECT_NEAR(sun_angles(2, NumFrames).elevation_degrees, 62.0, 1e-9);
    EXPECT_NEAR(sun_angles(1, NumFrames).elevation_degrees,
                sun_angles(3, NumFrames).elevation_degrees, 1e-9);
}

TEST(Sequences, TurnIsTheProbeRotated) {
    const cubemap::CubeMap probe = two_soft_boxes(16);
    const FrameMaker make = named("turn").make({.num_frames = 8, .probe = probe});
    EXPECT_EQ(make(0).texels, probe.texels);
    EXPECT_EQ(make(3).texels, cubemap::rotated(probe, 135.0).texels);
    EXPECT_EQ(make(2).texels, cubemap::rotated(probe, 90.0).texels);
    EXPECT_THROW(named("turn").make({.num_frames = 8}), std::invalid_argument);
}

TEST(Sequences, TheSwitchedLightAddsItsPower) {
    const SwitchedLight light;
    const FrameMaker make = named("switch").make({.num_frames = 7, .face_resolution = 32});
    EXPECT_EQ(make(0).texels, make(2).texels);
    EXPECT_EQ(make(3).texels, make(6).texels);
    const glm::dvec3 before = cubemap::total_power(make(2));
    const glm::dvec3 after = cubemap::total_power(make(3));
    EXPECT_NEAR(before.r, 4.0 * std::numbers::pi * static_cast<double>(light.background), 1e-5);
    const double solid_angle = disc_solid_angle(light.radius_degrees);
    for (int channel = 0; channel < 3; ++channel) {
        const double expected = static_cast<double>(light.radiance[channel]) * solid_angle;
        EXPECT_NEAR(after[channel] - before[channel], expected, 2e-3 * expected);
    }
}

TEST(Sequences, CloudsMoveWithTheWind) {
    double least = 1.0;
    double most = 0.0;
    double sum = 0.0;
    int count = 0;
    for (double x = -3.0; x <= 3.0; x += 0.31)
        for (double z = -3.0; z <= 3.0; z += 0.31) {
            const glm::dvec3 above(x, 1.0, z);
            const double cover = cloud_cover(glm::normalize(above), 0.0);
            // What is here now is 10 frames of wind further in 10 frames; near the zenith nothing
            // fades.
            const glm::dvec3 later = glm::normalize(above + 10.0 * CloudWind);
            EXPECT_NEAR(cloud_cover(later, 10.0), cover, 1e-9);
            least = std::min(least, cover);
            most = std::max(most, cover);
            sum += cover;
            ++count;
        }
    EXPECT_EQ(least, 0.0);
    EXPECT_EQ(most, 1.0);
    EXPECT_GT(sum / count, 0.2);
    EXPECT_LT(sum / count, 0.8);
    EXPECT_EQ(cloud_cover({0.3, -0.1, 0.2}, 3.0), 0.0);
}

TEST(Sequences, CloudsDimTheSunAsTheySay) {
    const FrameMaker make = named("clouds").make({.num_frames = 100, .face_resolution = 32});
    // Frames of a clear and of a hidden sun; the power of the texel it is in tells.
    std::size_t clear = 0;
    std::size_t hidden = 0;
    for (std::size_t frame = 0; frame < 100; ++frame) {
        if (cloud_transmission(static_cast<double>(frame)) >
            cloud_transmission(static_cast<double>(clear)))
            clear = frame;
        if (cloud_transmission(static_cast<double>(frame)) <
            cloud_transmission(static_cast<double>(hidden)))
            hidden = frame;
    }
    const double difference = cloud_transmission(static_cast<double>(clear)) -
                              cloud_transmission(static_cast<double>(hidden));
    ASSERT_GT(difference, 0.5) << "the sun comes and goes within 100 frames";
    const auto brightest = [](const cubemap::CubeMap& map) {
        float value = 0.0f;
        for (const glm::vec3& texel : map.texels)
            value = std::max(value, texel.g);
        return value;
    };
    EXPECT_GT(brightest(make(clear)), 10.0f * brightest(make(hidden)));
    for (const glm::vec3& texel : make(hidden).texels)
        ASSERT_TRUE(texel.r >= 0.0f && texel.g >= 0.0f && texel.b >= 0.0f &&
                    std::isfinite(texel.r));
}

TEST(Sequences, TheTunnelHasThePowerOfItsLampsAndRepeats) {
    const FrameMaker make = named("tunnel").make({.num_frames = 60, .face_resolution = 64});
    EXPECT_EQ(make(5).texels, make(5 + TunnelPeriod).texels);
    EXPECT_NE(make(5).texels, make(6).texels);
    for (const std::size_t frame : {0u, 7u, 12u, 23u}) {
        double expected = 4.0 * std::numbers::pi * static_cast<double>(TunnelWalls);
        for (const TunnelLamp& lamp : tunnel_lamps(frame))
            expected +=
                static_cast<double>(lamp.radiance.r) * disc_solid_angle(lamp.radius_degrees);
        EXPECT_NEAR(cubemap::total_power(make(frame)).r, expected, 2e-3 * expected) << frame;
    }
    // One period takes every lamp to the place of the one behind it: nothing jumps between the last
    // frame and the next first.
    const double last = cubemap::total_power(make(TunnelPeriod - 1)).r;
    EXPECT_NEAR(last, cubemap::total_power(make(TunnelPeriod)).r, 0.05 * last);
}

TEST(Sequences, BadOptionsAreRefused) {
    for (const Sequence& sequence : sequences()) {
        const cubemap::CubeMap probe(4, glm::vec3(1.0f));
        EXPECT_THROW(sequence.make({.num_frames = 0, .face_resolution = 4, .probe = probe}),
                     std::invalid_argument);
        for (const std::uint32_t resolution : {0u, 16385u})
            EXPECT_THROW(
                sequence.make({.num_frames = 2, .face_resolution = resolution, .probe = probe}),
                std::invalid_argument);
    }
}

} // namespace
} // namespace relumine::data_gen
