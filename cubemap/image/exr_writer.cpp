// Writes OpenEXR pictures in memory.
//
// OpenEXR writes the header. The blocks of pixels are compressed here, with libdeflate: it takes
// less than half of the time of zlib, which OpenEXR before 3.2 uses, for the same size. They have
// the form of ZIP_COMPRESSION in OpenEXR's ImfZip.cpp, so every reader reads them.
#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <libdeflate.h>

#include "cubemap/image/image_file.h"
#include "cubemap/image/image_layout.h"
#include "files/output_file.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

class MemoryOutput : public Imf::OStream {
public:
    MemoryOutput() : Imf::OStream("file") {}
    void write(const char* source, int n) override {
        const std::size_t end = position_ + static_cast<std::size_t>(n);
        if (end > bytes.size())
            bytes.resize(end);
        std::memcpy(bytes.data() + position_, source, static_cast<std::size_t>(n));
        position_ = end;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }

    std::vector<std::byte> bytes;

private:
    std::size_t position_ = 0;
};

/// The values of a channel, row by row.
struct Channel {
    std::string name;
    const float* values;
    /// Floats from pixel to pixel.
    std::size_t step;
};

/// Returns the channels in the order of their names, in which OpenEXR keeps them.
std::vector<Channel> channels_of(const EnvironmentImage& image, std::span<const ExrLayer> layers) {
    std::vector<Channel> channels;
    const auto add = [&](const std::string& prefix, std::span<const glm::vec3> pixels) {
        const auto* const values = reinterpret_cast<const float*>(pixels.data());
        for (std::size_t i = 0; i < 3; ++i)
            channels.push_back({prefix + "RGB"[i], values + i, 3});
    };
    add("", image.pixels);
    for (const ExrLayer& layer : layers)
        add(layer.name + ".", layer.pixels);
    if (!image.alpha.empty())
        channels.push_back({"A", image.alpha.data(), 1});
    std::sort(channels.begin(), channels.end(),
              [](const Channel& a, const Channel& b) { return a.name < b.name; });
    return channels;
}

void put_little_endian(std::byte* to, std::uint64_t value, int num_bytes) {
    for (int i = 0; i < num_bytes; ++i)
        to[i] = static_cast<std::byte>(value >> (8 * i));
}

/// Compresses blocks of rows.
///
/// Threads: use one object per thread; it keeps its buffers.
class Block {
public:
    /// In a block of ZIP_COMPRESSION.
    static constexpr std::uint32_t NumRows = 16;
    /// A row and a size stand before the bytes.
    static constexpr std::size_t HeadSize = 8;

    Block() {
        // Smaller files than zlib's level 4, which is OpenEXR's. Level 1 takes three quarters of
        // the time and 1 % more room.
        constexpr int Level = 4;
        compressor_.reset(libdeflate_alloc_compressor(Level));
        if (!compressor_)
            throw std::bad_alloc();
    }

