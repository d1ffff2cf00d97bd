#include <algorithm>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cubemap/face.h"
#include "cubemap/image/convention.h"
#include "cubemap/image/image_size.h"
#include "tests/cubemap/image/sample_files.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

constexpr int Size = 4;

/// What the samples have at (x, y) of a face, in Direct3D's order of faces.
glm::vec3 sample_pixel(int face, int x, int y) {
    return {face + 1, x + 1, 4 * (y + 1)};
}

/// The samples' cube as our faces have it: as Direct3D shows it, +Z and -Z exchanged.
std::vector<glm::vec3> sample_cube() {
    std::vector<glm::vec3> pixels;
    for (const int face : {0, 1, 2, 3, 5, 4})
        for (int y = 0; y < Size; ++y)
            for (int x = 0; x < Size; ++x)
                pixels.push_back(sample_pixel(face, x, y));
    return pixels;
}

void put(std::string& file, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
        file += static_cast<char>(value >> 8 * i & 0xff);
}

/// A KTX 1 cube of R11G11B10. `type` is OpenGL's, or what filament's cmgen writes for it.
std::string packed_ktx(std::uint32_t type) {
    std::string file("\xabKTX 11\xbb\r\n\x1a\n", 12);
    for (const std::uint32_t value :
         {0x04030201u, type, 1u, 0x1907u, 0x8c3au, 0x8c3au, 4u, 4u, 0u, 0u, 6u, 1u, 0u, 64u})
        put(file, value);
    // Small whole numbers as floats of 5 bits of exponent and 6 (5) of mantissa.
    const auto small = [](int value, int num_mantissa_bits) {
        const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
        return ((bits >> 23) - 127 + 15) << num_mantissa_bits |
               (bits >> (23 - num_mantissa_bits) & ((1u << num_mantissa_bits) - 1));
    };
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < Size; ++y)
            for (int x = 0; x < Size; ++x)
                put(file, small(face + 1, 6) | small(x + 1, 6) << 11 | small(4 * (y + 1), 5) << 22);
    return file;
}

std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Writes a number into a file.
std::string changed(std::string file, std::size_t at, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
        file[at + static_cast<std::size_t>(i)] = static_cast<char>(value >> 8 * i & 0xff);
    return file;
}

class TextureFile : public testing::Test {
protected:
    static ImageFile decoded(const std::string& file) { return decode_text(file, "a"); }
    static std::string refusal(const std::string& file) {
        return message_of([&] { static_cast<void>(decoded(file)); });
    }
};

/// By DirectXTex and by ktx-parse; every format holds these numbers.
TEST_F(TextureFile, CubesOfOtherProgramsHaveTheirPixels) {
    for (const char* name : {"dds/float3.dds", "dds/float4_direct3d9.dds", "dds/half4_levels.dds",
                             "dds/r11g11b10.dds", "dds/r9g9b9e5.dds", "ktx/float3.ktx2",
                             "ktx/half4.ktx2", "ktx/half4_zstd.ktx2", "ktx/r9g9b9e5.ktx2"}) {
        SCOPED_TRACE(name);
        const ImageFile image = decode_file(sample(name));
        EXPECT_EQ(image.layout, Layout::Cube);
        EXPECT_EQ(image.faces_of, FacesOf::Direct3D);
        EXPECT_EQ(image.pixels, sample_cube());
        EXPECT_EQ(read_image_size(sample(name)), (ImageSize{4, 24}));
    }
}

/// cmft made them all of one lat-long, whose light is 4 (3/2 + direction). Its rows of 3 halves are
/// 24 bytes.
TEST_F(TextureFile, CubesOfCmftAreTurnedAndNotMirrored) {
    const ImageFile image = decode_file(sample("ktx/cmft_float4.ktx"));
    ASSERT_EQ(image.pixels.size(), 96u);
    std::size_t index = 0;
    for (const Face face : AllFaces)
        for (int y = 0; y < Size; ++y)
            for (int x = 0; x < Size; ++x) {
                const glm::dvec3 d = direction(face, (x + 0.5) / Size, (y + 0.5) / Size);
                const glm::vec3 light = image.pixels[index++];
                // cmft has -Z in the middle of a lat-long, we have +Z.
                EXPECT_NEAR(light.x / 4 - 1.5f, -d.x, 0.03);
                EXPECT_NEAR(light.y / 4 - 1.5f, d.y, 0.03);
                EXPECT_NEAR(light.z / 4 - 1.5f, -d.z, 0.03);
            }
    for (const char* name : {"ktx/cmft_half3.ktx", "dds/cmft_half4.dds"}) {
        const ImageFile half = decode_file(sample(name));
        EXPECT_TRUE(half.is_half);
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(half.pixels[i][channel], image.pixels[i][channel],
                            image.pixels[i][channel] / 2048.0f)
                    << name;
    }
}

/// DirectXTex packed the samples' cube, and unpacked it again.
TEST_F(TextureFile, BlocksAreAsDirectXTexUnpacksThem) {
    for (const std::string name : {"dds/bc6h_unsigned", "dds/bc6h_signed"}) {
        const ImageFile image = decode_file(sample(name + ".dds"));
        EXPECT_EQ(image.pixels.size(), 96u);
        EXPECT_TRUE(image.is_half);
        EXPECT_EQ(image.pixels, decode_file(sample(name + "_decoded.dds")).pixels) << name;
    }
}

