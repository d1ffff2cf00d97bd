// Radiance pictures (.hdr, .pic): RGBE, flat or run-length encoded in the old or the new way.
// Based on: Greg Ward, Real Pixels, Graphics Gems II, 1991, and the file format page of Radiance.
//
// The project has its own decoder because widespread single-file decoders read truncated files as
// if they were whole, or never return from them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "cubemap/image/color_space.h"
#include "cubemap/image/image_file.h"
#include "files/large_vector.h"
#include "files/output_file.h"
#include "files/printable.h"

namespace relumine::cubemap {

namespace {

using Rgbe = std::array<std::uint8_t, 4>;

/// Only scanlines of these lengths may be run-length encoded in the new way.
bool can_be_run_length_encoded(std::uint32_t width) {
    return width >= 8 && width <= 0x7fff;
}

/// What the mantissas of each exponent are multiplied by: std::ldexp(1.0, exponent - 136). A
/// function call for each of 134 million pixels takes seconds.
constexpr auto PowersOfTwo = [] {
    std::array<double, 256> powers{};
    double power = 0x1p-136;
    for (double& each : powers) {
        each = power;
        power *= 2.0;
    }
    return powers;
}();

class HdrDecoder {
public:
    /// `num_bytes` is the size of the whole file. `bytes` may be only its beginning.
    HdrDecoder(std::span<const std::byte> bytes, std::size_t num_bytes, const std::string& name)
        : bytes_(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()),
          num_bytes_(num_bytes), name_(name) {}

    ImageSize size() {
        read_header();
        read_size();
        return {width_, height_};
    }

    ImageFile decode() {
        ImageFile image = begin();
        image.pixels = files::large_vector<glm::vec3>(static_cast<std::size_t>(width_) * height_);
        std::vector<Rgbe> scanline(width_);
        for (std::uint32_t row = 0; row < height_; ++row) {
            read_scanline(scanline, row);
            show(scanline, std::span(image.pixels).subspan(place_of(row) * width_, width_));
        }
        if (space_)
            image.remarks.push_back(convert(ColorConversion(*space_), image));
        return image;
    }

    /// Reads what stands before the pixels. Returns the picture without them.
    ImageFile begin() {
        read_header();
        read_size();
        ImageFile image;
        image.width = width_;
        image.height = height_;
        if (exposure_ != glm::dvec3(1.0))
            image.remarks.emplace_back("exposure of the header divided out");
        if (has_zero_exposure_)
            image.remarks.emplace_back("EXPOSURE=0 of the header counts as 1");
        return image;
    }

    [[nodiscard]] std::optional<ColorConversion> colors() const {
        return space_ ? std::optional<ColorConversion>(*space_) : std::nullopt;
    }

