#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfCompression.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfEnvmapAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "cubemap/image/image_file.h"
#include "cubemap/image/image_size.h"
#include "files/output_file.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

namespace fs = std::filesystem;

constexpr int Width = 70, Height = 35; // no multiple of any block size

/// Smooth pixels that every type holds exactly: whole numbers up to 2048.
std::vector<glm::vec3> whole_numbers(int width = Width, int height = Height) {
    std::vector<glm::vec3> pixels;
    for (int i = 0; i < width * height; ++i)
        pixels.emplace_back(i % width + i / width, i / width, 10 + i % width);
    return pixels;
}

struct Channel {
    std::string name;
    Imf::PixelType type = Imf::FLOAT;
    /// Of the pixels; the channel's content
    int component = 0;
};

/// Values in each channel's own type, kept while they are written.
class Buffers {
public:
    Buffers(const std::vector<Channel>& channels, const std::vector<glm::vec3>& pixels,
            const Imath::Box2i& window, Imf::ChannelList& list) {
        const int width = window.max.x - window.min.x + 1;
        halves_.resize(channels.size());
        floats_.resize(channels.size());
        uints_.resize(channels.size());
        for (std::size_t c = 0; c < channels.size(); ++c) {
            for (const glm::vec3& pixel : pixels) {
                const float value = pixel[channels[c].component];
                halves_[c].emplace_back(value);
                floats_[c].push_back(value);
                uints_[c].push_back(static_cast<unsigned>(value));
            }
            char* base = channels[c].type == Imf::HALF ? reinterpret_cast<char*>(halves_[c].data())
                         : channels[c].type == Imf::FLOAT
                             ? reinterpret_cast<char*>(floats_[c].data())
                             : reinterpret_cast<char*>(uints_[c].data());
            const std::ptrdiff_t size = channels[c].type == Imf::HALF ? 2 : 4;
            base -= (window.min.x + static_cast<std::ptrdiff_t>(window.min.y) * width) * size;
            list.insert(channels[c].name, Imf::Channel(channels[c].type));
            buffer.insert(channels[c].name,
                          Imf::Slice(channels[c].type, base, static_cast<std::size_t>(size),
                                     static_cast<std::size_t>(size * width)));
        }
    }
    Imf::FrameBuffer buffer;

private:
    std::vector<std::vector<Imath::half>> halves_;
    std::vector<std::vector<float>> floats_;
    std::vector<std::vector<unsigned>> uints_;
};

std::vector<Channel> rgb(Imf::PixelType type, const std::string& layer = "") {
    return {{layer + "R", type, 0}, {layer + "G", type, 1}, {layer + "B", type, 2}};
}

void write_scanlines(const fs::path& path, const std::vector<Channel>& channels,
                     const std::vector<glm::vec3>& pixels, Imf::Header header) {
    const Imath::Box2i window = header.dataWindow();
    const Buffers buffers(channels, pixels, window, header.channels());
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffers.buffer);
    file.writePixels(window.max.y - window.min.y + 1);
}

ImageFile decode(const fs::path& path) {
    return decode_exr(files::read(path), path.string());
}

std::string refusal_of_file(const fs::path& path) {
    return message_of([&] { (void)decode(path); });
}

/// What a compression may change.
float tolerance_of(int compression) {
    if (compression == Imf::B44_COMPRESSION || compression == Imf::B44A_COMPRESSION)
        return 0.2f;
    return compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION ? 0.05f
                                                                                        : 0.0f;
}

void expect_near(const std::vector<glm::vec3>& actual, const std::vector<glm::vec3>& expected,
                 float relative) {
    ASSERT_EQ(actual.size(), expected.size());
    for (std::size_t i = 0; i < actual.size(); ++i) {
        for (int channel = 0; channel < 3; ++channel)
            ASSERT_NEAR(actual[i][channel], expected[i][channel],
                        relative * (20.0f + std::abs(expected[i][channel])))
                << i;
    }
}

