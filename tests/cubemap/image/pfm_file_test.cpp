#include <bit>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cubemap/image/image_size.h"
#include "tests/cubemap/image/sample_files.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

class PfmFile : public testing::Test {
protected:
    static ImageFile decoded(const std::string& file) { return decode_text(file, "a.pfm"); }
    static std::string refusal(const std::string& file) {
        return message_of([&] { static_cast<void>(decoded(file)); });
    }
};

TEST_F(PfmFile, FilesOfOtherProgramsHaveTheirPixels) {
    for (const auto& path : samples("pfm")) {
        SCOPED_TRACE(path.filename());
        EXPECT_EQ(decode_file(path).pixels, ramp());
        EXPECT_EQ(read_image_size(path), (ImageSize{8, 4}));
    }
}

TEST_F(PfmFile, GreyOfTheOtherByteOrderFromBelow) {
    const ImageFile image = decoded({"Pf\n1 2\n1.0\n\x3f\x80\0\0\x40\0\0\0", 19});
    EXPECT_EQ(image.pixels, (std::vector<glm::vec3>{glm::vec3(2.0f), glm::vec3(1.0f)}));
    EXPECT_THAT(image.remarks, testing::ElementsAre("luminance only"));
}

/// As ImageMagick, OpenImageIO and pfstools do it.
TEST_F(PfmFile, AScaleIsMultipliedIn) {
    const ImageFile image = decoded({"Pf\n1 1\n-4\n\0\0\x80\x3f", 14});
    EXPECT_EQ(image.pixels[0], glm::vec3(4.0f));
    EXPECT_THAT(image.remarks, testing::Contains("the header's scale of 4 multiplied in"));
}

TEST_F(PfmFile, BadOnesAreRefused) {
    EXPECT_EQ(refusal("PF\n40000 40000\n-1\n"),
              "a.pfm: expected a size that an environment can have, got 40000x40000");
    EXPECT_EQ(refusal("PF\n8 4\n-1\nabcd"),
              "a.pfm: expected 384 bytes of pixels, got a file of 14 bytes");
    EXPECT_EQ(refusal("PF\n8 x\n-1\n"), "a.pfm: expected PF, width, height and scale, got 'x'");
    EXPECT_EQ(refusal("PF\n8 4\n0\n"), "a.pfm: expected a scale that is not 0, got 0");
    EXPECT_NE(refusal("PF\n8 4\nnan\n"), "");
    EXPECT_NE(refusal("PF\n-8 4\n-1\n"), "");
    EXPECT_NE(refusal("PF\n"), "");
}

} // namespace
} // namespace relumine::cubemap
