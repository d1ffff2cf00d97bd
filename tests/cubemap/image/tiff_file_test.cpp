#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cubemap/image/image_size.h"
#include "cubemap/resample/load_averaged.h"
#include "tests/cubemap/image/sample_files.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

/// A field of a little-endian file.
struct Field {
    int tag, type;
    std::uint32_t count, value;
};

void put(std::string& file, std::uint32_t value, int num_bytes) {
    for (int i = 0; i < num_bytes; ++i)
        file += static_cast<char>(value >> 8 * i & 0xff);
}

/// A TIFF of two pixels side by side, each of three floats; `changed` fields take the place of the
/// usual ones of their tags. Data follow the fields.
std::string tiff(const std::vector<Field>& changed, const std::string& data = {}) {
    constexpr int Short = 3, Long = 4;
    std::vector<Field> fields = {{256, Long, 1, 2},  {257, Long, 1, 1},  {258, Short, 1, 32},
                                 {259, Short, 1, 1}, {262, Short, 1, 2}, {273, Long, 1, 0},
                                 {277, Short, 1, 3}, {278, Long, 1, 1},  {279, Long, 1, 24},
                                 {339, Short, 1, 3}};
    for (const Field& each : changed) {
        const auto found = std::ranges::find(fields, each.tag, &Field::tag);
        if (found == fields.end())
            fields.push_back(each);
        else
            *found = each;
    }
    const auto end = static_cast<std::uint32_t>(8 + 2 + 12 * fields.size() + 4);
    std::string file("II*\0", 4);
    put(file, 8, 4);
    put(file, static_cast<std::uint32_t>(fields.size()), 2);
    for (const Field& each : fields) {
        put(file, static_cast<std::uint32_t>(each.tag), 2);
        put(file, static_cast<std::uint32_t>(each.type), 2);
        put(file, each.count, 4);
        put(file, each.tag == 273 && each.value == 0 ? end : each.value, 4);
    }
    put(file, 0, 4);
    if (!data.empty())
        return file + data;
    for (const float value : {1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f})
        put(file, std::bit_cast<std::uint32_t>(value), 4);
    return file;
}

class TiffFile : public testing::Test {
protected:
    static ImageFile decoded(const std::string& file) { return decode_text(file, "a.tif"); }
    static std::string refusal(const std::string& file) {
        return message_of([&] { static_cast<void>(decoded(file)); });
    }
};

TEST_F(TiffFile, FilesOfOtherProgramsHaveTheirPixels) {
    std::size_t num_files = 0;
    for (const auto& path : samples("tiff")) {
        SCOPED_TRACE(path.filename());
        const ImageFile image = decode_file(path);
        ASSERT_EQ(image.pixels.size(), 32u);
        std::vector<glm::vec3> expected = ramp();
        // ImageMagick 6 cuts light off at white, and rounds to 16 bits.
        const bool is_cut = path.filename().string().starts_with("imagemagick");
        for (std::size_t i = 0; i < expected.size(); ++i)
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(image.pixels[i][channel],
                            is_cut ? std::min(expected[i][channel], 1.0f) : expected[i][channel],
                            is_cut ? 1e-5f : 0.0f);
        EXPECT_EQ(image.is_half, path.filename().string().find("half") != std::string::npos);
        EXPECT_EQ(read_image_size(path), (ImageSize{8, 4}));
        ++num_files;
    }
    EXPECT_GE(num_files, 11u);
}

TEST_F(TiffFile, BandsAreTheSameAsTheWhole) {
    for (const auto& path : samples("tiff")) {
        const auto rows = open_tiff(FileBytes(path));
        const std::vector<glm::vec3> all = decode_file(path).pixels;
        for (std::uint32_t first = 0; first < 4; ++first)
            for (std::uint32_t last = first + 1; last <= 4; ++last) {
                std::vector<glm::vec3> band(8 * (last - first));
                rows->read(first, band);
                EXPECT_TRUE(std::equal(band.begin(), band.end(), all.begin() + 8 * first))
                    << path.filename() << ' ' << first << ' ' << last;
            }
    }
}

TEST_F(TiffFile, AWideOneIsAveragedAsItIsRead) {
    const EnvironmentImage image = load_averaged(sample("tiff/plain.tif"), {}, 4);
    EXPECT_EQ(image.width, 4u);
    EXPECT_NEAR(image.pixels[0].x, 1.5f, 1e-6f);
}

TEST_F(TiffFile, OrientationIsUndone) {
    const std::vector<glm::vec3> upright = decoded(tiff({})).pixels;
    EXPECT_EQ(upright, (std::vector<glm::vec3>{{1, 2, 3}, {4, 5, 6}}));
    const ImageFile turned = decoded(tiff({{274, 3, 1, 3}}));
    EXPECT_EQ(turned.pixels, (std::vector<glm::vec3>{{4, 5, 6}, {1, 2, 3}}));
    EXPECT_THAT(turned.remarks, testing::ElementsAre("Orientation 3 undone"));
    const std::vector<glm::vec3> column =
        decoded(tiff({{256, 4, 1, 1}, {257, 4, 1, 2}, {278, 4, 1, 2}, {274, 3, 1, 4}})).pixels;
    EXPECT_EQ(column, (std::vector<glm::vec3>{{4, 5, 6}, {1, 2, 3}})) << "the lowest row first";
    EXPECT_NE(refusal(tiff({{274, 3, 1, 6}})), "");
}