    /// Reads on from other bytes of the file, which begin with a row.
    void go_on(std::span<const std::byte> bytes) {
        bytes_ = {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
        position_ = 0;
    }
    [[nodiscard]] std::size_t position() const { return position_; }
    /// Returns the bytes of a row at most: each value with a code of its own.
    [[nodiscard]] std::size_t most_row_bytes() const { return 8 * std::size_t{width_} + 4; }

    /// Returns where row `row` of the file stands in the picture.
    [[nodiscard]] std::size_t place_of(std::uint32_t row) const {
        return bottom_up_ ? height_ - 1 - row : row;
    }

    void read_scanline(std::vector<Rgbe>& scanline, std::uint32_t row) {
        const Rgbe start = next_pixel(row);
        if (!can_be_run_length_encoded(width_) || start[0] != 2 || start[1] != 2 ||
            (start[2] & 0x80) != 0) {
            read_old_scanline(scanline, start, row);
            return;
        }
        if ((start[2] << 8 | start[3]) != static_cast<int>(width_))
            fail(fmt::format("{} pixels in row {}", width_, row),
                 std::to_string(start[2] << 8 | start[3]));
        for (std::size_t channel = 0; channel < 4; ++channel) {
            for (std::uint32_t x = 0; x < width_;) {
                const std::uint32_t code = next(row);
                const std::uint32_t count = code > 128 ? code - 128 : code;
                if (count == 0 || count > width_ - x)
                    fail(fmt::format("runs that fill row {}", row), "a damaged one");
                if (code > 128) {
                    const std::uint8_t value = next(row);
                    for (std::uint32_t i = 0; i < count; ++i)
                        scanline[x++][channel] = value;
                } else {
                    for (std::uint32_t i = 0; i < count; ++i)
                        scanline[x++][channel] = next(row);
                }
            }
        }
    }

    /// Puts a row into the picture.
    void show(const std::vector<Rgbe>& scanline, std::span<glm::vec3> pixels) const {
        for (std::uint32_t column = 0; column < width_; ++column)
            pixels[right_to_left_ ? width_ - 1 - column : column] = radiance(scanline[column]);
    }

private:
    [[noreturn]] void fail(std::string_view expected, const std::string& got) const {
        throw std::runtime_error(fmt::format("{}: expected {}, got {}", name_, expected, got));
    }

    std::string_view read_line() {
        const std::size_t begin = position_;
        while (position_ < bytes_.size() && bytes_[position_] != '\n')
            ++position_;
        if (position_ == bytes_.size())
            fail("a Radiance header", "the end of the file");
        std::string_view line(reinterpret_cast<const char*>(bytes_.data()) + begin,
                              position_ - begin);
        ++position_;
        if (!line.empty() && line.back() == '\r')
            line.remove_suffix(1);
        return line;
    }

    void read_header() {
        read_line(); // "#?RADIANCE" or another program's name
        for (std::string_view line = read_line(); !line.empty(); line = read_line()) {
            if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
                fail("FORMAT=32-bit_rle_rgbe", fmt::format("{:.60}", files::printable(line)));
            if (line.starts_with("EXPOSURE="))
                read_exposure(line.substr(9));
            if (line.starts_with("COLORCORR="))
                read_color_correction(line.substr(10));
            if (line.starts_with("PRIMARIES="))
                read_primaries(line.substr(10));
        }
        if (!(std::min({exposure_.x, exposure_.y, exposure_.z}) > 1e-30 &&
              std::max({exposure_.x, exposure_.y, exposure_.z}) < 1e30))
            fail("a positive exposure", fmt::format("{}", exposure_.x));
    }

    /// Takes 0 as not set: FreeImage writes it into every file.
    void read_exposure(std::string_view text) {
        const double exposure = number(text);
        if (exposure == 0.0)
            has_zero_exposure_ = true;
        else
            exposure_ *= exposure;
    }

    void read_color_correction(std::string_view text) {
        const auto [red, green, blue] = numbers<3>(text);
        exposure_ *= glm::dvec3(red, green, blue);
    }

    /// Takes x and y of red, green, blue and white.
    void read_primaries(std::string_view text) {
        const std::array<double, 8> xy = numbers<8>(text);
        // Zeros are not set: FreeImage writes them into every file.
        if (xy != std::array<double, 8>{})
            space_ = space_of({{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}});
    }

    template<std::size_t N>
    [[nodiscard]] std::array<double, N> numbers(std::string_view text) const {
        std::array<double, N> result{};
        for (double& each : result) {
            text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
            each = number(text);
            text.remove_prefix(std::min(text.find(' '), text.size()));
        }
        return result;
    }

    [[nodiscard]] double number(std::string_view text) const {
        const std::string line(text);
        char* end = nullptr;
        const double value = std::strtod(line.c_str(), &end);
        // strtod() also takes hexadecimal numbers.
        if (end == line.c_str() || std::any_of(line.c_str(), static_cast<const char*>(end),
                                               [](char c) { return c == 'x' || c == 'X'; }))
            fail("a number after EXPOSURE=, COLORCORR= or PRIMARIES=",
                 fmt::format("'{:.60}'", files::printable(text)));
        return value;
    }

    /// Reads the resolution line, such as "-Y 512 +X 1024", and checks that the file can hold this
    /// size.
    void read_size() {
        const std::string line(read_line());
        std::array<char, 2> signs{}, axes{};
        std::array<unsigned long long, 2> sizes{};
        if (std::sscanf(line.c_str(), "%c%c %19llu %c%c %19llu", &signs[0], &axes[0], &sizes[0],
                        &signs[1], &axes[1], &sizes[1]) != 6)
            fail("a resolution line such as -Y 512 +X 1024",
                 fmt::format("'{:.60}'", files::printable(line)));
        const auto is_sign = [](char c) {
            return c == '+' || c == '-';
        };
        if (axes[0] != 'Y' || axes[1] != 'X' || !is_sign(signs[0]) || !is_sign(signs[1]))
            fail("rows of pixels (-Y H +X W)", fmt::format("'{:.60}'", files::printable(line)));
        bottom_up_ = signs[0] == '+';
        right_to_left_ = signs[1] == '-';

        const auto [height, width] = sizes;
        // A run of 127 equal bytes takes 2 bytes, so nothing shrinks by more than 64:1. The old
        // runs could, but hardly do.
        constexpr std::size_t AlwaysAllowed = std::size_t{1} << 22;
        const std::size_t num_bytes = num_bytes_ - position_;
        if (width == 0 || height == 0 || width > MaxPixels || height > MaxPixels ||
            width * height > MaxPixels)
            fail("a size that an environment can have", fmt::format("{}x{}", width, height));
        if (width * height > std::max(AlwaysAllowed, num_bytes * 16))
            fail(fmt::format("data for {}x{} pixels", width, height),
                 fmt::format("{} bytes", num_bytes));
        width_ = static_cast<std::uint32_t>(width);
        height_ = static_cast<std::uint32_t>(height);
    }

    std::uint8_t next(std::uint32_t row) {
        if (position_ >= bytes_.size())
            fail(fmt::format("{} rows", height_), fmt::format("a file that ends in row {}", row));
        return bytes_[position_++];
    }

    Rgbe next_pixel(std::uint32_t row) { return {next(row), next(row), next(row), next(row)}; }

    /// Reads flat pixels. (1, 1, 1, n) repeats the pixel before n times; right after another
    /// repetition it repeats n * 256 times.
    void read_old_scanline(std::vector<Rgbe>& scanline, Rgbe pixel, std::uint32_t row) {
        std::uint32_t shift = 0;
        for (std::uint32_t x = 0; x < width_;) {
            if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
                const std::uint64_t count = shift <= 24 ? std::uint64_t{pixel[3]} << shift : 0;
                if (x == 0 || count == 0 || count > width_ - x)
                    fail(fmt::format("runs that fill row {}", row), "a damaged one");
                std::fill_n(scanline.begin() + x, count, scanline[x - 1]);
                x += static_cast<std::uint32_t>(count);
                shift += 8;
            } else {
                scanline[x++] = pixel;
                shift = 0;
            }
            if (x < width_)
                pixel = next_pixel(row);
        }
    }