TEST(ExrFile, EveryCompressionAndTypeScanlineAndTiled) {
    const TemporaryFolder folder;
    for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
        for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT, Imf::UINT}) {
            Imf::Header header(Width, Height);
            header.compression() = static_cast<Imf::Compression>(compression);
            const float tolerance = tolerance_of(compression);
            SCOPED_TRACE(testing::Message() << "compression " << compression << " type " << type);
            write_scanlines(folder / "lines.exr", rgb(type), whole_numbers(), header);
            expect_near(decode(folder / "lines.exr").pixels, whole_numbers(), tolerance);

            for (const Imf::LevelMode mode :
                 {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
                Imf::Header tiled = header;
                tiled.setTileDescription(Imf::TileDescription(32, 16, mode));
                const Buffers buffers(rgb(type), whole_numbers(), tiled.dataWindow(),
                                      tiled.channels());
                {
                    Imf::TiledOutputFile file((folder / "tiles.exr").c_str(), tiled);
                    file.setFrameBuffer(buffers.buffer);
                    for (int y = 0; y < file.numYLevels(); ++y) {
                        for (int x = 0; x < file.numXLevels(); ++x) {
                            if (file.isValidLevel(x, y))
                                file.writeTiles(0, file.numXTiles(x) - 1, 0, file.numYTiles(y) - 1,
                                                x, y);
                        }
                    }
                }
                expect_near(decode(folder / "tiles.exr").pixels, whole_numbers(), tolerance);
            }
        }
    }
}

TEST(ExrFile, LargeImagesAreReadInBandsAndLinesOfAnyOrder) {
    const TemporaryFolder folder;
    const auto pixels = whole_numbers(64, 1100);
    for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
        for (const Imf::Compression compression :
             {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
            Imf::Header header(64, 1100);
            header.compression() = compression;
            header.lineOrder() = order;
            write_scanlines(folder / "a.exr", rgb(Imf::FLOAT), pixels, header);
            EXPECT_EQ(decode(folder / "a.exr").pixels, pixels);
        }
    }
    Imf::Header tiled(64, 1100);
    tiled.setTileDescription(Imf::TileDescription(48, 300, Imf::ONE_LEVEL));
    const Buffers buffers(rgb(Imf::FLOAT), pixels, tiled.dataWindow(), tiled.channels());
    {
        Imf::TiledOutputFile file((folder / "b.exr").c_str(), tiled);
        file.setFrameBuffer(buffers.buffer);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    }
    EXPECT_EQ(decode(folder / "b.exr").pixels, pixels);
}

TEST(ExrFile, AlphaAndExtraChannelsAreIgnored) {
    const TemporaryFolder folder;
    auto channels = rgb(Imf::HALF);
    channels.push_back({"A", Imf::HALF, 1});
    channels.push_back({"Z", Imf::FLOAT, 2});
    channels.push_back({"diffuse.R", Imf::FLOAT, 2});
    write_scanlines(folder / "a.exr", channels, whole_numbers(), Imf::Header(Width, Height));
    const ImageFile image = decode(folder / "a.exr");
    EXPECT_EQ(image.pixels, whole_numbers());
    EXPECT_TRUE(image.remarks.empty());
}

TEST(ExrFile, OfManyLayersThePictureIsTaken) {
    const TemporaryFolder folder;
    std::vector<Channel> channels = rgb(Imf::FLOAT, "ViewLayer.DiffDir.");
    for (const Channel& each : rgb(Imf::FLOAT, "ViewLayer.Combined."))
        channels.push_back(each);
    write_scanlines(folder / "a.exr", channels, whole_numbers(), Imf::Header(Width, Height));
    const ImageFile image = decode(folder / "a.exr");
    EXPECT_EQ(image.pixels, whole_numbers());
    EXPECT_EQ(image.remarks, std::vector<std::string>{"layer ViewLayer.Combined"});
    // Two pictures are a question.
    for (const Channel& each : rgb(Imf::FLOAT, "Other.beauty."))
        channels.push_back(each);
    write_scanlines(folder / "b.exr", channels, whole_numbers(), Imf::Header(Width, Height));
    EXPECT_THROW(static_cast<void>(decode(folder / "b.exr")), std::runtime_error);
}

