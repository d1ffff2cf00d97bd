#include "mesh/materials/texture.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <span>

#include "files/output_file.h"
#include "tests/mesh/mesh_files.h"
#include "tests/mesh/texture_files.h"

namespace relumine::mesh {
namespace {

Texture decoded(const std::string& file, VOrigin origin = VOrigin::Top) {
    ImageBudget budget;
    return decode_texture(bytes_of(file), origin, budget);
}

void expect_color(const glm::vec3& got, const glm::vec3& expected) {
    EXPECT_NEAR(glm::distance(got, expected), 0.0f, 1e-6f) << got.r << ' ' << got.g << ' ' << got.b;
}

TEST(Texture, RowsStartWhereVDoes) {
    const Texture top = decoded(four_colors());
    EXPECT_EQ(top.width, 2u);
    EXPECT_EQ(top.texels, (std::vector<Rgb8>{Red, Green, Blue, Gray}));
    EXPECT_EQ(decoded(four_colors(), VOrigin::Bottom).texels,
              (std::vector<Rgb8>{Blue, Gray, Red, Green}));
}

/// Red, green, blue and grey, of alpha 255, 128, 255 and 51, as Pillow writes them.
TEST(Texture, OfAvif) {
    const std::filesystem::path samples = RELUMINE_SAMPLES;
    const std::vector<std::byte> file = files::read(samples / "texture/pillow.avif");
    ImageBudget budget;
#ifdef RELUMINE_HDR_PHOTOS
    const Texture colors = decode_texture(file, VOrigin::Top, budget);
    const Texture alpha = decode_alpha_texture(file, VOrigin::Top, budget);
    ASSERT_EQ(colors.texels.size(), 16u * 16u);
    constexpr std::array<Rgb8, 4> Colors = {Red, Green, Blue, Rgb8{188, 188, 188}};
    constexpr std::array<int, 4> Alphas = {255, 128, 255, 51};
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t at = (4 + 8 * (i / 2)) * 16 + 4 + 8 * (i % 2);
        for (std::size_t channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(colors.texels[at][channel], Colors[i][channel], 2) << i;
        EXPECT_NEAR(alpha.texels[at][0], Alphas[i], 2) << i;
    }
    EXPECT_TRUE(colors.file.empty()) << "scene files are for builds without AVIF, too";
    const std::vector<std::byte> bright = files::read(samples / "avif/avifenc_pq.avif");
    expect_refusal([&] { return decode_texture(bright, VOrigin::Top, budget); },
                   "expected an AVIF of colours, got one by PQ or HLG");
    expect_refusal(
        [&] {
            return decode_texture(std::span(file).first(file.size() / 2), VOrigin::Top, budget);
        },
        "expected a whole AVIF picture, got");
#else
    expect_refusal([&] { return decode_texture(file, VOrigin::Top, budget); },
                   "got AVIF, which takes a build with RELUMINE_HDR_PHOTOS");
#endif
}

TEST(Texture, BilinearBetweenTexelCentres) {
    const Texture texture = decoded(four_colors());
    const TextureSlot clamped{.wrap = {Wrap::Clamp, Wrap::Clamp}};
    expect_color(sample(texture, clamped, {0.25f, 0.25f}), {1, 0, 0});
    expect_color(sample(texture, clamped, {0.75f, 0.25f}), {0, 1, 0});
    expect_color(sample(texture, clamped, {0.25f, 0.75f}), {0, 0, 1});
    expect_color(sample(texture, clamped, {0.5f, 0.25f}), {0.5f, 0.5f, 0});
    expect_color(sample(texture, clamped, {0.625f, 0.25f}), {0.25f, 0.75f, 0});
    const float gray = 128.0f / 255.0f;
    expect_color(sample(texture, clamped, {0.5f, 0.5f}),
                 glm::vec3(1 + gray, 1 + gray, 1 + gray) * 0.25f);
}

TEST(Texture, WrapModes) {
    const Texture texture = decoded(png(4, 1, {Red, Green, Blue, Gray}));
    const auto at = [&](float u, Wrap wrap) {
        return sample(texture, {.wrap = {wrap, wrap}}, {u, 0.5f});
    };
    const float gray = 128.0f / 255.0f;
    // Repeat: left of the first texel comes the last.
    expect_color(at(1.125f, Wrap::Repeat), {1, 0, 0});
    expect_color(at(-0.125f, Wrap::Repeat), glm::vec3(gray));
    expect_color(at(0.0f, Wrap::Repeat), 0.5f * (glm::vec3(1, 0, 0) + gray));
    expect_color(at(7.375f, Wrap::Repeat), {0, 1, 0});
    expect_color(at(-3.625f, Wrap::Repeat), {0, 1, 0});
    expect_color(at(0.0f, Wrap::Clamp), {1, 0, 0});
    expect_color(at(-5.0f, Wrap::Clamp), {1, 0, 0});
    expect_color(at(9.0f, Wrap::Clamp), glm::vec3(gray));
    expect_color(at(0.0f, Wrap::Mirror), {1, 0, 0});
    expect_color(at(-0.375f, Wrap::Mirror), {0, 1, 0});
    expect_color(at(1.375f, Wrap::Mirror), {0, 0, 1});
    expect_color(at(2.375f, Wrap::Mirror), {0, 1, 0});
    // Whatever a file has as uv is looked up somewhere.
    for (const float u : {NAN, INFINITY, 1e30f, -1e30f})
        for (const Wrap wrap : {Wrap::Repeat, Wrap::Clamp, Wrap::Mirror})
            EXPECT_TRUE(std::isfinite(at(u, wrap).r)) << u;
}

TEST(Texture, SrgbIsDecodedBeforeFiltering) {
    const Texture texture = decoded(png(2, 1, {Rgb8{0, 128, 10}, Rgb8{255, 128, 10}}));
    const TextureSlot slot{.is_srgb = true, .wrap = {Wrap::Clamp, Wrap::Clamp}};
    const glm::vec3 middle = sample(texture, slot, {0.5f, 0.5f});
    EXPECT_NEAR(middle.r, 0.5f, 1e-6f);
    EXPECT_NEAR(middle.g, std::pow((128.0 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
    EXPECT_NEAR(middle.b, 10.0 / 255.0 / 12.92, 1e-6);
}

TEST(Texture, UvTransform) {
    const Texture texture = decoded(four_colors());
    const TextureSlot slot{.uv_from_mesh_uv = glm::mat2(0.0f, 1.0f, 2.0f, 0.0f),
                           .uv_offset = {0.25f, 0.25f}};
    expect_color(sample(texture, slot, {0.5f, 0.0f}), {0, 0, 1}); // u' = 2 v + 1/4, v' = u + 1/4
    expect_color(sample(texture, slot, {0.0f, 0.25f}), {0, 1, 0});
}

TEST(Texture, RefusesWhatIsNoImage) {
    const std::string image = four_colors();
    expect_refusal([] { return decoded(""); }, "image");
    expect_refusal([] { return decoded("no image at all"); }, "15 bytes of something else");
    expect_refusal([&] { return decoded(image.substr(0, image.size() / 2)); }, "image");
    std::string huge = image;
    huge[16] = 0, huge[17] = 1; // 65538 pixels wide
    expect_refusal([&] { return decoded(huge); }, "at most 16384 x 16384 pixels");
    huge = image;
    huge[18] = huge[22] = 0x3f; // 16130 x 16130 in a hundred bytes
    expect_refusal([&] { return decoded(huge); }, "the data of 16130 x 16130 pixels");
    for (std::size_t end = 0; end < image.size(); ++end)
        try {
            static_cast<void>(decoded(image.substr(0, end)));
        } catch (const std::runtime_error& error) {
            EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
        }
}

/// A PNG file of 2 x 2 pixels of RGB with the deflate stream.
std::string png_of(const std::string& deflated) {
    const auto chunk = [](const std::string& type, const std::string& data) {
        const auto size = static_cast<std::uint32_t>(data.size());
        std::string length;
        for (const std::uint32_t shift : {24u, 16u, 8u, 0u})
            length += static_cast<char>(size >> shift & 0xffu);
        return length + type + data + "sums";
    };
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", std::string("\0\0\0\2\0\0\0\2\x8\2\0\0\0", 13)) +
           chunk("IDAT", "\x78\x01" + deflated) + chunk("IEND", "");
}

/// A deflate stream of a zero and 258 more for each run, in a block of fixed codes.
std::string zeros_deflated(int num_runs) {
    std::string bytes;
    int num_bits = 0;
    const auto put = [&](const char* bits) {
        for (; *bits != 0; ++bits, ++num_bits) {
            if (num_bits % 8 == 0)
                bytes += '\0';
            if (*bits == '1')
                bytes.back() = static_cast<char>(bytes.back() | 1 << (num_bits % 8));
        }
    };
    put("110"); // the last block
    put("00110000");
    for (int i = 0; i < num_runs; ++i)
        put("1100010100000"); // 258 times the byte before
    put("0000000");
    return bytes + "sums";
}

TEST(Texture, APngHasNoMoreDataThanItsPixels) {
    EXPECT_EQ(decoded(png_of(zeros_deflated(1))).texels, std::vector<Rgb8>(4));
    // A million bytes for 2 x 2 pixels, in 7 KB.
    expect_refusal([] { return decoded(png_of(zeros_deflated(4000))); },
                   "broken data: 'more than its pixels take'");
    // A block of the kind that does not exist, for which stb_image has no words.
    expect_refusal([] { return decoded(png_of("\x7")); }, "broken data: 'an unknown fault'");
}

TEST(Texture, TheImagesOfAFileHaveOneBudget) {
    constexpr std::uint64_t Cheap = std::uint64_t{1} << 28;
    ImageBudget budget;
    EXPECT_TRUE(budget.allows(Cheap - 12, 0));
    const std::string image = four_colors();
    static_cast<void>(decode_texture(bytes_of(image), VOrigin::Top, budget));
    EXPECT_FALSE(budget.allows(Cheap, 1000));
    expect_refusal([&] { return decode_texture(bytes_of(image), VOrigin::Top, budget); },
                   "images that the bytes of their files and the memory allow");
    EXPECT_TRUE(ImageBudget().allows(512 * 600'000, 600'000)) << "a file of many bytes";
    EXPECT_FALSE(ImageBudget().allows(std::uint64_t{1} << 60, std::uint64_t{1} << 60));
}

/// A BMP or TGA file of 3 x 2 pixels by the writer.
template<typename Writer>
std::string written(const Writer& writer) {
    const std::vector<Rgb8> pixels = {Red, Green, Blue, Gray, Red, Red};
    std::string file;
    const auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                              static_cast<std::size_t>(size));
    };
    writer(append, &file, 3, 2, 3, pixels.data());
    return file;
}

TEST(Texture, WhatAShortFileLacksIsNotMadeUp) {
    stbi_write_tga_with_rle = 0;
    for (const std::string& file :
         {written(stbi_write_bmp_to_func), written(stbi_write_tga_to_func)}) {
        EXPECT_EQ(decoded(file).texels, (std::vector<Rgb8>{Red, Green, Blue, Gray, Red, Red}));
        for (std::size_t missing = 1; missing <= 18; ++missing)
            expect_refusal([&] { return decoded(file.substr(0, file.size() - missing)); },
                           "expected the data of 3 x 2 pixels");
    }
}

TEST(Texture, JpegsAreReadWholeOrRefused) {
    std::string file;
    const auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                              static_cast<std::size_t>(size));
    };
    const std::vector<Rgb8> orange(40 * 24, {250, 130, 10});
    stbi_write_jpg_to_func(append, &file, 40, 24, 3, orange.data(), 95);
    const Texture texture = decoded(file);
    EXPECT_EQ(texture.width, 40u);
    EXPECT_EQ(texture.height, 24u);
    for (const Rgb8& texel : texture.texels)
        for (std::size_t channel = 0; channel < 3; ++channel)
            ASSERT_NEAR(texel[channel], orange[0][channel], 3.0);
    std::vector<std::uint8_t> gray(40 * 24, 77);
    file.clear();
    stbi_write_jpg_to_func(append, &file, 40, 24, 1, gray.data(), 95);
    EXPECT_NEAR(decoded(file).texels.back()[2], 77.0, 2.0);
    for (std::size_t end = 4; end < file.size(); ++end)
        expect_refusal([&] { return decoded(file.substr(0, end)); }, "broken data (");
    file[file.find("\xff\xc0") + 5] = 0x7f; // 32536 rows
    expect_refusal([&] { return decoded(file); },
                   "expected an image of at most 16384 x 16384 pixels");
}

TEST(Texture, OtherFormatsAreNotEvenTried) {
    for (const std::string file :
         {"P52\n5252\n5222P", "P6 2 2 255 ............", "GIF89a........................",
          "8BPS......................", "#?RADIANCE\n\n-Y 1 +X 1\n...."})
        expect_refusal([&] { return decoded(file); }, "of something else");
}

} // namespace
} // namespace relumine::mesh
