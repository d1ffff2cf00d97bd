// `relumine info ENV`: the environment's doctor, from file to words, figures and picture.
#include <cmath>
#include <limits>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

/// A sky of 1 over a ground of 0.25, with one pixel of `sun` at column x and row y of 128 x 64.
Painter sky_with_sun(std::uint32_t sun_x, std::uint32_t sun_y, float sun) {
    return [=](std::uint32_t x, std::uint32_t y) {
        const float value = x == sun_x && y == sun_y ? sun : y < 32 ? 1.0f : 0.25f;
        return Rgb{value, value, value};
    };
}

class EnvironmentInfo : public AppTest {
protected:
    [[nodiscard]] nlohmann::json info(const std::string& file) const {
        return succeed({"info", file, "--json"}).json();
    }
};

TEST_F(EnvironmentInfo, Irradiance) {
    write("white.hdr", white_hdr());
    const nlohmann::json white = info("white.hdr");
    for (const char* axis : {"+X", "-X", "+Y", "-Y", "+Z", "-Z"})
        EXPECT_NEAR(white["irradiance"][axis][1].get<double>(), 3.14159, 0.01) << axis;
    write("sky.exr", exr_file(128, 64, sky_with_sun(0, 99, 0.0f)));
    const nlohmann::json sky = info("sky.exr");
    EXPECT_NEAR(sky["irradiance"]["+Y"][0].get<double>(), 3.14159, 0.01);
    EXPECT_NEAR(sky["irradiance"]["-Y"][0].get<double>(), 0.25 * 3.14159, 0.01);
    EXPECT_NEAR(sky["irradiance"]["-Z"][0].get<double>(), 0.625 * 3.14159, 0.01);
}

TEST_F(EnvironmentInfo, SunInWorldAxes) {
    // Column 96 is longitude -90, row 16 elevation 45; the pixel's centre lies half a pixel
    // further.
    write("sun.exr", exr_file(128, 64, sky_with_sun(96, 15, 4000.0f)));
    const nlohmann::json sun = info("sun.exr")["sun"];
    ASSERT_TRUE(sun.is_object());
    EXPECT_NEAR(sun["azimuth_degrees"].get<double>(), 180.0 - 96.5 * 360.0 / 128.0, 1e-6);
    EXPECT_NEAR(sun["elevation_degrees"].get<double>(), 90.0 - 15.5 * 180.0 / 64.0, 1e-6);
    EXPECT_LT(sun["direction"][0].get<double>(), -0.6);
    EXPECT_GT(sun["direction"][1].get<double>(), 0.6);
    const double solid_angle =
        2.0 * 3.14159265 / 128.0 *
        (std::cos(15.0 * 3.14159265 / 64.0) - std::cos(16.0 * 3.14159265 / 64.0));
    EXPECT_NEAR(sun["solid_angle"].get<double>(), solid_angle, 1e-7);
    EXPECT_NEAR(sun["irradiance"][1].get<double>(), 3999.0 * solid_angle, 0.05);
    const double sky = 2.0 * 3.14159265 * 1.25;
    EXPECT_NEAR(sun["share_of_power"].get<double>(),
                3999.0 * solid_angle / (3999.0 * solid_angle + sky), 1e-3);
    const Result told = succeed("info sun.exr");
    for (const char* part : {"sun towards", "azimuth -91.4, elevation 46.4", "degrees wide",
                             "% of all light", "seams and poles     in line"})
        EXPECT_NE(told.out.find(part), std::string::npos) << part << told.described();
}

TEST_F(EnvironmentInfo, NoSunAndWhy) {
    write("white.hdr", white_hdr());
    const nlohmann::json white = info("white.hdr");
    EXPECT_TRUE(white["sun"].is_null());
    EXPECT_TRUE(white["why_no_sun"].is_string());
    EXPECT_TRUE(white["clipped_sun"].is_null());
    EXPECT_EQ(white["seam_faults"], nlohmann::json::array());
    EXPECT_NE(succeed("info white.hdr").out.find("none: "), std::string::npos);
}