TEST(ExrFile, ChannelsMayBeSmallLetters) {
    const TemporaryFolder folder;
    write_scanlines(folder / "a.exr",
                    {{"r", Imf::FLOAT, 0}, {"g", Imf::FLOAT, 1}, {"b", Imf::FLOAT, 2}},
                    whole_numbers(), Imf::Header(Width, Height));
    EXPECT_EQ(decode(folder / "a.exr").pixels, whole_numbers());
}

TEST(ExrFile, TheOnlyLayerWithColourIsTaken) {
    const TemporaryFolder folder;
    auto channels = rgb(Imf::FLOAT, "sky.dome.");
    channels.push_back({"depth.Z", Imf::FLOAT, 2});
    write_scanlines(folder / "a.exr", channels, whole_numbers(), Imf::Header(Width, Height));
    const ImageFile image = decode(folder / "a.exr");
    EXPECT_EQ(image.pixels, whole_numbers());
    EXPECT_EQ(image.remarks, std::vector<std::string>{"layer sky.dome"});

    for (const Channel& channel : rgb(Imf::FLOAT, "ground."))
        channels.push_back(channel);
    write_scanlines(folder / "b.exr", channels, whole_numbers(), Imf::Header(Width, Height));
    EXPECT_NE(refusal_of_file(folder / "b.exr")
                  .find("expected channels R, G and B, or Y, got depth.Z, ground.B"),
              std::string::npos)
        << refusal_of_file(folder / "b.exr");
}

TEST(ExrFile, LuminanceIsGrey) {
    const TemporaryFolder folder;
    write_scanlines(folder / "a.exr", {{"Y", Imf::FLOAT, 0}}, whole_numbers(),
                    Imf::Header(Width, Height));
    const ImageFile image = decode(folder / "a.exr");
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        ASSERT_EQ(image.pixels[i], glm::vec3(whole_numbers()[i].x));
    EXPECT_EQ(image.remarks, std::vector<std::string>{"luminance only"});
}

TEST(ExrFile, LuminanceAndChromaAreConverted) {
    const TemporaryFolder folder;
    for (const Imath::V2i& offset : {Imath::V2i(0, 0), Imath::V2i(-6, 10)}) {
        Imf::Header header(80, 40);
        header.dataWindow() = header.displayWindow() =
            Imath::Box2i(offset, offset + Imath::V2i(79, 39));
        {
            Imf::RgbaOutputFile file((folder / "a.exr").c_str(), header, Imf::WRITE_YC);
            const std::vector<Imf::Rgba> pixels(80 * 40, Imf::Rgba(0.8f, 0.4f, 0.2f));
            file.setFrameBuffer(pixels.data() - (offset.x + offset.y * 80), 1, 80);
            file.writePixels(40);
        }
        const ImageFile image = decode(folder / "a.exr");
        ASSERT_EQ(image.pixels.size(), 3200u);
        expect_near(image.pixels, std::vector<glm::vec3>(3200, {0.8f, 0.4f, 0.2f}), 5e-4f);
        EXPECT_EQ(image.remarks, std::vector<std::string>{"luminance and chroma"});
    }
}

TEST(ExrFile, TheDataWindowMayLieAnywhere) {
    const TemporaryFolder folder;
    for (const Imath::V2i& offset :
         {Imath::V2i(5, 9), Imath::V2i(-100, -3), Imath::V2i(1000000000, -1000000000)}) {
        Imf::Header header(Width, Height);
        header.dataWindow() = header.displayWindow() =
            Imath::Box2i(offset, offset + Imath::V2i(Width - 1, Height - 1));
        write_scanlines(folder / "a.exr", rgb(Imf::HALF), whole_numbers(), header);
        EXPECT_EQ(decode(folder / "a.exr").pixels, whole_numbers());
    }
}

