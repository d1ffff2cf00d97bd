#include "cubemap/doctor/seams.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

/// Hills and grain: neighbours differ by a tenth or so, everywhere.
void paint_world(EnvironmentImage& image) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<float> grain(0.9f, 1.1f);
    paint(image, [&](const glm::dvec3& w) {
        const double hills =
            std::sin(5.0 * w.x + 1.0) * std::cos(7.0 * w.z) + 0.5 * std::sin(11.0 * w.y);
        return glm::vec3(static_cast<float>(std::exp(hills))) * grain(generator);
    });
}

std::vector<std::string> places(const EnvironmentImage& image) {
    std::vector<std::string> result;
    for (const SeamFault& fault : seam_faults(image)) {
        EXPECT_GT(fault.step_ev, fault.usual_step_ev);
        result.push_back(fault.where);
    }
    return result;
}

EnvironmentImage world(Layout layout, Sampling sampling, std::uint32_t size) {
    EnvironmentImage image = black_image(layout, sampling, size);
    paint_world(image);
    if (sampling == Sampling::Borders && layout == Layout::LatLong) {
        // Shared samples are the same, grain and all.
        for (std::uint32_t y = 0; y < image.height; ++y)
            image.pixels[(y + 1) * std::size_t{image.width} - 1] =
                image.pixels[y * std::size_t{image.width}];
    }
    return image;
}

const Sampling Samplings[] = {Sampling::TexelCentres, Sampling::Borders};

TEST(Seams, GoodMapsHaveNone) {
    for (const Sampling sampling : Samplings) {
        for (const std::uint32_t size : {16u, 64u, 257u})
            EXPECT_THAT(places(world(Layout::LatLong, sampling, size)), testing::IsEmpty()) << size;
        for (const std::uint32_t size : {8u, 32u, 129u}) {
            EXPECT_THAT(places(world(Layout::Cube, sampling, size)), testing::IsEmpty()) << size;
            EXPECT_THAT(places(world(Layout::VerticalCross, sampling, size)), testing::IsEmpty())
                << size;
        }
    }
    for (const Layout layout : {Layout::LatLong, Layout::Cube, Layout::VerticalCross}) {
        EnvironmentImage image = black_image(layout, Sampling::TexelCentres, 64);
        EXPECT_THAT(places(image), testing::IsEmpty());
        image.pixels.assign(image.pixels.size(), glm::vec3(3.0f));
        EXPECT_THAT(places(image), testing::IsEmpty());
        // A light that an edge, the seam or the pole cuts.
        for (const glm::dvec3& to_light :
             {glm::dvec3(0, 1, 0), glm::dvec3(0, 0, -1), glm::dvec3(1, 0, 1)}) {
            paint(image, [&](const glm::dvec3& w) {
                return glm::vec3(glm::dot(w, glm::normalize(to_light)) > 0.99 ? 100.0f : 1.0f);
            });
            EXPECT_THAT(places(image), testing::IsEmpty());
        }
    }
}

TEST(Seams, WrapAround) {
    // A sky whose left third is exposed a quarter stop more, blended in the picture's middle but
    // not where it wraps around.
    EnvironmentImage image = world(Layout::LatLong, Sampling::TexelCentres, 128);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const auto x = static_cast<double>(i % image.width) / image.width;
        image.pixels[i] *= static_cast<float>(std::exp2(1.5 * std::max(0.0, 1.0 - 3.0 * x)));
    }
    EXPECT_THAT(places(image), testing::ElementsAre("left and right edge"));
    // A column of black.
    image = world(Layout::LatLong, Sampling::TexelCentres, 128);
    for (std::size_t i = 0; i < image.pixels.size(); i += image.width)
        image.pixels[i] = glm::vec3(0.0f);
    EXPECT_THAT(places(image), testing::Not(testing::IsEmpty()));
}

TEST(Seams, Poles) {
    for (const bool is_top : {true, false}) {
        const std::string row = is_top ? "top row" : "bottom row";
        for (const float gain : {0.0f, 0.25f, 4.0f}) {
            EnvironmentImage image = world(Layout::LatLong, Sampling::TexelCentres, 128);
            const auto begin = image.pixels.begin() + (is_top ? 0 : 127 * 256);
            std::for_each(begin, begin + 256, [&](glm::vec3& pixel) { pixel *= gain; });
            EXPECT_THAT(places(image), testing::ElementsAre(row)) << gain;
        }
    }
    // A picture that does not shrink to a point at its top: as a map it shows a hundred things in
    // one direction.
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 128);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = glm::vec3(std::exp2(static_cast<float>(
            2.0 * std::sin(static_cast<double>(i % 256) * 2.0 * 3.14159265 / 256.0))));
    EXPECT_THAT(places(image),
                testing::ElementsAre("top row around the pole", "bottom row around the pole"));
}

TEST(Seams, OneFaceUnlikeTheOthers) {
    EnvironmentImage image = world(Layout::Cube, Sampling::TexelCentres, 64);
    constexpr std::size_t PositiveY = std::size_t{2} * 64 * 64;
    for (std::size_t y = 0; y < 64; ++y)
        for (std::size_t x = 0; x < y; ++x) // mirrored at its diagonal
            std::swap(image.pixels[PositiveY + y * 64 + x], image.pixels[PositiveY + x * 64 + y]);
    EXPECT_THAT(places(image),
                testing::UnorderedElementsAre("edge of +X and +Y", "edge of -X and +Y",
                                              "edge of +Y and +Z", "edge of +Y and -Z"));
    // One face exposed half a stop more.
    image = world(Layout::VerticalCross, Sampling::TexelCentres, 64);
    const FaceSquares squares(image.layout, image.width, image.height);
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x)
            image.pixels[squares.pixel(Face::NegativeZ, x, y)] *= 3.0f;
    EXPECT_THAT(places(image),
                testing::UnorderedElementsAre("edge of +X and -Z", "edge of -X and -Z",
                                              "edge of +Y and -Z", "edge of -Y and -Z"));
}

TEST(Seams, MeasuredEnvironmentsHaveNone) {
    for (const char* file :
         {"latlong/sunset_1k.hdr", "latlong/venice_1k.hdr", "latlong/studio_1k.hdr",
          "latlong/ennis_256.hdr", "latlong/grace_256.hdr", "latlong/mitsuba_museum_512.exr",
          "latlong/blender_interior_1k.exr", "openexr/KernerEnvCube.exr",
          "openexr/KernerEnvLatLong.exr", "openexr/WavyLinesCube.exr", "debevec/grace_cross.hdr",
          "debevec/kitchen_cross.hdr", "debevec/uffizi_latlong_1200.hdr"}) {
        const std::filesystem::path path = data_file(file);
        if (path.empty())
            GTEST_SKIP() << "no data folder";
        EXPECT_THAT(places(load_environment(path, {.fix_bad_pixels = true})), testing::IsEmpty())
            << file;
    }
}

} // namespace
} // namespace relumine::cubemap