    [[nodiscard]] glm::vec3 radiance(const Rgbe& pixel) const {
        if (pixel[3] == 0)
            return glm::vec3(0.0f);
        return glm::vec3(glm::dvec3(pixel[0], pixel[1], pixel[2]) * PowersOfTwo[pixel[3]] /
                         exposure_);
    }

    std::span<const std::uint8_t> bytes_;
    std::size_t num_bytes_;
    const std::string& name_;
    std::size_t position_ = 0;
    glm::dvec3 exposure_{1.0};
    std::uint32_t width_ = 0, height_ = 0;
    bool bottom_up_ = false, right_to_left_ = false, has_zero_exposure_ = false;
    /// Empty: linear Rec. 709, as far as the header says
    std::optional<ColorSpace> space_;
};

Rgbe rgbe(const glm::vec3& radiance) {
    const float largest = std::max({radiance.x, radiance.y, radiance.z});
    const auto fits = [](float value) {
        return value >= 0.0f && value < 1.6e38f;
    }; // false for NaN
    if (!fits(radiance.x) || !fits(radiance.y) || !fits(radiance.z))
        throw std::invalid_argument(
            "expected radiance from 0 to 1.6e38 for a .hdr file, got a NaN, infinite, negative "
            "or larger value");
    if (largest < 1e-38f)
        return {0, 0, 0, 0};
    int exponent = 0;
    std::frexp(largest, &exponent);
    if (std::lround(std::ldexp(largest, 8 - exponent)) > 255)
        ++exponent; // the largest mantissa would round up to 256
    const auto mantissa = [&](float value) {
        return static_cast<std::uint8_t>(std::lround(std::ldexp(value, 8 - exponent)));
    };
    return {mantissa(radiance.x), mantissa(radiance.y), mantissa(radiance.z),
            static_cast<std::uint8_t>(exponent + 128)};
}

/// Appends one channel of a scanline as runs of up to 127 equal bytes and stretches of up to 128
/// others.
void append_runs(const std::vector<Rgbe>& scanline, std::size_t channel,
                 std::vector<std::uint8_t>& out) {
    constexpr std::size_t ShortestRun = 4, LongestRun = 127, LongestStretch = 128;
    const auto run_length = [&](std::size_t begin) {
        std::size_t end = begin + 1;
        while (end < scanline.size() && end - begin < LongestRun &&
               scanline[end][channel] == scanline[begin][channel])
            ++end;
        return end - begin;
    };
    for (std::size_t x = 0; x < scanline.size();) {
        std::size_t stretch = 0;
        std::size_t run = run_length(x);
        while (run < ShortestRun && stretch + run <= LongestStretch &&
               x + stretch < scanline.size()) {
            stretch += run;
            run = x + stretch < scanline.size() ? run_length(x + stretch) : 0;
        }
        if (stretch > 0) {
            out.push_back(static_cast<std::uint8_t>(stretch));
            for (std::size_t i = 0; i < stretch; ++i)
                out.push_back(scanline[x + i][channel]);
            x += stretch;
        } else {
            out.push_back(static_cast<std::uint8_t>(128 + run));
            out.push_back(scanline[x][channel]);
            x += run;
        }
    }
}

} // namespace

bool is_hdr(std::span<const std::byte> bytes) {
    return bytes.size() >= 2 && bytes[0] == std::byte{'#'} && bytes[1] == std::byte{'?'};
}

ImageFile decode_hdr(std::span<const std::byte> bytes, const std::string& name) {
    return HdrDecoder(bytes, bytes.size(), name).decode();
}

ImageSize hdr_size(std::span<const std::byte> head, std::size_t num_bytes,
                   const std::string& name) {
    return HdrDecoder(head, num_bytes, name).size();
}

namespace {

class HdrRows : public ImageRows {
public:
    explicit HdrRows(const std::filesystem::path& path)
        : path_(path), name_(path.string()), num_bytes_(files::size(path)) {
        const std::size_t num_head_bytes = std::min(num_bytes_, MaxHeadBytes);
        std::vector<std::byte> bytes = files::read(path_, 0, num_head_bytes);
        HdrDecoder decoder(bytes, num_bytes_, name_);
        head_ = decoder.begin();
        colors_ = decoder.colors();
        std::uint64_t at = decoder.position();
        // Rows begin where those before them end. All are looked at once, some megabytes at a time.
        constexpr std::size_t PieceBytes = std::size_t{16} << 20;
        std::vector<Rgbe> scanline(head_.width);
        std::uint64_t begin = 0;
        bytes.clear();
        for (std::uint32_t row = 0; row < head_.height; ++row) {
            offsets_.push_back(at);
            if (at + decoder.most_row_bytes() > begin + bytes.size() &&
                begin + bytes.size() < num_bytes_) {
                begin = at;
                bytes = files::read(
                    path_, begin,
                    std::min<std::uint64_t>(std::max(PieceBytes, decoder.most_row_bytes()),
                                            num_bytes_ - begin));
            }
            decoder.go_on(std::span(bytes).subspan(at - begin));
            decoder.read_scanline(scanline, row);
            at += decoder.position();
        }
        offsets_.push_back(at);
        decoder_.emplace(std::move(decoder));
    }

    Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const override {
        const std::size_t width = head_.width;
        const auto height = static_cast<std::uint32_t>(pixels.size() / width);
        HdrDecoder decoder = *decoder_;
        // The rows of the file's order, from the first in the picture or from the last.
        const auto begin = static_cast<std::uint32_t>(
            std::min(decoder.place_of(first), decoder.place_of(first + height - 1)));
        const std::vector<std::byte> bytes =
            files::read(path_, offsets_[begin], offsets_[begin + height] - offsets_[begin]);
        decoder.go_on(bytes);
        std::vector<Rgbe> scanline(width);
        for (std::uint32_t row = begin; row < begin + height; ++row) {
            decoder.read_scanline(scanline, row);
            decoder.show(scanline, pixels.subspan((decoder.place_of(row) - first) * width, width));
        }
        return {.num_outside = colors_ ? colors_->convert(pixels) : 0};
    }

private:
    std::filesystem::path path_;
    std::string name_;
    std::size_t num_bytes_;
    /// Where the file's rows begin, and where the last one ends
    std::vector<std::uint64_t> offsets_;
    /// After the header
    std::optional<HdrDecoder> decoder_;
};

} // namespace

std::unique_ptr<ImageRows> hdr_rows(const std::filesystem::path& path) {
    return std::make_unique<HdrRows>(path);
}

std::vector<std::byte> encode_hdr(const EnvironmentImage& image) {
    const std::string header = fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n",
                                           image.height, image.width);
    std::vector<std::uint8_t> out(header.begin(), header.end());
    std::vector<Rgbe> scanline(image.width);
    for (std::size_t y = 0; y < image.height; ++y) {
        std::transform(image.pixels.begin() + static_cast<std::ptrdiff_t>(y * image.width),
                       image.pixels.begin() + static_cast<std::ptrdiff_t>((y + 1) * image.width),
                       scanline.begin(), rgbe);
        if (!can_be_run_length_encoded(image.width)) {
            for (const Rgbe& pixel : scanline)
                out.insert(out.end(), pixel.begin(), pixel.end());
            continue;
        }
        const auto width = static_cast<std::uint16_t>(image.width);
        out.insert(out.end(), {2, 2, static_cast<std::uint8_t>(width >> 8),
                               static_cast<std::uint8_t>(width & 0xff)});
        for (std::size_t channel = 0; channel < 4; ++channel)
            append_runs(scanline, channel, out);
    }
    std::vector<std::byte> bytes(out.size());
    std::memcpy(bytes.data(), out.data(), out.size());
    return bytes;
}

} // namespace relumine::cubemap