TEST(ExrFile, OutsideTheDataWindowAnEnvironmentIsBlack) {
    const TemporaryFolder folder;
    Imf::Header header(100, 50);
    header.dataWindow() = Imath::Box2i({10, 5}, {10 + Width - 1, 5 + Height - 1});
    write_scanlines(folder / "a.exr", rgb(Imf::HALF), whole_numbers(), header);
    const ImageFile image = decode(folder / "a.exr");
    EXPECT_EQ(image.width, 100u);
    EXPECT_EQ(image.height, 50u);
    EXPECT_EQ(image.pixels[0], glm::vec3(0.0f));
    EXPECT_EQ(image.pixels[100 * 5 + 10], whole_numbers()[0]);
    EXPECT_EQ(image.pixels[100 * 39 + 79], whole_numbers().back());
    EXPECT_EQ(image.pixels[100 * 39 + 80], glm::vec3(0.0f));
    EXPECT_EQ(image.remarks, std::vector<std::string>{"black outside the data window"});

    // A display window of other proportions says nothing about environments.
    header.displayWindow() = Imath::Box2i({0, 0}, {120, 50});
    write_scanlines(folder / "b.exr", rgb(Imf::HALF), whole_numbers(), header);
    EXPECT_EQ(decode(folder / "b.exr").width, 70u);
}

// A sun of 200,000 is infinite in 16-bit floats, and the rest of the sky says nothing of it.
TEST(ExrFile, WhatHalvesCannotHoldIsTheMostThatTheyHold) {
    constexpr int Side = 32;
    std::vector<glm::vec3> pixels(std::size_t{2} * Side * Side, glm::vec3(0.5f));
    pixels[40] = glm::vec3(2e5f, 1e5f, 3.0f);
    const TemporaryFolder folder;
    const Imf::Header header(2 * Side, Side);
    for (const bool is_half : {true, false}) {
        write_scanlines(folder / "a.exr", rgb(is_half ? Imf::HALF : Imf::FLOAT), pixels, header);
        const EnvironmentImage image = load_environment(folder / "a.exr", {.fix_bad_pixels = true});
        EXPECT_EQ(image.fixed, is_half);
        EXPECT_EQ(image.pixels[40], is_half ? glm::vec3(65504.0f, 65504.0f, 3.0f) : pixels[40]);
        EXPECT_EQ(image.infinity_became, is_half ? 65504.0f : 0.0f);
    }
}

TEST(ExrFile, OverscanIsCutOff) {
    constexpr int Wide = 72; // no environment's proportions
    const std::vector<glm::vec3> pixels = whole_numbers(Wide, Height);
    const TemporaryFolder folder;
    Imf::Header header(60, 30);
    header.dataWindow() = Imath::Box2i({-4, -2}, {-4 + Wide - 1, -2 + Height - 1});
    write_scanlines(folder / "a.exr", rgb(Imf::HALF), pixels, header);
    const ImageFile image = decode(folder / "a.exr");
    ASSERT_EQ(image.width, 60u);
    ASSERT_EQ(image.height, 30u);
    EXPECT_EQ(image.pixels[0], pixels[Wide * 2 + 4]);
    EXPECT_EQ(image.pixels[60 * 29 + 59], pixels[Wide * 31 + 63]);
    EXPECT_EQ(image.remarks, std::vector<std::string>{"cut to the display window"});
    EXPECT_EQ(read_image_size(folder / "a.exr"), (ImageSize{60, 30}));
    // It may reach out on one side, and be short on another.
    header.dataWindow() = Imath::Box2i({-4, 7}, {-4 + Wide - 1, 7 + Height - 1});
    write_scanlines(folder / "b.exr", rgb(Imf::HALF), pixels, header);
    const ImageFile partly = decode(folder / "b.exr");
    EXPECT_EQ(partly.pixels[60 * 6 + 59], glm::vec3(0.0f));
    EXPECT_EQ(partly.pixels[60 * 7], pixels[4]);
    EXPECT_EQ(partly.remarks.size(), 2u);
}

