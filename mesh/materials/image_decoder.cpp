// stb_image is compiled here for three formats. Debian's library reads ten, and has faults:
// fourteen bytes that begin like a PNM picture end the program, and missing bytes of a short file
// are read as whatever the memory held. Its JPEG decoder writes beyond its tables if a file
// declares too many Huffman codes; libjpeg does not.
#include "mesh/materials/image_decoder.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <webp/decode.h>

namespace {

/// The most bytes that stb_image may take in one piece. It would inflate all data of a PNG, however
/// few pixels they are for.
thread_local std::size_t largest_piece = 0;
thread_local bool is_piece_refused = false;

void* limited_realloc(void* bytes, std::size_t size) {
    is_piece_refused |= size > largest_piece;
    return size > largest_piece ? nullptr : std::realloc(bytes, size);
}

} // namespace

#define STBI_MALLOC(size) limited_realloc(nullptr, size)
#define STBI_REALLOC(bytes, size) limited_realloc(bytes, size)
#define STBI_FREE(bytes) std::free(bytes)
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_ONLY_BMP
#define STBI_ONLY_PNG
#define STBI_ONLY_TGA
#include <stb_image.h>

#include "files/avif_decoder.h"
#include "files/jpeg_decoder.h"
#include "mesh/materials/texture.h"
#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

/// Decodes into the memory that `allocate(width, height)` returns, [height * width * 3], or 4 with
/// alpha, from the top left.
void decode_webp(std::span<const std::byte> file, bool with_alpha,
                 const std::function<std::uint8_t*(std::uint32_t, std::uint32_t)>& allocate) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(file.data());
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(bytes, file.size(), &features) != VP8_STATUS_OK)
        throw std::runtime_error("expected a WebP image, got broken data");
    if (features.has_animation != 0)
        throw std::runtime_error("expected a WebP image, got an animation");
    const auto width = static_cast<std::uint32_t>(features.width);
    const auto height = static_cast<std::uint32_t>(features.height);
    std::uint8_t* pixels = allocate(width, height);
    const int num_channels = with_alpha ? 4 : 3;
    const auto decode = with_alpha ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
    if (decode(bytes, file.size(), pixels,
               std::size_t{width} * height * static_cast<std::size_t>(num_channels),
               features.width * num_channels) == nullptr)
        throw std::runtime_error(fmt::format(
            "expected a whole image of {} x {} pixels, got broken data", width, height));
}

/// Returns an unsigned number, low byte first. Bytes beyond the end count as 0.
std::uint64_t number_at(std::span<const std::byte> file, std::size_t at, std::size_t num_bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < num_bytes && at + i < file.size(); ++i)
        value |= std::to_integer<std::uint64_t>(file[at + i]) << (8 * i);
    return value;
}

/// Returns the fewest bytes that the rows of an image of this size can take.
std::uint64_t least_bytes(ImageFormat format, std::span<const std::byte> file, std::uint64_t width,
                          std::uint64_t height) {
    const std::uint64_t num_pixels = width * height;
    switch (format) {
    case ImageFormat::Png: // deflate packs at most 1032 to 1, and a pixel has at least one bit
        return num_pixels / 1032 / 8;
    // A block of 64 takes at least a bit, and chroma may be four times as coarse in each direction.
    case ImageFormat::Jpeg:
        return num_pixels / 1024;
    case ImageFormat::WebP: // one colour takes no bytes at all
    case ImageFormat::Avif:
        return 0;
    // stb_image reads only uncompressed files. Rows end at multiples of four bytes.
    case ImageFormat::Bmp: {
        const std::uint64_t data = number_at(file, 10, 4);
        const std::uint64_t bits = number_at(file, number_at(file, 14, 4) == 12 ? 24 : 28, 2);
        return data + (width * bits + 31) / 32 * 4 * height;
    }
    case ImageFormat::Tga: {
        const std::uint64_t kind = number_at(file, 2, 1), bits = number_at(file, 16, 1);
        const std::uint64_t num_bytes = num_pixels * ((bits + 7) / 8);
        return (kind & 8) != 0 ? num_pixels / 64
                               : 18 + num_bytes; // a run of 128 pixels takes at least two bytes
    }
    }
    return 0;
}

