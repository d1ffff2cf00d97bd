#include "cubemap/doctor/clipped_sun.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

const glm::dvec3 ToSun = glm::normalize(glm::dvec3(0.5, 0.6, 0.4));

/// Luminance of a sky with an aureole and a sun, over a dark ground.
EnvironmentImage sunny(float sun, float clip) {
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 512);
    paint(image, [&](const glm::dvec3& w) {
        const double degrees = std::acos(std::clamp(glm::dot(w, ToSun), -1.0, 1.0)) * 57.29578;
        const double aureole = 20.0 * std::exp(-degrees / 1.5) + 3.0 * std::exp(-degrees / 6.0);
        const double value = (w.y > 0.0 ? 1.0 + aureole : 0.2) + (degrees < 0.4 ? sun : 0.0);
        return glm::vec3(std::min(static_cast<float>(value), clip));
    });
    return image;
}

std::optional<ClippedSun> check(const EnvironmentImage& image) {
    return clipped_sun(image, find_sun(image), statistics(image));
}

TEST(ClippedSun, AWholeSunIsNone) {
    for (const float sun : {2e4f, 5e4f, 1e5f})
        EXPECT_FALSE(check(sunny(sun, 1e6f))) << sun;
}

TEST(ClippedSun, ClippedAtAnyLevelIsFound) {
    for (const float clip : {5.0f, 10.0f, 16.0f, 50.0f, 200.0f, 1000.0f}) {
        const auto found = check(sunny(1e5f, clip));
        ASSERT_TRUE(found) << clip;
        EXPECT_LT(glm::distance(found->direction, ToSun), 0.07) << clip; // 4 degrees
        EXPECT_NE(found->why, "");
    }
}

TEST(ClippedSun, LargestHalfAndInfinity) {
    const auto half = check(sunny(1e5f, 65504.0f));
    ASSERT_TRUE(half);
    EXPECT_NE(half->why.find("65504"), std::string::npos);
    EnvironmentImage image = sunny(1e4f, 1e6f);
    image.bad_pixels.num_infinite = 3; // as loaded with its infinite pixels fixed
    ASSERT_TRUE(check(image));
    EXPECT_NE(check(image)->why.find('3'), std::string::npos);
}

TEST(ClippedSun, NoneInOtherMaps) {
    const EnvironmentImage black = black_image(Layout::LatLong, Sampling::TexelCentres, 128);
    EXPECT_FALSE(check(black));
    EnvironmentImage image = black;
    paint(image, [](const glm::dvec3&) { return glm::vec3(1.0f); });
    EXPECT_FALSE(check(image)) << "constant";
    paint(image, [](const glm::dvec3& w) { return glm::vec3(static_cast<float>(1.2 + w.y)); });
    EXPECT_FALSE(check(image)) << "overcast";
    paint(image, [](const glm::dvec3& w) { return glm::vec3(w.x > 0.9 ? 50.0f : 0.5f); });
    EXPECT_FALSE(check(image)) << "a window of even brightness";
    paint(image, [](const glm::dvec3& w) { return glm::vec3(w.x > 0.998 ? 500.0f : 0.0f); });
    EXPECT_FALSE(check(image)) << "a lamp in the dark";
}

TEST(ClippedSun, WeakSun) {
    // One pixel, so that there is no plateau: a tenth of the sky's light.
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 256);
    paint(image, [](const glm::dvec3& w) { return glm::vec3(w.y > 0.0 ? 1.0f : 0.3f); });
    image.pixels[512 * 60 + 100] = glm::vec3(3000.0f);
    const auto found = check(image);
    ASSERT_TRUE(found);
    EXPECT_NE(found->why.find("sky"), std::string::npos);
    image.pixels[512 * 60 + 100] = glm::vec3(1e5f);
    EXPECT_FALSE(check(image));
}

TEST(ClippedSun, MeasuredEnvironments) {
    struct Known {
        const char* file;
        bool is_clipped;
    };
    // Venice and the beach are dusks with a glow where the sun was.
    for (const Known& known :
         {Known{"latlong/venice_1k.hdr", true}, Known{"debevec/beach_cross.hdr", true},
          Known{"latlong/sunset_1k.hdr", false}, Known{"openexr/KernerEnvLatLong.exr", false},
          Known{"debevec/uffizi_latlong_1200.hdr", false},
          Known{"debevec/kitchen_cross.hdr", false}, Known{"debevec/stpeters_cross.hdr", false},
          Known{"debevec/galileo_cross.hdr", false}, Known{"latlong/studio_1k.hdr", false},
          Known{"openexr/WavyLinesLatLong.exr", false}}) {
        const std::filesystem::path path = data_file(known.file);
        if (path.empty())
            GTEST_SKIP() << "no data folder";
        EXPECT_EQ(check(load_environment(path, {.fix_bad_pixels = true})).has_value(),
                  known.is_clipped)
            << known.file;
    }
}

} // namespace
} // namespace relumine::cubemap