TEST(ExrFile, AttributesAreReported) {
    const TemporaryFolder folder;
    Imf::Header header(Width, Height);
    Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
    Imf::addChromaticities(header, Imf::Chromaticities());
    write_scanlines(folder / "a.exr", rgb(Imf::HALF), whole_numbers(), header);
    const ImageFile image = decode(folder / "a.exr");
    EXPECT_EQ(image.envmap, Layout::LatLong);
    EXPECT_TRUE(image.remarks.empty()) << "the usual chromaticities are those of Rec. 709";
}

/// A picture of one colour, with a header of its own.
ImageFile decoded(const Imf::Header& header, const glm::vec3& color) {
    const TemporaryFolder folder;
    write_scanlines(folder / "a.exr", rgb(Imf::FLOAT),
                    std::vector<glm::vec3>(std::size_t{Width} * Height, color), header);
    return decode(folder / "a.exr");
}

TEST(ExrFile, ChromaticitiesAreConverted) {
    Imf::Header header(Width, Height);
    Imf::addChromaticities(
        header, {{0.713f, 0.293f}, {0.165f, 0.830f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}});
    // Rec. 709's 1, 0.2, 0.05 in ACEScg.
    const ImageFile image = decoded(header, {0.684323f, 0.254196f, 0.085943f});
    EXPECT_LT(glm::distance(image.pixels[5], glm::vec3(1.0f, 0.2f, 0.05f)), 2e-3f);
    EXPECT_EQ(image.remarks, std::vector<std::string>{"ACEScg converted to Rec. 709"});
    // A green that Rec. 709 has not is cut off, and said.
    const ImageFile green = decoded(header, {0.0f, 1.0f, 0.0f});
    EXPECT_EQ(green.pixels[0].r, 0.0f);
    EXPECT_THAT(green.remarks,
                testing::ElementsAre(testing::HasSubstr("cannot show the colour of")));
}

TEST(ExrFile, TheSpaceThatBlenderNamesHolds) {
    Imf::Header header(Width, Height);
    header.insert("colorInteropID", Imf::StringAttribute("srgb_rec709_display"));
    const ImageFile image = decoded(header, glm::vec3(0.5f));
    EXPECT_NEAR(image.pixels[0].r, 0.21404f, 1e-5f);
    EXPECT_EQ(image.remarks, std::vector<std::string>{"srgb_rec709_display converted to Rec. 709"});
    header.insert("colorInteropID", Imf::StringAttribute("lin_rec709_scene"));
    EXPECT_EQ(decoded(header, glm::vec3(0.5f)).pixels[0].r, 0.5f);
}

TEST(ExrFile, ChromaticitiesOnALineArePassedOver) {
    Imf::Header header(Width, Height);
    Imf::addChromaticities(header, {{0.3f, 0.3f}, {0.4f, 0.4f}, {0.5f, 0.5f}, {0.31f, 0.33f}});
    const ImageFile image = decoded(header, glm::vec3(0.5f));
    EXPECT_EQ(image.pixels[0], glm::vec3(0.5f));
    EXPECT_THAT(image.remarks, testing::ElementsAre(testing::HasSubstr("passed over")));
}