/// Checks the sizes of chunks, because stb_image allocates what a chunk declares before it reads
/// the chunk.
void check_png_chunks(std::span<const std::byte> file) {
    constexpr std::size_t Signature = 8, Around = 12; // length, type, checksum
    const auto length_at = [&](std::size_t at) {      // high byte first
        std::uint64_t length = 0;
        for (std::size_t i = 0; i < 4; ++i)
            length = length << 8 | std::to_integer<std::uint64_t>(file[at + i]);
        return length;
    };
    for (std::size_t at = Signature; at + Around <= file.size();) {
        const std::uint64_t length = length_at(at);
        if (length > file.size() - at - Around)
            throw std::runtime_error(
                fmt::format("expected PNG chunks inside the file, got one of {} bytes", length));
        if (std::memcmp(file.data() + at + 4, "IEND", 4) == 0)
            return;
        at += Around + length;
    }
    throw std::runtime_error("expected a PNG image with its end, got none");
}

void check_size(std::span<const std::byte> file, std::uint64_t width, std::uint64_t height,
                std::uint64_t bytes_per_pixel, ImageBudget& budget) {
    if (width < 1 || height < 1 || width > MaxImageEdge || height > MaxImageEdge)
        throw std::runtime_error(
            fmt::format("expected an image of at most {0} x {0} pixels, got {1} x {2}",
                        MaxImageEdge, width, height));
    if (least_bytes(image_format(file), file, width, height) > file.size())
        throw std::runtime_error(fmt::format("expected the data of {} x {} pixels, got {} bytes",
                                             width, height, file.size()));
    if (!budget.allows(width * height * bytes_per_pixel, file.size()))
        throw std::runtime_error(
            fmt::format("expected images that the bytes of their files and the memory allow, got "
                        "{} x {} pixels more in {} bytes",
                        width, height, file.size()));
}

/// Decodes what stb_image reads: PNG, BMP, TGA and some older ones.
void decode_by_stb(std::span<const std::byte> file, int num_channels, ImageBudget& budget,
                   DecodedImage& image) {
    const auto* bytes = reinterpret_cast<const stbi_uc*>(file.data());
    const int num_bytes = static_cast<int>(file.size());
    int width = 0, height = 0, channels = 0;
    largest_piece = file.size() + 4096; // a header
    if (file.empty() || stbi_info_from_memory(bytes, num_bytes, &width, &height, &channels) == 0)
        throw std::runtime_error(fmt::format(
            "expected a PNG, JPEG, WebP, BMP or TGA image, got {} bytes of something else",
            file.size()));
    if (image_format(file) == ImageFormat::Png)
        check_png_chunks(file);
    const bool is_16_bit = stbi_is_16_bit_from_memory(bytes, num_bytes) != 0;
    const auto bytes_per_pixel =
        static_cast<std::uint64_t>(std::max(num_channels, channels * (is_16_bit ? 2 : 1)));
    image.width = static_cast<std::uint32_t>(std::max(width, 0));
    image.height = static_cast<std::uint32_t>(std::max(height, 0));
    check_size(file, image.width, image.height, bytes_per_pixel, budget);
    // Pieces double where they were too small. Rows have a byte more, and interlaced ones up to 8
    // pixels.
    largest_piece = 2 * (file.size() + 4096 +
                         (image.width + 8ull) * (image.height + 8ull) * (bytes_per_pixel + 1));
    is_piece_refused = false;
    stbi__g_failure_reason = nullptr; // of an image before
    image.bytes.reset(
        stbi_load_from_memory(bytes, num_bytes, &width, &height, &channels, num_channels));
    const char* reason = stbi_failure_reason(); // null for some faults of the data
    if (!image.bytes)
        throw std::runtime_error(
            fmt::format("expected a whole image of {} x {} pixels, got broken data: {}",
                        image.width, image.height,
                        excerpt(is_piece_refused    ? "more than its pixels take"
                                : reason == nullptr ? "an unknown fault"
                                                    : reason))); // may quote the file
}

