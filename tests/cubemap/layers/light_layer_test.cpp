#include "cubemap/layers/light_layer.h"
#include "cubemap/resample/save_environment.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/cubemap/layer_places.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

constexpr double NaN = std::numeric_limits<double>::quiet_NaN();
constexpr double Infinity = std::numeric_limits<double>::infinity();

TEST(LightLayer, DiscFallsSmoothlyToItsRadius) {
    const Disc disc{{0, 0, 2}, 20.0, 0.5};
    const auto at = [&](double degrees) {
        return coverage(disc, {std::sin(radians(degrees)), 0.0, std::cos(radians(degrees))});
    };
    EXPECT_EQ(at(0.0), 1.0);
    EXPECT_EQ(at(9.99), 1.0);
    EXPECT_EQ(at(20.01), 0.0);
    EXPECT_EQ(at(180.0), 0.0);
    // Half the way in the cosine.
    const double half = std::acos(0.5 * (std::cos(radians(10.0)) + std::cos(radians(20.0))));
    EXPECT_NEAR(at(half * 180.0 / Pi), 0.5, 1e-9);
    double last = 1.0;
    for (int tenth = 100; tenth <= 200; ++tenth) {
        const double degrees = 0.1 * tenth;
        EXPECT_LE(at(degrees), last);
        last = at(degrees);
    }
}

TEST(LightLayer, RectangleStandsUprightAndRollsCounterClockwise) {
    const auto covers = [](const Rectangle& rectangle, const glm::dvec3& w) {
        return coverage(rectangle, w) == 1.0;
    };
    // Wide, low.
    const Rectangle wide{{0, 0, -1}, 60.0, 20.0, 0.0, 0.0};
    EXPECT_TRUE(covers(wide, {0.5, 0.0, -1}));
    EXPECT_FALSE(covers(wide, {0.0, 0.5, -1}));
    EXPECT_FALSE(covers(wide, {-0.5, 0.0, 1})) << "nothing behind";
    // Looking along -Z, +X is right and +Y up: 30 degrees counter-clockwise lift the right end.
    Rectangle rolled = wide;
    rolled.roll_degrees = 30.0;
    EXPECT_TRUE(covers(rolled, {0.5 * std::cos(radians(30.0)), 0.5 * std::sin(radians(30.0)), -1}));
    EXPECT_FALSE(
        covers(rolled, {0.5 * std::cos(radians(30.0)), -0.5 * std::sin(radians(30.0)), -1}));
    // Straight above and below: its width lies along X.
    for (const double y : {1.0, -1.0}) {
        Rectangle pole = wide;
        pole.direction = {0, y, 0};
        EXPECT_TRUE(covers(pole, {0.5, y, 0}));
        EXPECT_FALSE(covers(pole, {0, y, 0.5}));
    }
    const double half = std::tan(radians(30.0));
    EXPECT_EQ(coverage(wide, {half * 0.999, 0, -1}), 1.0);
    EXPECT_EQ(coverage(wide, {half * 1.001, 0, -1}), 0.0);
}

TEST(LightLayer, LassoFollowsTheEvenOddRule) {
    // A pentagram: its middle is enclosed twice.
    Lasso star;
    for (int i = 0; i < 5; ++i) {
        const double angle = 2.0 * Pi * ((2 * i) % 5) / 5.0;
        star.points.push_back({0.3 * std::cos(angle), 0.3 * std::sin(angle), 1.0});
    }
    EXPECT_EQ(coverage(star, {0, 0, 1}), 0.0);
    EXPECT_EQ(coverage(star, {0.2, 0, 1}), 1.0);
    EXPECT_EQ(coverage(star, {-0.2, 0, 1}), 0.0);
    EXPECT_EQ(coverage(star, {-0.2, 0, -1}), 0.0);
}