TEST(ExrFile, TheFirstPartWithColourIsTaken) {
    const TemporaryFolder folder;
    std::array<Imf::Header, 3> headers = {Imf::Header(8, 8), Imf::Header(Width, Height),
                                          Imf::Header(4, 4)};
    const std::vector<glm::vec3> small(64, glm::vec3(1.0f));
    const Buffers depth({{"Z", Imf::FLOAT, 0}}, small, headers[0].dataWindow(),
                        headers[0].channels());
    const Buffers colour(rgb(Imf::FLOAT), whole_numbers(), headers[1].dataWindow(),
                         headers[1].channels());
    const Buffers other(rgb(Imf::FLOAT), small, headers[2].dataWindow(), headers[2].channels());
    for (std::size_t i = 0; i < 3; ++i) {
        headers[i].setName("part" + std::to_string(i));
        headers[i].setType(Imf::SCANLINEIMAGE);
    }
    {
        Imf::MultiPartOutputFile file((folder / "a.exr").c_str(), headers.data(), 3, true);
        const std::array<const Buffers*, 3> buffers = {&depth, &colour, &other};
        for (int i = 0; i < 3; ++i) {
            Imf::OutputPart part(file, i);
            part.setFrameBuffer(buffers[static_cast<std::size_t>(i)]->buffer);
            part.writePixels(headers[static_cast<std::size_t>(i)].dataWindow().max.y + 1);
        }
    }
    const ImageFile image = decode(folder / "a.exr");
    EXPECT_EQ(image.pixels, whole_numbers());
    EXPECT_EQ(image.remarks, std::vector<std::string>{"part 2 of 3"});
}

TEST(ExrFile, FilesWithoutColourNameTheirChannels) {
    const TemporaryFolder folder;
    write_scanlines(folder / "a.exr", {{"Z", Imf::FLOAT, 0}, {"R", Imf::HALF, 1}}, whole_numbers(),
                    Imf::Header(Width, Height));
    EXPECT_EQ(refusal_of_file(folder / "a.exr"),
              (folder / "a.exr").string() + ": expected channels R, G and B, or Y, got R, Z");
    write_scanlines(folder / "a.exr", {{"Z\xff\x1b[2J", Imf::FLOAT, 0}}, whole_numbers(),
                    Imf::Header(Width, Height));
    EXPECT_EQ(refusal_of_file(folder / "a.exr"),
              (folder / "a.exr").string() + ": expected channels R, G and B, or Y, got Z??[2J");
}

TEST(ExrFile, RoundTripIsExact) {
    EnvironmentImage image = black_image(Layout::Cube, Sampling::Borders, 13);
    fill_randomly(image.pixels, 1);
    const ImageFile back = decode_exr(encode_exr(image), "name");
    EXPECT_EQ(back.pixels, image.pixels);
    EXPECT_EQ(back.envmap, Layout::Cube);
    image.sampling = Sampling::TexelCentres;
    EXPECT_EQ(decode_exr(encode_exr(image), "name").envmap, std::nullopt);
}

TEST(ExrFile, PixelsOfAlphaZeroAreCounted) {
    const TemporaryFolder folder;
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 1200, 600);
    image.alpha.assign(image.pixels.size(), 1.0f);
    std::fill_n(image.alpha.begin(), 1300, 0.0f);
    image.alpha.back() = 0.0f;
    const auto num_transparent = [&](const EnvironmentImage& of) {
        const std::vector<std::byte> bytes = encode_exr(of);
        std::ofstream(folder / "a.exr", std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        return load_environment(folder / "a.exr").num_transparent;
    };
    EXPECT_EQ(num_transparent(image), 1301u);
    image.alpha.clear();
    EXPECT_EQ(num_transparent(image), 0u);
}

