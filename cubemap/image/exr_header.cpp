// Based on: the OpenEXR file layout, https://openexr.com/en/latest/OpenEXRFileLayout.html.
#include "cubemap/image/exr_header.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace relumine::cubemap {

namespace {

/// The numbers that decide how much OpenEXR allocates for a part. All have 64 bits, so differences
/// and products of windows fit.
struct Part {
    std::int64_t width = 0, height = 0;
    /// 0: the part has rows, not tiles.
    std::int64_t tile_width = 0, tile_height = 0;
    std::int64_t rows_per_block = 1;
    std::int64_t bytes_per_pixel = 0;
    /// The declared number of chunks. Empty: not declared.
    std::optional<std::int64_t> num_chunks = {};
};

/// Indexed by the number of the compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA,
/// DWAB.
constexpr std::array<std::int64_t, 10> RowsPerBlock = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

/// A block up to CheapBlock bytes is allowed in any file. A larger block may have at most
/// LargestRatio times the size of the file, as whole images in exr_file.cpp.
constexpr std::uint64_t CheapBlock = std::uint64_t{256} << 20, LargestRatio = 4000;

struct FixedSize {
    std::string_view type;
    std::int64_t size;
};
constexpr std::array FixedSizes = {FixedSize{"box2f", 16},
                                   FixedSize{"box2i", 16},
                                   FixedSize{"chromaticities", 32},
                                   FixedSize{"compression", 1},
                                   FixedSize{"deepImageState", 1},
                                   FixedSize{"double", 8},
                                   FixedSize{"envmap", 1},
                                   FixedSize{"float", 4},
                                   FixedSize{"int", 4},
                                   FixedSize{"keycode", 28},
                                   FixedSize{"lineOrder", 1},
                                   FixedSize{"m33d", 72},
                                   FixedSize{"m33f", 36},
                                   FixedSize{"m44d", 128},
                                   FixedSize{"m44f", 64},
                                   FixedSize{"rational", 8},
                                   FixedSize{"tiledesc", 9},
                                   FixedSize{"timecode", 8},
                                   FixedSize{"v2d", 16},
                                   FixedSize{"v2f", 8},
                                   FixedSize{"v2i", 8},
                                   FixedSize{"v3d", 24},
                                   FixedSize{"v3f", 12},
                                   FixedSize{"v3i", 12}};

class HeaderWalk {
public:
    HeaderWalk(Imf::IStream& stream, std::uint64_t num_bytes)
        : stream_(stream), num_bytes_(num_bytes) {}

    void check() {
        static_cast<void>(number()); // the magic number
        const auto version = static_cast<std::uint32_t>(number());
        constexpr std::uint32_t MultiPart = 0x1000;
        std::vector<Part> parts;
        while (std::optional<Part> part = read_part()) {
            parts.push_back(*part);
            if ((version & MultiPart) == 0)
                break;
        }
        std::uint64_t num_chunks = 0;
        for (const Part& part : parts) {
            check_block(part);
            num_chunks += chunks_of(part);
            if (num_chunks > rest() / sizeof(std::uint64_t))
                throw std::runtime_error(fmt::format(
                    "a table of {} or more chunks in a file of {} bytes", num_chunks, num_bytes_));
        }
        stream_.seekg(0);
    }

private:
    [[nodiscard]] std::uint64_t rest() {
        return num_bytes_ - std::min<std::uint64_t>(stream_.tellg(), num_bytes_);
    }

    void read(char* to, std::uint64_t count) {
        if (count > rest())
            throw std::runtime_error("the header ends too early");
        stream_.read(to, static_cast<int>(count));
    }

    std::int64_t number() {
        std::int32_t value = 0; // little-endian, like our processors
        read(reinterpret_cast<char*>(&value), sizeof value);
        return value;
    }

    std::string text() {
        constexpr std::size_t MaxLength = 255;
        std::string result;
        for (char c = 0; read(&c, 1), c != '\0';) {
            result += c;
            if (result.size() > MaxLength)
                throw std::runtime_error("a name without an end in its header");
        }
        return result;
    }

    /// Reads a part's header. Returns nothing for an empty header, which ends the list of parts.
    std::optional<Part> read_part() {
        Part part;
        bool is_empty = true;
        for (std::string name = text(); !name.empty(); name = text()) {
            is_empty = false;
            const std::string type = text();
            const std::int64_t size = number();
            if (size < 0 || static_cast<std::uint64_t>(size) > rest())
                throw std::runtime_error(fmt::format("an attribute of {} bytes in a file of {}",
                                                     static_cast<std::uint32_t>(size), num_bytes_));
            const std::uint64_t end = stream_.tellg() + static_cast<std::uint64_t>(size);
            read_attribute(name, type, size, part);
            stream_.seekg(end);
        }
        return is_empty ? std::nullopt : std::optional(part);
    }