TEST(LightLayer, StrokeIsTheDistanceToItsLine) {
    const Stroke stroke{{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, 5.0, 0.0};
    EXPECT_EQ(coverage(stroke, glm::dvec3(1, std::tan(radians(4.9)) * std::sqrt(2.0), 1)), 1.0);
    EXPECT_EQ(coverage(stroke, glm::dvec3(1, std::tan(radians(5.1)) * std::sqrt(2.0), 1)), 0.0);
    EXPECT_EQ(coverage(stroke, {1, 0, -std::tan(radians(4.9))}), 1.0);
    EXPECT_EQ(coverage(stroke, {1, 0, -std::tan(radians(5.1))}), 0.0);
    EXPECT_EQ(coverage(stroke, {0, 1, -std::tan(radians(4.9))}), 1.0);
}

TEST(LightLayer, RefusesWhatMakesNoSense) {
    const auto refused = [](const Region& region, const std::string& says) {
        const std::string message =
            message_of([&] { validate(LightLayer{.name = "sun", .region = region}); });
        EXPECT_EQ(message.substr(0, 27), "light layer \"sun\": expected");
        EXPECT_NE(message.find(says), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
        EXPECT_THROW((void)coverage(region, {0, 0, 1}), std::invalid_argument);
    };
    refused(Disc{.direction = {0, 0, 0}}, "direction");
    refused(Disc{.direction = {0, NaN, 0}}, "direction");
    refused(Disc{.direction = {0, Infinity, 0}}, "direction");
    refused(Disc{.direction = {0, 1e200, 0}}, "direction");
    for (const double radius : {0.0, 1e-5, 81e-320, -1.0, 180.1, NaN})
        refused(Disc{.radius_degrees = radius}, "radius_degrees from 0.0001 to 180");
    for (const double softness : {-0.1, 1.1, NaN})
        refused(Disc{.softness = softness}, "softness from 0 to 1");
    for (const double width : {0.0, 1e-5, 180.0, NaN}) {
        refused(Rectangle{.width_degrees = width}, "width_degrees from 0.0001 to below 180");
        refused(Rectangle{.height_degrees = width}, "height_degrees");
    }
    refused(Rectangle{.roll_degrees = Infinity}, "roll_degrees");
    refused(Lasso{{{1, 0, 0}, {0, 1, 0}}, 0.0}, "at least 3");
    refused(Lasso{{{1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}}, 0.0}, "of their mean");
    refused(Lasso{{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}, 0.0}, "points");
    refused(Lasso{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, NaN}, "softness_degrees");
    refused(Stroke{{}, 1.0, 0.0}, "at least 1");
    refused(Stroke{{{1, 0, 0}, {-1, 0, 0}}, 1.0, 0.0}, "opposite");
    refused(Stroke{{{1, 0, 0}}, 91.0, 0.0}, "radius_degrees");
}

TEST(LightLayer, RefusesBadLight) {
    const auto refused = [](const LightLayer& layer) {
        EXPECT_THROW(validate(layer), std::invalid_argument);
    };
    refused({.name = "a", .effect = Emit{{-1, 0, 0}}});
    refused({.name = "a", .effect = Emit{{0, std::nanf(""), 0}}});
    refused({.name = "a", .gain_ev = NaN});
    refused({.name = "a", .gain_ev = 100.0, .effect = Emit{{1e30f, 0, 0}}});
    refused({.name = "a", .effect = Gain{-1.0f, {1, 1, 1}}});
    refused({.name = "a", .effect = Gain{1.0f, {1, -1, 1}}});
    const auto picture = std::make_shared<const ImagePyramid>(Picture{1, 1, {glm::vec3(1.0f)}});
    refused({.name = "a", .effect = ImagePatch{"p", picture}});
    refused({.name = "a", .region = Rectangle{}, .effect = ImagePatch{"p"}});
    EXPECT_NO_THROW(
        validate({.name = "a", .region = Rectangle{}, .effect = ImagePatch{"p", picture}}));
    EXPECT_THROW((void)coverage(Disc{}, {0, 0, 0}), std::invalid_argument);
}

TEST(ImagePyramid, HalvesToItsMean) {
    std::vector<glm::vec3> pixels(35);
    fill_randomly(pixels, 3);
    glm::dvec3 mean(0.0);
    for (const glm::vec3& pixel : pixels)
        mean += glm::dvec3(pixel) / 35.0;
    const ImagePyramid picture(Picture{7, 5, pixels});
    ASSERT_EQ(picture.levels().size(), 3u);
    EXPECT_LT(glm::distance(glm::dvec3(picture.levels().back().pixels[0]), mean), 1e-6);
    EXPECT_THROW(ImagePyramid(Picture{2, 2, pixels}), std::invalid_argument);
    EXPECT_THROW(ImagePyramid(Picture{}), std::invalid_argument);
    EXPECT_THROW(ImagePyramid(Picture{1, 1, {glm::vec3(0, -1, 0)}}), std::invalid_argument);
}

TEST(ImagePyramid, LoadsAnyShape) {
    const TemporaryFolder folder;
    const CubeMap map(4, glm::vec3(1, 2, 3));
    for (const std::string name : {"a.exr", "a.hdr"}) {
        save_environment(folder / name, map);
        const auto picture = load_image_pyramid(folder / name);
        EXPECT_EQ(picture->levels().front().height, 24u);
        EXPECT_EQ(picture->levels().back().pixels[0], glm::vec3(1, 2, 3));
    }
    EXPECT_NE(message_of([&] { (void)load_image_pyramid(folder / "none.exr"); }).find("none.exr"),
              std::string::npos);
}

} // namespace
} // namespace relumine::cubemap