TEST(ExrFile, OpenExrReadsWhatIsWritten) {
    const TemporaryFolder folder;
    // Rows that are no multiple of a block's 16, and noise that deflate cannot make smaller.
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 70, 35);
    std::uint32_t state = 1;
    const auto noise = [&] {
        state = state * 1664525u + 1013904223u;
        return std::bit_cast<float>((state >> 2) ^ (state << 17 & 0x3fffffffu));
    };
    for (std::size_t i = image.pixels.size() / 2; i < image.pixels.size(); ++i)
        image.pixels[i] = {noise(), noise(), noise()};
    image.alpha.assign(image.pixels.size(), 0.5f);
    image.alpha[3] = 0.25f;
    std::vector<glm::vec3> layer(image.pixels.rbegin(), image.pixels.rend());
    const std::vector<ExrLayer> layers = {{"a lamp", layer}};
    const std::vector<std::byte> bytes = encode_exr(image, layers);
    std::ofstream(folder / "a.exr", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    Imf::InputFile file((folder / "a.exr").c_str());
    EXPECT_TRUE(file.isComplete());
    EXPECT_EQ(file.header().compression(), Imf::ZIP_COMPRESSION);
    const auto expect_channel = [&](const char* name, const float* expected, std::size_t step) {
        std::vector<float> values(image.pixels.size());
        Imf::FrameBuffer buffer;
        buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 280));
        file.setFrameBuffer(buffer);
        file.readPixels(0, 34);
        for (std::size_t i = 0; i < values.size(); ++i)
            ASSERT_EQ(std::bit_cast<std::uint32_t>(values[i]),
                      std::bit_cast<std::uint32_t>(expected[i * step]))
                << name << " " << i;
    };
    expect_channel("A", image.alpha.data(), 1);
    expect_channel("R", &image.pixels[0].x, 3);
    expect_channel("G", &image.pixels[0].y, 3);
    expect_channel("B", &image.pixels[0].z, 3);
    expect_channel("a lamp.R", &layer[0].x, 3);
    expect_channel("a lamp.B", &layer[0].z, 3);
}

TEST(ExrFile, AConstantPictureInAnyCompressionIsNoBomb) {
    const TemporaryFolder folder;
    for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
        Imf::Header header(4096, 2048);
        header.compression() = static_cast<Imf::Compression>(compression);
        std::vector<Imath::half> line(4096, Imath::half(0.0f));
        Imf::FrameBuffer buffer;
        for (const char* channel : {"R", "G", "B"}) {
            header.channels().insert(channel, Imf::Channel(Imf::HALF));
            buffer.insert(channel,
                          Imf::Slice(Imf::HALF, reinterpret_cast<char*>(line.data()), 2, 0));
        }
        if (compression == Imf::NO_COMPRESSION || compression == Imf::B44_COMPRESSION ||
            compression == Imf::RLE_COMPRESSION)
            continue; // large files; nothing to learn
        {
            Imf::OutputFile file((folder / "a.exr").c_str(), header);
            file.setFrameBuffer(buffer);
            file.writePixels(2048);
        }
        EXPECT_EQ(refusal_of_file(folder / "a.exr"), "") << compression;
    }
}

TEST(ExrFile, DeclaredSizesBeyondTheFileAreRefusedAtOnce) {
    std::vector<std::byte> bytes =
        encode_exr(black_image(Layout::LatLong, Sampling::TexelCentres, 16));
    // The data window's maximum follows the attribute's name, type and size, and its minimum.
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t at =
        text.find("dataWindow") + std::strlen("dataWindow") + 1 + std::strlen("box2i") + 1 + 4 + 8;
    for (const int size : {20000, 100000, 0x7ffffffe}) {
        std::memcpy(&bytes[at], &size, 4);
        std::memcpy(&bytes[at + 4], &size, 4);
        EXPECT_NE(message_of([&] { (void)decode_exr(bytes, "name"); }).find("name: expected"),
                  std::string::npos)
            << size;
    }
}