TEST_F(TextureFile, MirroredFacesOfCmgenAreOurWorldAndStillThoseOfOpenGl) {
    const ImageFile plain = decoded(packed_ktx(0x8c3b));
    EXPECT_EQ(plain.pixels, sample_cube());
    const ImageFile mirrored = decoded(packed_ktx(0x8c3a));
    EXPECT_EQ(mirrored.faces_of, FacesOf::OpenGl);

    // A plain lookup of a direction in OpenGL's table 8.19.
    std::size_t index = 0;
    for (const Face face : AllFaces)
        for (int y = 0; y < Size; ++y)
            for (int x = 0; x < Size; ++x) {
                const glm::dvec3 d = direction(face, (x + 0.5) / Size, (y + 0.5) / Size);
                const glm::dvec3 a = glm::abs(d);
                int at = 0;
                double s = 0.0, t = 0.0;
                if (a.x > a.y && a.x > a.z) {
                    at = d.x > 0 ? 0 : 1;
                    s = (d.x > 0 ? -d.z : d.z) / a.x;
                    t = -d.y / a.x;
                } else if (a.y > a.z) {
                    at = d.y > 0 ? 2 : 3;
                    s = d.x / a.y;
                    t = (d.y > 0 ? d.z : -d.z) / a.y;
                } else {
                    at = d.z > 0 ? 4 : 5;
                    s = (d.z > 0 ? d.x : -d.x) / a.z;
                    t = -d.y / a.z;
                }
                const auto place = [](double u) {
                    return static_cast<int>((u + 1.0) / 2.0 * Size);
                };
                EXPECT_EQ(mirrored.pixels[index++], sample_pixel(at, place(s), place(t)));
            }

    // Who names the convention gets the faces as the file has them.
    const TemporaryFolder folder;
    std::ofstream(folder / "a.ktx", std::ios::binary) << packed_ktx(0x8c3a);
    EnvironmentImage image = load_environment(folder / "a.ktx");
    take_faces(*find_convention("opengl"), image);
    EXPECT_EQ(image.pixels, sample_cube());
    EnvironmentImage ours = load_environment(folder / "a.ktx");
    take_faces(*find_convention("openexr"), ours);
    EXPECT_EQ(ours.pixels, mirrored.pixels);
}

TEST_F(TextureFile, ColoursOfTheDescriptorAreConverted) {
    const ImageFile image = decode_file(sample("ktx/float3_rec2020.ktx2"));
    EXPECT_THAT(image.remarks,
                testing::Contains(testing::StartsWith("lin_rec2020_scene converted to Rec. 709")));
    EXPECT_NE(image.pixels, sample_cube());
}

TEST_F(TextureFile, OthersAreRefusedByName) {
    const std::string dds = text_of(sample("dds/float3.dds")),
                      ktx2 = text_of(sample("ktx/half4.ktx2"));
    constexpr std::size_t DxgiFormat = 128, DdsHeight = 12, DdsWidth = 16;
    EXPECT_EQ(refusal(changed(dds, DxgiFormat, 28)),
              "a: expected a texture of floats, halves, R11G11B10, R9G9B9E5 or BC6H, got DXGI "
              "format 28");
    EXPECT_EQ(refusal(changed(dds, DdsWidth, 8)), "a: expected square faces, got 8x4");
    EXPECT_EQ(refusal(changed(changed(dds, DdsWidth, 40000), DdsHeight, 40000)),
              "a: expected a size that an environment can have, got 40000x240000");
    EXPECT_EQ(refusal(dds.substr(0, dds.size() - 1)), "a: expected 1300 bytes, got a file of 1299 "
                                                      "bytes");
    const std::string old = text_of(sample("dds/float4_direct3d9.dds"));
    constexpr std::size_t Caps2 = 112;
    EXPECT_EQ(refusal(changed(old, Caps2, 0x600)), "a: expected all faces of a cube, got some");
    constexpr std::size_t VkFormat = 12, Packing = 44, Layers = 32;
    EXPECT_EQ(refusal(changed(ktx2, VkFormat, 0)),
              "a: expected a texture of floats, halves, R11G11B10, R9G9B9E5 or BC6H, got one of "
              "Basis Universal");
    EXPECT_EQ(refusal(changed(ktx2, Packing, 3)),
              "a: expected a KTX 2 file without supercompression or with zstd, got scheme 3");
    EXPECT_EQ(refusal(changed(ktx2, Layers, 2)),
              "a: expected a cube or one picture, got 2 layers of 6 faces, 0 deep");
    EXPECT_EQ(refusal(changed(text_of(sample("ktx/half4_zstd.ktx2")), 20, 5).substr(0, 400)),
              "a: expected square faces, got 5x4");
    for (const char* folder : {"dds", "ktx"})
        for (const auto& path : samples(folder)) {
            const std::string file = text_of(path);
            for (std::size_t size = 12; size < file.size() / 2; size += 13)
                EXPECT_NE(refusal(file.substr(0, size)), "") << path.filename() << ' ' << size;
        }
}

} // namespace
} // namespace relumine::cubemap
