#include "cubemap/doctor/sun.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/doctor/sky_angles.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

constexpr double Degree = std::numbers::pi / 180.0;

/// A sky that brightens towards the horizon over a dark ground.
glm::vec3 sky(const glm::dvec3& w) {
    return w.y < 0.0 ? glm::vec3(0.2f, 0.15f, 0.1f)
                     : glm::vec3(0.5f, 0.7f, 1.0f) * static_cast<float>(1.5 - w.y);
}

/// The sky with a uniform disc over it; pixels at its rim get their covered part.
EnvironmentImage sky_with_disc(EnvironmentImage image, const glm::dvec3& to_disc,
                               double radius_degrees, const glm::vec3& radiance) {
    paint(image, [&](const glm::dvec3& w) {
        // Softened over a tenth of the radius in place of exact coverage.
        const double angle = std::acos(std::clamp(glm::dot(w, to_disc), -1.0, 1.0)) / Degree;
        const double covered =
            std::clamp((radius_degrees - angle) / (0.1 * radius_degrees) + 0.5, 0.0, 1.0);
        return sky(w) + static_cast<float>(covered) * radiance;
    });
    return image;
}

double angle_degrees(const glm::dvec3& a, const glm::dvec3& b) {
    return 2.0 * std::asin(std::min(0.5 * glm::distance(a, b), 1.0)) / Degree;
}

/// Directions at places where layouts break: +Z is a lat-long's centre, -Z its seam, +-Y its poles;
/// edges and corners of faces.
std::vector<glm::dvec3> difficult_directions() {
    std::vector<glm::dvec3> directions = {{0, 0, 1},    {0, 0, -1},     {1e-3, 0, -1}, {0, 1, 0},
                                          {0.01, 1, 0}, {0, -1, 0},     {1, 0, 1},     {1, 1, 0},
                                          {1, 1, 1},    {-1, 1, -1},    {-1, 0, 1},    {0, 1, -1},
                                          {-1, -1, 1},  {0.3, 0.5, 0.2}};
    for (glm::dvec3& w : directions)
        w = glm::normalize(w);
    return directions;
}

struct Case {
    Layout layout;
    Sampling sampling;
    std::uint32_t size;
};
const Case Cases[] = {{Layout::LatLong, Sampling::TexelCentres, 256},
                      {Layout::LatLong, Sampling::Borders, 257},
                      {Layout::Cube, Sampling::TexelCentres, 128},
                      {Layout::Cube, Sampling::Borders, 129},
                      {Layout::VerticalCross, Sampling::TexelCentres, 128}};

TEST(Sun, DiscFoundAnywhereInEveryLayout) {
    const double radius = 1.5;
    const glm::vec3 radiance(2000.0f, 1500.0f, 1000.0f);
    for (const Case& c : Cases) {
        const EnvironmentImage black = black_image(c.layout, c.sampling, c.size);
        for (const glm::dvec3& w : difficult_directions()) {
            SCOPED_TRACE(testing::Message() << name(c.layout) << ' ' << c.size << " towards " << w.x
                                            << ' ' << w.y << ' ' << w.z);
            const EnvironmentImage image = sky_with_disc(black, w, radius, radiance);
            // What was drawn, a disc of some 18 or 70 pixels, is known exactly.
            glm::dvec3 drawn(0.0);
            for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
                drawn += glm::dvec3(image.pixels[index] - sky(place.direction)) *
                         place.solid_angle * std::max(0.0, glm::dot(place.direction, w));
            });
            const SunSearch found = find_sun(image);
            ASSERT_TRUE(found.sun) << found.why_none;
            const Sun& sun = *found.sun;
            EXPECT_LT(angle_degrees(sun.direction, w), 0.12);
            EXPECT_NEAR(sun.irradiance.x / drawn.x, 1.0, 2e-3);
            EXPECT_NEAR(sun.irradiance.z / drawn.z, 1.0, 2e-3);
            EXPECT_NEAR(disc_diameter_degrees(sun.solid_angle), 2.0 * radius, 0.25 * 2.0 * radius);
            EXPECT_GT(sun.peak_luminance, 1500.0);
            EXPECT_LT(sun.sky_luminance, 2.0);
        }
    }
}