TEST_F(TiffFile, AlphaThatIsNotMultipliedIn) {
    std::string data;
    for (const float value : {8.0f, 4.0f, 2.0f, 0.5f, 8.0f, 4.0f, 2.0f, 0.0f})
        put(data, std::bit_cast<std::uint32_t>(value), 4);
    const auto with = [&](std::uint32_t kind) {
        return decoded(tiff({{277, 3, 1, 4}, {279, 4, 1, 32}, {338, 3, 1, kind}}, data));
    };
    EXPECT_EQ(with(2).pixels, (std::vector<glm::vec3>{{4, 2, 1}, {0, 0, 0}}));
    EXPECT_EQ(with(1).pixels, (std::vector<glm::vec3>{{8, 4, 2}, {8, 4, 2}}));
    EXPECT_EQ(with(0).pixels, (std::vector<glm::vec3>{{8, 4, 2}, {8, 4, 2}}));
    EXPECT_EQ(with(2).num_transparent, 1u);
    EXPECT_EQ(with(0).num_transparent, 0u) << "a channel that says nothing of itself";
}

TEST_F(TiffFile, GreyIsLuminance) {
    const ImageFile image = decoded(tiff({{262, 3, 1, 1}, {277, 3, 1, 1}, {279, 4, 1, 8}}));
    EXPECT_EQ(image.pixels, (std::vector<glm::vec3>{{1, 1, 1}, {2, 2, 2}}));
    EXPECT_THAT(image.remarks, testing::ElementsAre("luminance only"));
}

TEST_F(TiffFile, OthersAreRefusedByName) {
    EXPECT_EQ(refusal(tiff({{339, 3, 1, 1}, {258, 3, 1, 16}})),
              "a.tif: expected a TIFF of floats, got one of 16-bit integers, which hold no light "
              "above white");
    EXPECT_EQ(refusal(tiff({{262, 3, 1, 32845}})),
              "a.tif: expected a TIFF of RGB or grey, got one of LogLuv: save it as floats");
    EXPECT_EQ(refusal(tiff({{262, 3, 1, 6}})),
              "a.tif: expected a TIFF of RGB or grey, got one of YCbCr");
    EXPECT_EQ(refusal(tiff({{259, 3, 1, 7}})),
              "a.tif: expected a TIFF without compression or with LZW, deflate, zstd or PackBits, "
              "got compression 7");
    EXPECT_EQ(refusal(tiff({{256, 4, 1, 40000}, {257, 4, 1, 40000}})),
              "a.tif: expected a size that an environment can have, got 40000x40000");
    EXPECT_EQ(refusal(tiff({{256, 4, 1, 8000}, {257, 4, 1, 4000}})).substr(0, 48),
              "a.tif: expected data for 8000x4000 pixels, got 1");
    EXPECT_EQ(refusal(tiff({{257, 4, 1, 2}})), "a.tif: expected 2 strips or tiles, got 1");
    EXPECT_EQ(refusal(tiff({{279, 4, 1, 23}})),
              "a.tif: expected 1 rows, got broken data from row 0 on");
    EXPECT_EQ(refusal(std::string("II*\0\0\0\0\0", 8)),
              "a.tif: expected a TIFF picture, got a file that was not finished");
    EXPECT_NE(refusal(tiff({{258, 3, 0xffffffff, 0}})), "") << "4 G values";
    EXPECT_NE(
        refusal(tiff({{322, 4, 1, 1u << 30}, {323, 4, 1, 16}, {324, 4, 1, 8}, {325, 4, 1, 8}})),
        "");
    EXPECT_NE(refusal(tiff({{278, 4, 1, 0}})), "");
    for (const int packing : {5, 8, 32773, 50000})
        EXPECT_NE(refusal(tiff({{259, 3, 1, static_cast<std::uint32_t>(packing)}})), "") << packing;
}

TEST_F(TiffFile, TruncatedFilesAreRefused) {
    for (const auto& path : samples("tiff")) {
        const std::vector<std::byte> bytes = files::read(path);
        std::size_t num_refused = 0;
        for (std::size_t size = 4; size < bytes.size(); size += 7) {
            const auto part = std::span(bytes).first(size);
            try {
                static_cast<void>(whole(*open_tiff(FileBytes(part, "a"))));
            } catch (const std::runtime_error&) {
                ++num_refused;
            }
        }
        // What stands behind the last pixel need not be there.
        EXPECT_GT(num_refused, bytes.size() / 14) << path.filename();
    }
}

} // namespace
} // namespace relumine::cubemap
