#include "relight/pictures/display_transform.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "relight/pictures/picture.h"
#include "tests/own_folder.h"

namespace relumine::relight {
namespace {

/// A display whose view swaps red and blue, and one that shows the colours as they are.
constexpr const char* Config = R"(ocio_profile_version: 2
roles: {scene_linear: linear, default: linear}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  screen:
    - !<View> {name: Swapped, colorspace: swapped}
    - !<View> {name: Plain, colorspace: linear}
colorspaces:
  - !<ColorSpace> {name: linear}
  - !<ColorSpace>
    name: swapped
    from_scene_reference: !<MatrixTransform> {matrix: [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1]}
)";

class DisplayTransformTest : public tests::FolderTest {
protected:
    DisplayTransformTest() {
        std::ofstream(path_) << Config;
        try {
            const DisplayTransform transform({.config = path_});
            is_built_ = true;
        } catch (const std::runtime_error& error) {
            EXPECT_EQ(error.what(), path_ + ": this build has no OpenColorIO (packages/ocio.txt, "
                                            "-DRELUMINE_OCIO=ON)");
        }
    }
    [[nodiscard]] std::string error(const DisplayView& view) const {
        return tests::message_of([&] { const DisplayTransform transform(view); });
    }
    const std::string path_ = (folder_ / "display.ocio").string();
    bool is_built_ = false;
};

TEST_F(DisplayTransformTest, ShowsTheViewOfTheConfigInThePicture) {
    if (!is_built_)
        GTEST_SKIP() << "built without OpenColorIO";
    const DisplayTransform swapped({.config = path_});
    const DisplayTransform plain({.config = path_, .display = "screen", .view = "Plain"});
    std::vector<glm::vec3> pixels = {{0.5f, 0.25f, 0.125f}, {3, 0, 1}};
    plain.apply(pixels);
    EXPECT_EQ(pixels[1], glm::vec3(3, 0, 1));
    swapped.apply(pixels);
    EXPECT_EQ(pixels[0], glm::vec3(0.125f, 0.25f, 0.5f));
    EXPECT_EQ(pixels[1], glm::vec3(1, 0, 3));

    // The view's values are the file's, exposed before and multiplied by alpha afterwards.
    Picture picture{.width = 2, .height = 1, .pixels = {{100, 50, 200}, {30, 60, 90}}};
    Picture expected = picture;
    for (std::size_t i = 0; i < 2; ++i) {
        const glm::vec3 bytes = picture.pixels[i];
        picture.pixels[i] = bytes / (255.0f * 4.0f);
        const glm::vec3 shown(bytes.b, bytes.g, bytes.r);
        for (int channel = 0; channel < 3; ++channel)
            expected.pixels[i][channel] =
                std::pow((shown[channel] / 255.0f + 0.055f) / 1.055f, 2.4f);
    }
    picture.alpha = expected.alpha = {1.0f, 0.5f};
    picture.pixels[1] *= 0.5f;
    expected.pixels[1] *= 0.5f;
    EXPECT_EQ(png_file(picture, {.exposure_ev = 2.0, .display = &swapped}), png_file(expected));
}

TEST_F(DisplayTransformTest, RefusesWhatTheConfigDoesNotHave) {
    if (!is_built_)
        GTEST_SKIP() << "built without OpenColorIO";
    EXPECT_EQ(error({.config = path_, .view = "Swopped"}),
              path_ + ": expected a view among Swapped, Plain, got 'Swopped'; did you mean "
                      "Swapped?");
    EXPECT_EQ(error({.config = path_, .display = "lcd"}),
              path_ + ": expected a display among screen, got 'lcd'");
    EXPECT_THAT(error({.config = "missing.ocio"}), testing::StartsWith("missing.ocio: "));
}

} // namespace
} // namespace relumine::relight