TEST(Sun, OnePixel) {
    for (const Case& c : Cases) {
        EnvironmentImage image = black_image(c.layout, c.sampling, c.size);
        paint(image, sky);
        const EnvironmentImage without = image;
        // Corners, edges, poles and a few in between. Cells of a cross that show nothing come out
        // as black and are not listed.
        std::vector<std::pair<std::size_t, PixelPlace>> places;
        for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
            if (index % 3989 == 0 || index == image.pixels.size() - 1)
                places.emplace_back(index, place);
        });
        double power = 0.0;
        for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
            power += luminance(glm::dvec3(image.pixels[index])) * place.solid_angle;
        });
        for (const auto& [index, place] : places) {
            SCOPED_TRACE(testing::Message() << name(c.layout) << " pixel " << index);
            // Pixels at the poles of a lat-long are tiny: the same power everywhere.
            const double added = 4.0 / place.solid_angle;
            image.pixels = without.pixels;
            image.pixels[index] += glm::vec3(static_cast<float>(added));
            const SunSearch found = find_sun(image);
            ASSERT_TRUE(found.sun) << found.why_none;
            EXPECT_EQ(found.sun->pixels.size(), 1u);
            EXPECT_EQ(found.sun->pixels.front().index, index);
            EXPECT_LT(angle_degrees(found.sun->direction, place.direction), 1e-6);
            EXPECT_NEAR(found.sun->solid_angle / place.solid_angle, 1.0, 1e-9);
            EXPECT_NEAR(found.sun->irradiance.y, 4.0, 0.004);
            EXPECT_NEAR(found.sun->share_of_power, 4.0 / (power + 4.0), 1e-3);
        }
    }
}

TEST(Sun, OnePixelOfACoarseMap) {
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 32);
    paint(image, sky);
    for (const std::size_t index :
         {0u, 63u, 64u * 10u, 64u * 10u + 63u, 64u * 31u + 5u, 64u * 8u + 30u}) {
        EnvironmentImage lit = image;
        const auto rows = detail::lat_long_rows(shape_of(image));
        const double solid_angle = rows[index / 64].height * 2.0 * std::numbers::pi / 64;
        lit.pixels[index] += glm::vec3(static_cast<float>(3.0 / solid_angle));
        const SunSearch found = find_sun(lit);
        ASSERT_TRUE(found.sun) << index << found.why_none;
        EXPECT_NEAR(found.sun->irradiance.x, 3.0, 0.06);
        EXPECT_EQ(found.sun->pixels.size(), 1u);
    }
}

TEST(Sun, CubeMapAsImage) {
    CubeMap map(64, glm::vec3(1.0f));
    map.at(Face::PositiveY, 0, 63) = glm::vec3(1e5f); // a corner
    const SunSearch found = find_sun(map);
    ASSERT_TRUE(found.sun);
    EXPECT_LT(glm::distance(found.sun->direction, texel_direction(Face::PositiveY, 0, 63, 64)),
              1e-9);
    EXPECT_NEAR(found.sun->irradiance.x, (1e5 - 1.0) * texel_solid_angles(64).back(), 1e-3);
}

TEST(Sun, PixelsTellTheSky) {
    const glm::dvec3 w = glm::normalize(glm::dvec3(0.3, 0.6, -1.0));
    const EnvironmentImage image = sky_with_disc(
        black_image(Layout::LatLong, Sampling::TexelCentres, 256), w, 1.5, glm::vec3(1e4f));
    const SunSearch found = find_sun(image);
    ASSERT_TRUE(found.sun);
    const glm::vec3 expected = sky(w);
    for (const SunPixel& pixel : found.sun->pixels) {
        EXPECT_NEAR(pixel.sky.x / expected.x, 1.0f, 0.03f);
        EXPECT_NEAR(pixel.sky.z / expected.z, 1.0f, 0.03f);
        EXPECT_LE(pixel.sky.y, image.pixels[pixel.index].y);
    }
}