TEST(ExrFile, WhatTheHeaderDeclaresIsInTheFileOrRefused) {
    const TemporaryFolder folder;
    const std::vector<std::byte> good =
        encode_exr(black_image(Layout::LatLong, Sampling::Borders, 18));
    const std::string text(reinterpret_cast<const char*>(good.data()), good.size());
    // Puts a number at an offset behind an attribute's name; both ways in say what is wrong, before
    // memory is allocated.
    const auto expect_refused = [&](std::string_view attribute, std::size_t offset,
                                    std::uint32_t value, std::string_view reason) {
        std::vector<std::byte> bad = good;
        std::memcpy(&bad[text.find(attribute) + attribute.size() + offset], &value, sizeof value);
        const std::string message = message_of([&] { (void)decode_exr(bad, "name"); });
        EXPECT_NE(message.find(reason), std::string::npos) << message;
        std::ofstream(folder / "bad.exr", std::ios::binary)
            .write(reinterpret_cast<const char*>(bad.data()),
                   static_cast<std::streamsize>(bad.size()));
        EXPECT_NE(message_of([&] { (void)exr_size(folder / "bad.exr"); }).find(reason),
                  std::string::npos);
    };
    using std::string_view_literals::operator""sv;
    expect_refused("screenWindowWidth\0float\0"sv, 0, 0x70000000,
                   "an attribute of 1879048192 bytes");
    expect_refused("screenWindowWidth\0float\0"sv, 0, 0xffffffff,
                   "an attribute of 4294967295 bytes");
    expect_refused("dataWindow\0box2i\0"sv, 4 + 12, 0x7ffffffe,
                   "a table of 134217728 or more chunks");
    expect_refused("dataWindow\0box2i\0"sv, 4 + 8, 0x7ffffffe, "blocks of 412316860224 bytes");
}

TEST(ExrFile, WhatIsNoTextIsNotQuoted) {
    std::vector<std::byte> bad = encode_exr(black_image(Layout::LatLong, Sampling::Borders, 18));
    // An attribute of one byte, whose type has a name that is none.
    const std::string attribute("type\0\xfftring\0\1\0\0\0x", 17);
    const auto* bytes = reinterpret_cast<const std::byte*>(attribute.data());
    bad.insert(bad.begin() + 8, bytes, bytes + attribute.size());
    const std::string message = message_of([&] { (void)decode_exr(bad, "name"); });
    EXPECT_NE(message.find("\" tring\""), std::string::npos) << message;
}

TEST(ExrFile, TruncationsAreRefusedAndCorruptionsDoNoHarm) {
    const TemporaryFolder folder;
    std::vector<std::vector<std::byte>> files;
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::Borders, 18);
    fill_randomly(image.pixels, 2);
    files.push_back(encode_exr(image));
    Imf::Header tiled(20, 10);
    tiled.compression() = Imf::PIZ_COMPRESSION;
    tiled.setTileDescription(Imf::TileDescription(8, 8, Imf::MIPMAP_LEVELS));
    const Buffers buffers(rgb(Imf::HALF), whole_numbers(20, 10), tiled.dataWindow(),
                          tiled.channels());
    {
        Imf::TiledOutputFile file((folder / "tiles.exr").c_str(), tiled);
        file.setFrameBuffer(buffers.buffer);
        for (int level = 0; level < file.numLevels(); ++level)
            file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    }
    files.push_back(files::read(folder / "tiles.exr"));
    for (std::size_t f = 0; f < files.size(); ++f) {
        const std::vector<std::byte>& good = files[f];
        std::size_t num_read = 0;
        for (std::size_t length = 0; length < good.size(); ++length) {
            const std::string message =
                message_of([&] { (void)decode_exr(std::span(good).first(length), "name"); });
            num_read += message.empty() ? 1u : 0u;
            ASSERT_TRUE(message.empty() || message.starts_with("name: expected ")) << message;
            ASSERT_EQ(message.find('\n'), std::string::npos);
        }
        // The smaller levels at the end of a mip-mapped file are not read.
        EXPECT_LE(num_read, f == 0 ? 0u : 1200u);
        for (std::size_t i = 0; i < good.size(); ++i) {
            for (const int flip : {0x01, 0x80, 0xff}) {
                std::vector<std::byte> bad = good;
                bad[i] ^= static_cast<std::byte>(flip);
                const std::string message = message_of([&] { (void)decode_exr(bad, "name"); });
                ASSERT_TRUE(message.empty() || message.starts_with("name: expected ")) << message;
            }
        }
    }
}

} // namespace
} // namespace relumine::cubemap