    /// Returns the rows [first, end) as they stand in the file.
    std::vector<std::byte> made_of(std::span<const Channel> channels, std::size_t width,
                                   std::uint32_t first, std::uint32_t end) {
        values_.clear();
        for (std::size_t y = first; y < end; ++y)
            for (const Channel& channel : channels)
                for (std::size_t x = 0; x < width; ++x)
                    values_.push_back(std::bit_cast<std::uint32_t>(
                        channel.values[(y * width + x) * channel.step]));
        take_differences();
        const std::size_t size = differences_.size();
        compressed_.resize(libdeflate_zlib_compress_bound(compressor_.get(), size));
        std::size_t num_bytes = libdeflate_zlib_compress(
            compressor_.get(), differences_.data(), size, compressed_.data(), compressed_.size());
        // A block that does not become smaller stands in the file as it is.
        const bool is_smaller = num_bytes > 0 && num_bytes < size;
        num_bytes = is_smaller ? num_bytes : size;
        std::vector<std::byte> block(HeadSize + num_bytes);
        put_little_endian(block.data(), first, 4);
        put_little_endian(block.data() + 4, num_bytes, 4);
        if (is_smaller)
            std::memcpy(block.data() + HeadSize, compressed_.data(), num_bytes);
        else
            for (std::size_t i = 0; i < values_.size(); ++i)
                put_little_endian(block.data() + HeadSize + 4 * i, values_[i], 4);
        return block;
    }

private:
    /// Puts the bytes of even places before the bytes of odd places. Then replaces each byte by its
    /// difference to the byte before, plus 128.
    void take_differences() {
        const std::size_t half = 2 * values_.size();
        bytes_.resize(2 * half);
        for (std::size_t i = 0; i < values_.size(); ++i) {
            const std::uint32_t value = values_[i];
            bytes_[2 * i] = static_cast<std::uint8_t>(value);
            bytes_[2 * i + 1] = static_cast<std::uint8_t>(value >> 16);
            bytes_[half + 2 * i] = static_cast<std::uint8_t>(value >> 8);
            bytes_[half + 2 * i + 1] = static_cast<std::uint8_t>(value >> 24);
        }
        differences_.resize(bytes_.size());
        differences_.front() = bytes_.front();
        for (std::size_t i = 1; i < bytes_.size(); ++i)
            differences_[i] = static_cast<std::uint8_t>(bytes_[i] - bytes_[i - 1] + 128);
    }

    struct Free {
        void operator()(libdeflate_compressor* compressor) const {
            libdeflate_free_compressor(compressor);
        }
    };
    std::unique_ptr<libdeflate_compressor, Free> compressor_;
    std::vector<std::uint32_t> values_;
    std::vector<std::uint8_t> bytes_, differences_, compressed_;
};

/// Returns a file's header with its table of blocks, whose places are not yet known.
std::vector<std::byte> head_of(const EnvironmentImage& image, std::span<const Channel> channels) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    if (image.sampling == Sampling::Borders &&
        (image.layout == Layout::LatLong || image.layout == Layout::Cube))
        Imf::addEnvmap(header,
                       image.layout == Layout::Cube ? Imf::ENVMAP_CUBE : Imf::ENVMAP_LATLONG);
    for (const Channel& channel : channels)
        header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    MemoryOutput stream;
    {
        const Imf::OutputFile file(stream, header, 0);
    }
    return std::move(stream.bytes);
}

/// Gives blocks to `append`, and writes their places into the table at the end of `head`.
template<class Append>
void add_blocks(const EnvironmentImage& image, std::span<const Channel> channels,
                std::vector<std::byte>& head, const Append& append) {
    const std::size_t num_blocks = (image.height + Block::NumRows - 1) / Block::NumRows;
    std::byte* entry = head.data() + head.size() - 8 * num_blocks; // 8 bytes each
    std::uint64_t place = head.size();
    files::make_in_order(
        num_blocks,
        [&](std::size_t i) {
            thread_local Block block;
            const auto first = static_cast<std::uint32_t>(i * Block::NumRows);
            return block.made_of(channels, image.width, first,
                                 std::min(first + Block::NumRows, image.height));
        },
        [&](std::span<const std::byte> block) {
            put_little_endian(entry, place, 8);
            entry += 8;
            place += block.size();
            append(block);
        });
}

} // namespace

std::vector<std::byte> encode_exr(const EnvironmentImage& image, std::span<const ExrLayer> layers) {
    const std::vector<Channel> channels = channels_of(image, layers);
    std::vector<std::byte> head = head_of(image, channels), file = head;
    add_blocks(image, channels, head, [&](std::span<const std::byte> block) {
        file.insert(file.end(), block.begin(), block.end());
    });
    std::copy(head.begin(), head.end(), file.begin());
    return file;
}

void write_exr(files::OutputFile& file, const EnvironmentImage& image,
               std::span<const ExrLayer> layers) {
    const std::vector<Channel> channels = channels_of(image, layers);
    std::vector<std::byte> head = head_of(image, channels);
    file.expect(head.size() + channels.size() * image.pixels.size() * sizeof(float));
    file.append(head);
    add_blocks(image, channels, head,
               [&](std::span<const std::byte> block) { file.append(block); });
    file.replace(0, head);
}

} // namespace relumine::cubemap
