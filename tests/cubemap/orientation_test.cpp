// Where things are: every layout on a picture with known lights, OpenEXR's own converter, and real
// pictures of one place.
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/image/image_file.h"
#include "cubemap/resample/convert.h"
#include "cubemap/resample/resample.h"
#include "cubemap/resample/save_environment.h"
#include "files/output_file.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

struct Light {
    glm::dvec3 direction;
    glm::vec3 colour;
};

/// A coloured light on each axis and a white mark that no mirror image or turn of the sphere leaves
/// in place.
const std::array<Light, 7> Lights = {Light{{1, 0, 0}, {1, 0, 0}},   {{-1, 0, 0}, {0, 1, 1}},
                                     {{0, 1, 0}, {0, 1, 0}},        {{0, -1, 0}, {1, 0, 1}},
                                     {{0, 0, 1}, {0, 0, 1}},        {{0, 0, -1}, {1, 1, 0}},
                                     {{0.48, 0.64, 0.6}, {1, 1, 1}}};

glm::vec3 radiance(const glm::dvec3& w) {
    glm::dvec3 sum(0.02);
    for (const Light& light : Lights)
        sum += glm::dvec3(light.colour) * std::exp(40.0 * (glm::dot(w, light.direction) - 1.0));
    return glm::vec3(sum);
}

/// What texels of these sizes may smooth away of the lights; a light in the wrong place makes a
/// difference of 1.
constexpr float Blur = 0.06f;

double largest_error(const CubeMap& map) {
    double largest = 0.0;
    for (const Face face : AllFaces) {
        for (std::uint32_t y = 0; y < map.resolution; ++y) {
            for (std::uint32_t x = 0; x < map.resolution; ++x) {
                const glm::vec3 expected = radiance(texel_direction(face, x, y, map.resolution));
                largest = std::max<double>(largest, glm::distance(map.at(face, x, y), expected));
            }
        }
    }
    return largest;
}

TEST(Orientation, EveryLayoutAndSamplingShowsTheLightsWhereTheyAre) {
    for (const Layout layout : {Layout::LatLong, Layout::Cube, Layout::VerticalCross}) {
        for (const Sampling sampling : {Sampling::TexelCentres, Sampling::Borders}) {
            EnvironmentImage image =
                black_image(layout, sampling, layout == Layout::LatLong ? 128 : 64);
            paint(image, radiance);
            EXPECT_LT(largest_error(resample(image, 32)), Blur) << name(layout);

            const CubeMap map = resample(image, 64);
            const EnvironmentImage back =
                to_image(map, layout, image.width, image.height, sampling);
            for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace&) {
                ASSERT_LT(glm::distance(back.pixels[index], image.pixels[index]), Blur)
                    << name(layout) << " " << index;
            });
        }
    }
}

TEST(Orientation, SeenThroughSample) {
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 256);
    paint(image, radiance);
    const CubeMap map = resample(image, 128);
    for (const Light& light : Lights)
        EXPECT_LT(glm::distance(sample(map, glm::vec3(light.direction)), radiance(light.direction)),
                  0.01f);
}

/// Debian's package `openexr` has the program.
bool has_exrenvmap() {
    return std::system("exrenvmap -h >/dev/null 2>&1 || exrenvmap 2>&1 | grep -q usage") == 0;
}

class ExrEnvmapTest : public testing::Test {
protected:
    TemporaryFolder folder_;
    [[nodiscard]] EnvironmentImage converted(const std::string& options) const {
        const std::string command =
            fmt::format("exrenvmap {} '{}' '{}' >/dev/null 2>&1", options,
                        (folder_ / "in.exr").string(), (folder_ / "out.exr").string());
        EXPECT_EQ(std::system(command.c_str()), 0) << command;
        return load_environment(folder_ / "out.exr");
    }
    void write(const EnvironmentImage& image) const {
        files::OutputFile file(folder_ / "in.exr");
        file.write(encode_exr(image));
        file.commit();
    }
};

TEST_F(ExrEnvmapTest, ConvertsOurLatLongToTheSameCube) {
    if (!has_exrenvmap())
        GTEST_SKIP() << "needs the program exrenvmap (package openexr)";
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::Borders, 128);
    paint(image, radiance);
    write(image);
    const EnvironmentImage theirs = converted("-c -w 64");
    EXPECT_EQ(theirs.layout, Layout::Cube);
    EXPECT_EQ(theirs.sampling, Sampling::Borders);
    EXPECT_LT(largest_error(resample(theirs, 64)), Blur);
    EXPECT_LT(largest_error(resample(image, 64)), Blur);
    EXPECT_NEAR(total_power(theirs).x / total_power(image).x, 1.0, 2e-3);
}

TEST_F(ExrEnvmapTest, ConvertsOurCubeToTheSameLatLong) {
    if (!has_exrenvmap())
        GTEST_SKIP() << "needs the program exrenvmap (package openexr)";
    EnvironmentImage image = black_image(Layout::Cube, Sampling::Borders, 64);
    paint(image, radiance);
    write(image);
    const EnvironmentImage theirs = converted("-l -w 256");
    EXPECT_EQ(theirs.layout, Layout::LatLong);
    EXPECT_EQ(theirs.sampling, Sampling::Borders);
    EXPECT_LT(largest_error(resample(theirs, 64)), Blur);
    EXPECT_NEAR(total_power(theirs).x / total_power(image).x, 1.0, 2e-3);
}