    /// Reads one attribute. For a known type, OpenEXR reads as far as the content says, whatever
    /// size is declared, and takes the next attribute from there.
    void read_attribute(const std::string& name, const std::string& type, std::int64_t size,
                        Part& part) {
        const auto fixed = std::find_if(FixedSizes.begin(), FixedSizes.end(),
                                        [&](const FixedSize& known) { return known.type == type; });
        if (fixed != FixedSizes.end() && fixed->size != size)
            throw std::runtime_error(fmt::format("a {} of {} bytes", type, size));
        if (name == "dataWindow" && type == "box2i") {
            const std::int64_t x0 = number(), y0 = number();
            part.width = number() - x0 + 1;
            part.height = number() - y0 + 1;
        } else if (name == "tiles" && type == "tiledesc") {
            part.tile_width = unsigned_number();
            part.tile_height = unsigned_number();
        } else if (name == "chunkCount" && type == "int") {
            part.num_chunks = number();
        } else if (name == "compression" && type == "compression") {
            unsigned char compression = 0;
            read(reinterpret_cast<char*>(&compression), 1);
            if (compression < RowsPerBlock.size())
                part.rows_per_block = RowsPerBlock[compression];
        } else if (type == "chlist") {
            part.bytes_per_pixel = read_channels(size);
        } else if (type == "stringvector") {
            check_strings(size);
        } else if (type == "preview") {
            const std::int64_t width = unsigned_number(), height = unsigned_number();
            if (width > size || height > size || width * height * 4 + 8 != size)
                throw std::runtime_error(
                    fmt::format("a preview of {}x{} pixels in {} bytes", width, height, size));
        }
    }

    std::int64_t unsigned_number() { return static_cast<std::uint32_t>(number()); }

    /// Reads names with 16 bytes each, up to an empty name. Returns the bytes of a pixel.
    std::int64_t read_channels(std::int64_t size) {
        const std::uint64_t end = stream_.tellg() + static_cast<std::uint64_t>(size);
        std::int64_t bytes_per_pixel = 0;
        while (!text().empty()) {
            constexpr std::int64_t Half = 1;
            bytes_per_pixel += number() == Half ? 2 : 4;
            for (int i = 0; i < 3; ++i)
                static_cast<void>(number());
        }
        if (stream_.tellg() != end)
            throw std::runtime_error(
                fmt::format("a list of channels that is not {} bytes long", size));
        return bytes_per_pixel;
    }

    void check_strings(std::int64_t size) {
        while (size > 0) {
            const std::int64_t length = size < 4 ? -1 : number();
            size -= 4 + length;
            if (length < 0 || size < 0)
                throw std::runtime_error("a list of strings that is not as long as it says");
            stream_.seekg(stream_.tellg() + static_cast<std::uint64_t>(length));
        }
    }

    void check_block(const Part& part) const {
        if (part.width < 1 || part.height < 1)
            return;
        const bool is_tiled = part.tile_width > 0 && part.tile_height > 0;
        // In double, because a product of four 32-bit numbers does not fit into 64 bits.
        const double num_pixels =
            is_tiled ? static_cast<double>(part.tile_width) * static_cast<double>(part.tile_height)
                     : static_cast<double>(part.width) * static_cast<double>(part.rows_per_block);
        const double size = num_pixels * static_cast<double>(part.bytes_per_pixel);
        if (size > static_cast<double>(std::max(CheapBlock, num_bytes_ * LargestRatio)))
            throw std::runtime_error(
                fmt::format("blocks of {:.0f} bytes in a file of {}", size, num_bytes_));
    }

    /// Returns the declared number of chunks, or the number at the finest level. Coarser levels
    /// have fewer.
    static std::uint64_t chunks_of(const Part& part) {
        if (part.num_chunks)
            return static_cast<std::uint64_t>(std::max<std::int64_t>(*part.num_chunks, 0));
        if (part.width < 1 || part.height < 1)
            return 0;
        const auto divided = [](std::int64_t a, std::int64_t b) {
            return static_cast<std::uint64_t>((a + b - 1) / b);
        };
        if (part.tile_width > 0 && part.tile_height > 0)
            return divided(part.width, part.tile_width) * divided(part.height, part.tile_height);
        return divided(part.height, part.rows_per_block);
    }

    Imf::IStream& stream_;
    std::uint64_t num_bytes_;
};

} // namespace

void check_exr_header(Imf::IStream& stream, std::uint64_t num_bytes) {
    HeaderWalk(stream, num_bytes).check();
}

} // namespace relumine::cubemap