TEST(Sun, NoneWhereThereIsNone) {
    const auto why = [](const EnvironmentImage& image) {
        const SunSearch found = find_sun(image);
        EXPECT_FALSE(found.sun);
        EXPECT_EQ(found.why_none.empty(), found.sun.has_value());
        return found.why_none;
    };
    const EnvironmentImage black = black_image(Layout::LatLong, Sampling::TexelCentres, 128);
    EnvironmentImage constant = black;
    paint(constant, [](const glm::dvec3&) { return glm::vec3(1.0f); });
    EnvironmentImage plain_sky = black;
    paint(plain_sky, sky);
    EXPECT_NE(why(black), "");
    EXPECT_NE(why(constant), "");
    EXPECT_NE(why(plain_sky), "");
    // A window: strong, but wide.
    const glm::dvec3 w = glm::normalize(glm::dvec3(1.0, 0.5, 0.0));
    EXPECT_NE(why(sky_with_disc(black, w, 6.0, glm::vec3(500.0f))).find("wide"), std::string::npos);
    EXPECT_NE(why(sky_with_disc(black, w, 20.0, glm::vec3(500.0f))), "");
    // Small but weak.
    EXPECT_NE(why(sky_with_disc(black, w, 1.0, glm::vec3(20.0f))).find("power"), std::string::npos);
    // Two lamps.
    EnvironmentImage lamps = sky_with_disc(black, w, 1.5, glm::vec3(5000.0f));
    const EnvironmentImage other = sky_with_disc(black, -w, 1.5, glm::vec3(4000.0f));
    for (std::size_t i = 0; i < lamps.pixels.size(); ++i)
        lamps.pixels[i] += other.pixels[i];
    EXPECT_NE(why(lamps).find("several"), std::string::npos);
    EXPECT_NE(why(black_image(Layout::LatLong, Sampling::TexelCentres, 1, 1)).find("coarse"),
              std::string::npos);
}

TEST(Sun, AHotPixelIsNoRival) {
    const glm::dvec3 w = glm::normalize(glm::dvec3(1.0, 0.5, 0.0));
    EnvironmentImage image = sky_with_disc(
        black_image(Layout::LatLong, Sampling::TexelCentres, 256), w, 1.5, glm::vec3(1e4f));
    image.pixels[512 * 200 + 30] = glm::vec3(6e4f); // brighter, but one pixel
    const SunSearch found = find_sun(image);
    ASSERT_TRUE(found.sun) << found.why_none;
    EXPECT_LT(angle_degrees(found.sun->direction, w), 0.05);
}

TEST(Sun, MeasuredEnvironments) {
    struct Known {
        const char* file;
        bool has_sun;
    };
    for (const Known& known :
         {Known{"latlong/sunset_1k.hdr", true}, Known{"latlong/blender_sunset_1k.exr", true},
          Known{"openexr/KernerEnvLatLong.exr", true}, Known{"debevec/grace_cross.hdr", false},
          Known{"debevec/stpeters_cross.hdr", false}, Known{"latlong/venice_1k.hdr", false},
          Known{"debevec/uffizi_latlong_1200.hdr", false},
          Known{"debevec/kitchen_cross.hdr", false}, Known{"latlong/studio_1k.hdr", false}}) {
        const std::filesystem::path path = data_file(known.file);
        if (path.empty())
            GTEST_SKIP() << "no data folder";
        EXPECT_EQ(find_sun(load_environment(path, {.fix_bad_pixels = true})).sun.has_value(),
                  known.has_sun)
            << known.file;
    }
}

TEST(BrightSpots, GrowOverEdgesAndCorners) {
    EXPECT_EQ(grown({5}, 3).size(),
              6u + 3u); // in the middle of a face's right edge: its own and the neighbour's
    EXPECT_EQ(grown({0}, 3).size(), 4u + 2u + 2u); // at a corner of the cube there is no ninth
    std::vector<std::uint32_t> all = {0};
    for (int i = 0; i < 12; ++i)
        all = grown(all, 3);
    EXPECT_EQ(all.size(), 54u);
}

} // namespace
} // namespace relumine::cubemap