TEST_F(ExrEnvmapTest, ReadsWhatSaveEnvironmentWrites) {
    if (!has_exrenvmap())
        GTEST_SKIP() << "needs the program exrenvmap (package openexr)";
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 128);
    paint(image, radiance);
    save_environment(folder_ / "in.exr", resample(image, 64), Layout::Cube);
    EXPECT_LT(largest_error(resample(converted("-l -w 256"), 64)), Blur);
}

double mean_difference(const EnvironmentImage& a, const EnvironmentImage& b) {
    double sum = 0.0;
    for_each_pixel(shape_of(a), [&](std::size_t i, const PixelPlace& place) {
        sum += place.solid_angle * glm::distance(a.pixels[i], b.pixels[i]);
    });
    return sum / (4.0 * std::numbers::pi);
}

TEST_F(ExrEnvmapTest, ConversionsAreTheirsPixelByPixelBothWays) {
    if (!has_exrenvmap())
        GTEST_SKIP() << "needs the program exrenvmap (package openexr)";
    EnvironmentImage lat_long = black_image(Layout::LatLong, Sampling::Borders, 128);
    paint(lat_long, radiance);
    write(lat_long);
    const EnvironmentImage cube = converted("-c -w 64");
    EXPECT_LT(mean_difference(cube, convert(lat_long, shape_of(cube))), 0.002);
    write(cube);
    const EnvironmentImage back = converted("-l -w 256");
    EXPECT_LT(mean_difference(back, convert(cube, shape_of(back))), 0.002);
}

double log_luminance(const glm::vec3& radiance) {
    return std::log(1e-3 + glm::dot(glm::dvec3(radiance), glm::dvec3(0.2126, 0.7152, 0.0722)));
}

double correlation(const CubeMap& a, const CubeMap& b) {
    double sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0;
    const auto n = static_cast<double>(a.texels.size());
    for (std::size_t i = 0; i < a.texels.size(); ++i) {
        const double x = log_luminance(a.texels[i]), y = log_luminance(b.texels[i]);
        sum_a += x;
        sum_b += y;
        sum_aa += x * x;
        sum_bb += y * y;
        sum_ab += x * y;
    }
    return (sum_ab - sum_a * sum_b / n) /
           std::sqrt((sum_aa - sum_a * sum_a / n) * (sum_bb - sum_b * sum_b / n));
}

TEST(OrientationData, CubeAndLatLongOfOnePlaceShowTheSameWorld) {
    for (const std::string place : {"KernerEnv", "WavyLines", "Orientation"}) {
        const auto cube = data_file("openexr/" + place + "Cube.exr");
        const auto lat_long = data_file("openexr/" + place + "LatLong.exr");
        if (cube.empty() || lat_long.empty())
            GTEST_SKIP() << absent_data("envs");
        const CubeMap a = resample(load_environment(cube), 128);
        const CubeMap b = resample(load_environment(lat_long), 128);
        EXPECT_GT(correlation(a, b), 0.97) << place;
        EXPECT_LT(correlation(a, rotated(b, 90.0)), 0.9) << place;
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(total_power(a)[channel] / total_power(b)[channel], 1.0, 2e-3) << place;
    }
}

TEST(OrientationData, DebevecsCrossesAreUprightAndSeamless) {
    for (const std::string place : {"beach", "galileo", "grace", "kitchen", "stpeters"}) {
        const auto path = data_file("debevec/" + place + "_cross.hdr");
        if (path.empty())
            GTEST_SKIP() << absent_data("envs");
        const EnvironmentImage image = load_environment(path);
        EXPECT_EQ(image.layout, Layout::VerticalCross);
        const CubeMap map = resample(image, 256);
        // Neighbours over the edges of faces differ no more than neighbours within them do.
        double within = 0.0, across = 0.0;
        for (const Face face : AllFaces) {
            for (std::uint32_t i = 0; i < 256; ++i) {
                const double along = (i + 0.5) / 256.0;
                const auto step = [&](double s0, double t0, double s1, double t1) {
                    const auto texel = [&](double s, double t) {
                        const FacePoint p = face_point(cube_point(face, s, t));
                        const auto at = [](double x) {
                            return std::min(static_cast<std::uint32_t>(x * 256.0), 255u);
                        };
                        return log_luminance(map.at(p.face, at(p.s), at(p.t)));
                    };
                    return std::abs(texel(s0, t0) - texel(s1, t1));
                };
                constexpr double In = 0.5 / 256.0, Over = -1e-9;
                across += step(In, along, Over, along) + step(along, In, along, Over);
                across += step(1.0 - In, along, 1.0 - Over, along) +
                          step(along, 1.0 - In, along, 1.0 - Over);
                within += step(In, along, 3.0 * In, along) + step(along, In, along, 3.0 * In);
                within += step(1.0 - In, along, 1.0 - 3.0 * In, along) +
                          step(along, 1.0 - In, along, 1.0 - 3.0 * In);
            }
        }
        EXPECT_LT(across, 1.5 * within) << place;
    }
}

} // namespace
} // namespace relumine::cubemap