TEST_F(EnvironmentInfo, ClippedSun) {
    // A flat top of 3 x 3 pixels at 40 times the sky.
    write("clipped.exr", exr_file(256, 128, [](std::uint32_t x, std::uint32_t y) {
              const float value = x >= 60 && x < 63 && y >= 30 && y < 33 ? 40.0f
                                  : y < 64                               ? 1.0f
                                                                         : 0.25f;
              return Rgb{value, value, value};
          }));
    const nlohmann::json clipped = info("clipped.exr")["clipped_sun"];
    ASSERT_TRUE(clipped.is_object());
    EXPECT_NEAR(clipped["azimuth_degrees"].get<double>(), 180.0 - 61.5 * 360.0 / 256.0, 0.5);
    EXPECT_NE(clipped["why"].get<std::string>().find("9 adjacent pixels"), std::string::npos);
    EXPECT_NE(succeed("info clipped.exr").out.find("\nsuspect  "), std::string::npos);
}

TEST_F(EnvironmentInfo, SeamsOutOfLine) {
    write("black_row.exr", exr_file(128, 64, [](std::uint32_t, std::uint32_t y) {
              return y == 0 ? Rgb{0.0f, 0.0f, 0.0f} : Rgb{1.0f, 1.0f, 1.0f};
          }));
    const nlohmann::json faults = info("black_row.exr")["seam_faults"];
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_EQ(faults[0]["where"], "top row");
    EXPECT_GT(faults[0]["step_ev"], 5.0);
    EXPECT_NE(succeed("info black_row.exr").out.find("top row out of line"), std::string::npos);
}

TEST_F(EnvironmentInfo, BadPixelsDoNotSpoilTheFigures) {
    constexpr float NotANumber = std::numeric_limits<float>::quiet_NaN();
    write("bad.exr", exr_file(128, 64, [](std::uint32_t x, std::uint32_t y) {
              if (x == 3 && y == 5)
                  return Rgb{NotANumber, 1.0f, 1.0f};
              return sky_with_sun(96, 15, 4000.0f)(x, y);
          }));
    const nlohmann::json bad = info("bad.exr");
    EXPECT_EQ(bad["num_nan"], 1);
    EXPECT_TRUE(bad["sun"].is_object());
    EXPECT_NEAR(bad["irradiance"]["-Y"][0].get<double>(), 0.25 * 3.14159, 0.01);
    EXPECT_NE(succeed("info bad.exr").out.find("--fix-env"), std::string::npos);
}

TEST_F(EnvironmentInfo, Picture) {
    write("sun.exr", exr_file(128, 64, sky_with_sun(96, 15, 4000.0f)));
    succeed("info sun.exr --picture sun.png");
    EXPECT_EQ(png_size(read("sun.png")), (Size{1024, 512}));
    // The mark is the sun's: without one the picture is another.
    write("sky.exr", exr_file(128, 64, sky_with_sun(0, 99, 0.0f)));
    succeed("info sky.exr --picture sky.png");
    EXPECT_NE(read("sun.png"), read("sky.png"));
    // Maps of any size and none too dark.
    write("dot.exr",
          exr_file(2, 1, [](std::uint32_t, std::uint32_t) { return Rgb{0.0f, 0.0f, 0.0f}; }));
    succeed("info dot.exr --picture dot.png");
    EXPECT_EQ(png_size(read("dot.png")), (Size{1024, 512}));
}

TEST_F(EnvironmentInfo, PictureOfTheWrongThing) {
    write("white.hdr", white_hdr());
    write("mesh.obj", octahedron_obj());
    misuse("info white.hdr --picture out.jpg", "--picture: expected a name that ends");
    fail("info white.hdr --picture missing/out.png", {"missing/out.png"});
    fail("info absent.hdr --picture out.png", {"absent.hdr"});
    misuse({"info", "white.hdr", "--picture", ""}, "--picture");
}

} // namespace
} // namespace relumine::app