/// Numbers of 10 and 12 bits become 8. Light above white would be cut off, on a curve that no
/// texture has.
template<class Allocate>
void decode_avif(std::span<const std::byte> file, int num_channels, const Allocate& allocate) {
#ifdef RELUMINE_HDR_PHOTOS
    const files::AvifPicture picture(file);
    const files::AvifPicture::Head& head = picture.head();
    if (head.transfer == head.Pq || head.transfer == head.Hlg)
        throw std::runtime_error("expected an AVIF of colours, got one by PQ or HLG");
    if (head.is_turned)
        throw std::runtime_error("expected an AVIF as it lies, got one that its file turns");
    std::uint8_t* const bytes = allocate(head.width, head.height);
    picture.decode(std::span(bytes, std::size_t{head.width} * head.height *
                                        static_cast<std::size_t>(num_channels)),
                   num_channels == 4);
#else
    static_cast<void>(file), static_cast<void>(num_channels), static_cast<void>(allocate);
    throw std::runtime_error("expected a PNG, JPEG, WebP, BMP or TGA image, got AVIF, which takes "
                             "a build with RELUMINE_HDR_PHOTOS");
#endif
}

/// Decodes to bytes of RGB (3 channels) or RGBA (4; not JPEG).
DecodedImage decode(std::span<const std::byte> file, int num_channels, ImageBudget& budget) {
    if (file.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw std::runtime_error(
            fmt::format("expected an image below 2 GiB, got {} bytes", file.size()));
    if (as_text(file).starts_with("\xabKTX 20\xbb"))
        throw std::runtime_error(
            "expected a PNG, JPEG, WebP, BMP or TGA image, got KTX 2, which is not read");
    DecodedImage image{.bytes = {nullptr, std::free}};
    const auto allocate = [&](std::uint32_t width, std::uint32_t height) {
        const auto pixel = static_cast<std::uint64_t>(num_channels);
        check_size(file, width, height, pixel, budget);
        image.width = width;
        image.height = height;
        image.bytes.reset(static_cast<std::uint8_t*>(std::malloc(pixel * width * height)));
        if (!image.bytes)
            throw std::bad_alloc();
        return image.bytes.get();
    };
    const ImageFormat format = image_format(file);
    if (format == ImageFormat::Jpeg)
        files::decode_jpeg(file, allocate);
    else if (format == ImageFormat::WebP)
        decode_webp(file, num_channels == 4, allocate);
    else if (format == ImageFormat::Avif)
        decode_avif(file, num_channels, allocate);
    else
        decode_by_stb(file, num_channels, budget, image);
    return image;
}

} // namespace

ImageFormat image_format(std::span<const std::byte> file) {
    const auto begins_with = [&](std::string_view magic) {
        return file.size() >= magic.size() &&
               std::memcmp(file.data(), magic.data(), magic.size()) == 0;
    };
    const bool is_webp =
        begins_with("RIFF") && file.size() >= 12 && std::memcmp(file.data() + 8, "WEBP", 4) == 0;
    return begins_with("\x89PNG")        ? ImageFormat::Png
           : begins_with("\xff\xd8\xff") ? ImageFormat::Jpeg
           : is_webp                     ? ImageFormat::WebP
           : files::is_avif(file)        ? ImageFormat::Avif
           : begins_with("BM")           ? ImageFormat::Bmp
                                         : ImageFormat::Tga;
}

DecodedImage decode_image(std::span<const std::byte> file, ImageBudget& budget) {
    return decode(file, 3, budget);
}

DecodedImage decode_alpha(std::span<const std::byte> file, ImageBudget& budget) {
    if (image_format(file) == ImageFormat::Jpeg) {
        DecodedImage image{.width = 1,
                           .height = 1,
                           .bytes = {static_cast<std::uint8_t*>(std::malloc(1)), std::free}};
        if (!image.bytes)
            throw std::bad_alloc();
        *image.bytes = 255;
        return image;
    }
    DecodedImage image = decode(file, 4, budget);
    const std::size_t num_pixels = std::size_t{image.width} * image.height;
    for (std::size_t i = 0; i < num_pixels; ++i)
        image.bytes.get()[i] = image.bytes.get()[4 * i + 3];
    return image;
}

} // namespace relumine::mesh
