// TIFF of floats, as panorama tools and Photoshop write it: strips and tiles, LZW, deflate, zstd
// and PackBits, all predictors, either byte order, BigTIFF. Numbers without light above white
// (integers) and colours that are not RGB or grey are refused. Based on: Adobe, TIFF Revision 6.0,
// 1992; TIFF Technical Note 3, 2005; the BigTIFF page of libtiff.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include <fmt/format.h>
#include <half.h>

#include "cubemap/image/color_space.h"
#include "cubemap/image/file_bytes.h"
#include "cubemap/image/icc_profile.h"
#include "cubemap/image/image_file.h"
#include "cubemap/image/tiff_directory.h"
#include "cubemap/image/tiff_packing.h"

namespace relumine::cubemap {

namespace {

using tiff::Directory;
using tiff::Packing;

class TiffRows : public ImageRows {
public:
    explicit TiffRows(FileBytes file) : file_(std::move(file)) {
        const Directory directory(file_);
        is_big_endian_ = directory.is_big_endian();
        read_samples(directory);
        read_places(directory);
        read_colors(directory);
    }

    [[nodiscard]] std::uint32_t rows_together() const override {
        return packing_ == Packing::None && tile_width_ == 0 ? 1 : rows_;
    }

    Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const override {
        const std::uint32_t width = head_.width, height = head_.height;
        const auto num_rows = static_cast<std::uint32_t>(pixels.size() / width);
        Counts counts;
        // The file's rows, from either end.
        const std::uint32_t begin = is_bottom_up_ ? height - first - num_rows : first;
        std::vector<float> alpha(has_alpha_ ? pixels.size() : 0, 1.0f);
        for (std::uint32_t y = begin; y < begin + num_rows;) {
            // An unpacked strip need not be read whole.
            const std::uint32_t segment_row = y / rows_;
            const std::uint32_t end = std::min(begin + num_rows, (segment_row + 1) * rows_);
            for (std::uint32_t column = 0; column < columns_; ++column)
                for (std::uint32_t plane = 0; plane < planes_; ++plane) {
                    const Segment segment = decoded(segment_row, column, plane, y, end);
                    for (std::uint32_t row = y; row < end; ++row) {
                        const std::uint32_t target =
                            is_bottom_up_ ? height - 1 - row - first : row - first;
                        put(segment, row, column, plane,
                            pixels.subspan(std::size_t{target} * width, width),
                            alpha.empty()
                                ? std::span<float>()
                                : std::span(alpha).subspan(std::size_t{target} * width, width));
                    }
                }
            y = end;
        }
        for (std::size_t i = 0; i < alpha.size(); ++i) {
            if (alpha[i] == 0.0f)
                ++counts.num_transparent;
            if (!is_premultiplied_)
                pixels[i] *= alpha[i];
        }
        if (is_right_to_left_)
            for (std::uint32_t row = 0; row < num_rows; ++row)
                std::ranges::reverse(pixels.subspan(std::size_t{row} * width, width));
        if (colors_)
            counts.num_outside = colors_->convert(pixels);
        return counts;
    }

private:
    using enum tiff::Tag;

    /// Rows of a strip or a tile, in this machine's byte order.
    struct Segment {
        std::vector<std::byte> bytes;
        /// The first row of the picture that is in it
        std::uint32_t first_row;
    };

    void read_samples(const Directory& directory) {
        const std::uint64_t photometric = directory.number(Photometric, 2);
        constexpr std::uint64_t BlackIsZero = 1, Rgb = 2;
        const std::uint64_t samples = directory.number(SamplesPerPixel, 1);
        if (photometric != Rgb && photometric != BlackIsZero)
            file_.refuse("a TIFF of RGB or grey", name_of_photometric(photometric));
        num_colors_ = photometric == Rgb ? 3 : 1;
        constexpr std::uint64_t MostSamples = 64;
        if (samples < num_colors_ || samples > MostSamples)
            file_.refuse(fmt::format("{} to {} numbers for each pixel", num_colors_, MostSamples),
                         fmt::format("{}", samples));
        const std::vector<std::uint64_t> bits = directory.numbers(BitsPerSample);
        const std::vector<std::uint64_t> formats = directory.numbers(SampleFormat);
        const std::uint64_t format = formats.empty() ? 1 : formats.front();
        const std::uint64_t depth = bits.empty() ? 1 : bits.front();
        const auto all_are = [](const std::vector<std::uint64_t>& values, std::uint64_t value) {
            return std::ranges::all_of(values, [=](std::uint64_t each) { return each == value; });
        };
        constexpr std::uint64_t Floats = 3;
        if (format != Floats)
            file_.refuse(
                "a TIFF of floats",
                fmt::format("one of {}-bit integers, which hold no light above white", depth));
        if ((depth != 16 && depth != 32 && depth != 64) || !all_are(bits, depth) ||
            !all_are(formats, format))
            file_.refuse("a TIFF of 16-, 32- or 64-bit floats",
                         fmt::format("one of {} bits, or of several kinds", depth));
        sample_bytes_ = depth / 8;
        head_.is_half = depth == 16;
        const std::uint64_t planar = directory.number(Planar, 1);
        if (planar != 1 && planar != 2)
            file_.refuse("a PlanarConfiguration of 1 or 2", fmt::format("{}", planar));
        planes_ = planar == 2 ? static_cast<std::uint32_t>(samples) : 1;
        samples_ = planar == 2 ? 1 : static_cast<std::uint32_t>(samples);
        const std::vector<std::uint64_t> extra = directory.numbers(ExtraSamples);
        constexpr std::uint64_t Associated = 1, Unassociated = 2;
        has_alpha_ = samples > num_colors_ && !extra.empty() &&
                     (extra.front() == Associated || extra.front() == Unassociated);
        is_premultiplied_ = !has_alpha_ || extra.front() == Associated;
        if (num_colors_ == 1)
            head_.remarks.emplace_back("luminance only");
        const std::uint64_t orientation = directory.number(Orientation, 1);
        if (orientation > 4)
            file_.refuse("an Orientation of 1 to 4", fmt::format("{}", orientation));
        is_right_to_left_ = orientation == 2 || orientation == 3;
        is_bottom_up_ = orientation == 3 || orientation == 4;
        if (orientation > 1)
            head_.remarks.push_back(fmt::format("Orientation {} undone", orientation));
    }

    static std::string name_of_photometric(std::uint64_t photometric) {
        switch (photometric) {
        case 0:
            return "one in which 0 is white";
        case 3:
            return "one of a palette";
        case 5:
            return "one of inks (CMYK)";
        case 6:
            return "one of YCbCr";
        case 8:
            return "one of CIE L*a*b*";
        case 32844:
        case 32845:
            return "one of LogLuv: save it as floats";
        default:
            return fmt::format("PhotometricInterpretation {}", photometric);
        }
    }

    void read_places(const Directory& directory) {
        const std::uint64_t width = directory.number(Width, 0),
                            height = directory.number(Height, 0);
        packing_ = static_cast<Packing>(directory.number(Compression, 1));
        switch (packing_) {
        case Packing::None:
        case Packing::Lzw:
        case Packing::Deflate:
        case Packing::OldDeflate:
        case Packing::PackBits:
        case Packing::Zstd:
            break;
        default:
            file_.refuse("a TIFF without compression or with LZW, deflate, zstd or PackBits",
                         fmt::format("compression {}", static_cast<unsigned>(packing_)));
        }
        predictor_ = directory.number(Predictor, 1);
        if (packing_ == Packing::None || packing_ == Packing::PackBits)
            predictor_ = 1;
        if (predictor_ < 1 || predictor_ > 3)
            file_.refuse("a Predictor of 1 to 3", fmt::format("{}", predictor_));
        // No packing goes below it for pixels of 6 bytes, but zstd's, of a picture of one colour.
        const std::uint64_t most = packing_ == Packing::None ? 1 : 500;
        file_.check_size(width, height, most);
        head_.width = static_cast<std::uint32_t>(width);
        head_.height = static_cast<std::uint32_t>(height);
        const bool has_tiles = directory.has(TileOffsets);
        std::uint64_t across = 1;
        if (has_tiles) {
            const std::uint64_t tile_width = directory.number(TileWidth, 0);
            const std::uint64_t tile_height = directory.number(TileLength, 0);
            constexpr std::uint64_t MostTile = 1 << 16;
            if (tile_width == 0 || tile_height == 0 || tile_width > MostTile ||
                tile_height > MostTile)
                file_.refuse("tiles of 1 to 65536 pixels",
                             fmt::format("{}x{}", tile_width, tile_height));
            across = (width + tile_width - 1) / tile_width;
            const std::uint64_t down = (height + tile_height - 1) / tile_height;
            file_.check_size(across * tile_width, down * tile_height, most);
            tile_width_ = static_cast<std::uint32_t>(tile_width);
            rows_ = static_cast<std::uint32_t>(tile_height);
        } else {
            const std::uint64_t rows = std::min(directory.number(RowsPerStrip, height), height);
            if (rows == 0)
                file_.refuse("strips of rows", "none");
            rows_ = static_cast<std::uint32_t>(rows);
        }
        columns_ = static_cast<std::uint32_t>(across);
        down_ = (head_.height + rows_ - 1) / rows_;
        offsets_ = directory.numbers(has_tiles ? TileOffsets : StripOffsets);
        sizes_ = directory.numbers(has_tiles ? TileByteCounts : StripByteCounts);
        const std::uint64_t expected = std::uint64_t{columns_} * down_ * planes_;
        if (sizes_.empty() && offsets_.size() == 1 && packing_ == Packing::None &&
            offsets_[0] < file_.size()) // old writers leave them out
            sizes_.push_back(file_.size() - offsets_[0]);
        if (offsets_.size() < expected || sizes_.size() < expected)
            file_.refuse(fmt::format("{} strips or tiles", expected),
                         fmt::format("{}", std::min(offsets_.size(), sizes_.size())));
    }

    void read_colors(const Directory& directory) {
        std::optional<ColorSpace> space;
        const std::vector<double> xy = directory.fractions(PrimaryColors);
        const std::vector<double> white = directory.fractions(WhitePoint);
        if (directory.has(IccProfile))
            space = space_of_icc(directory.bytes_of(IccProfile), head_.remarks);
        else if (xy.size() == 6 && white.size() == 2)
            space =
                space_of({{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {white[0], white[1]}});
        if (space)
            colors_.emplace(*space);
    }

    [[nodiscard]] std::uint32_t segment_width() const {
        return tile_width_ != 0 ? tile_width_ : head_.width;
    }
    [[nodiscard]] std::size_t row_bytes() const {
        return std::size_t{segment_width()} * samples_ * sample_bytes_;
    }

    /// Returns a strip or tile; of an unpacked one the rows [begin, end) alone.
    [[nodiscard]] Segment decoded(std::uint32_t segment_row, std::uint32_t column,
                                  std::uint32_t plane, std::uint32_t begin,
                                  std::uint32_t end) const {
        const std::size_t index = (std::size_t{plane} * down_ + segment_row) * columns_ + column;
        const std::uint32_t first = segment_row * rows_;
        const std::uint32_t num_rows =
            tile_width_ != 0 ? rows_ : std::min(rows_, head_.height - first);
        const std::size_t num_bytes = num_rows * row_bytes();
        Segment result{.bytes = {}, .first_row = first};
        if (packing_ == Packing::None) {
            if (sizes_[index] < num_bytes)
                broken(segment_row);
            result.first_row = begin;
            result.bytes = file_.read(offsets_[index] + (begin - first) * row_bytes(),
                                      (end - begin) * row_bytes());
        } else {
            constexpr std::uint64_t AlwaysAllowed = std::uint64_t{64} << 20;
            const std::vector<std::byte> packed = file_.read(offsets_[index], sizes_[index]);
            if (num_bytes > std::max(AlwaysAllowed, packed.size() * most_ratio(packing_)))
                broken(segment_row);
            result.bytes.resize(num_bytes);
            if (!unpack(packing_, packed, result.bytes))
                broken(segment_row);
        }
        for (std::size_t at = 0; at < result.bytes.size(); at += row_bytes())
            restore(std::span(result.bytes).subspan(at, row_bytes()));
        return result;
    }

    [[noreturn]] void broken(std::uint32_t segment_row) const {
        file_.refuse(fmt::format("{} rows", head_.height),
                     fmt::format("broken data from row {} on", segment_row * rows_));
    }

    /// Undoes predictor and byte order of a row.
    void restore(std::span<std::byte> row) const {
        const std::size_t num_samples = row.size() / sample_bytes_;
        const bool is_swapped = is_big_endian_ == (std::endian::native == std::endian::little);
        if (predictor_ == 3) {
            // Differences of bytes, the highest bytes of all samples first.
            for (std::size_t i = samples_; i < row.size(); ++i)
                row[i] = static_cast<std::byte>(std::to_integer<unsigned>(row[i]) +
                                                std::to_integer<unsigned>(row[i - samples_]));
            const std::vector<std::byte> planes(row.begin(), row.end());
            for (std::size_t i = 0; i < num_samples; ++i)
                for (std::size_t byte = 0; byte < sample_bytes_; ++byte)
                    row[i * sample_bytes_ + (std::endian::native == std::endian::little
                                                 ? sample_bytes_ - 1 - byte
                                                 : byte)] = planes[byte * num_samples + i];
            return;
        }
        if (is_swapped)
            for (std::size_t i = 0; i < num_samples; ++i)
                std::ranges::reverse(row.subspan(i * sample_bytes_, sample_bytes_));
        if (predictor_ == 2 && sample_bytes_ == 2)
            add_up<std::uint16_t>(row);
        else if (predictor_ == 2 && sample_bytes_ == 4)
            add_up<std::uint32_t>(row);
        else if (predictor_ == 2)
            add_up<std::uint64_t>(row);
    }

    /// Differences of samples become samples.
    template<typename Integer>
    void add_up(std::span<std::byte> row) const {
        std::vector<Integer> sums(row.size() / sizeof(Integer));
        std::memcpy(sums.data(), row.data(), row.size());
        for (std::size_t i = samples_; i < sums.size(); ++i)
            sums[i] = static_cast<Integer>(sums[i] + sums[i - samples_]);
        std::memcpy(row.data(), sums.data(), row.size());
    }

    [[nodiscard]] float sample(const std::byte* at) const {
        if (sample_bytes_ == 2) {
            std::uint16_t bits = 0;
            std::memcpy(&bits, at, sizeof bits);
            return imath_half_to_float(bits);
        }
        float value = 0.0f;
        double wide = 0.0;
        if (sample_bytes_ == 4) {
            std::memcpy(&value, at, sizeof value);
            return value;
        }
        std::memcpy(&wide, at, sizeof wide);
        return static_cast<float>(wide);
    }

    /// Puts a row of a segment into the row of the picture.
    void put(const Segment& segment, std::uint32_t row, std::uint32_t column, std::uint32_t plane,
             std::span<glm::vec3> pixels, std::span<float> alpha) const {
        const std::byte* bytes = segment.bytes.data() + (row - segment.first_row) * row_bytes();
        const std::uint32_t left = column * segment_width();
        const std::uint32_t num = std::min(segment_width(), head_.width - left);
        for (std::uint32_t x = 0; x < num; ++x)
            for (std::uint32_t i = 0; i < samples_; ++i) {
                const std::uint32_t channel = plane + i;
                if (channel > num_colors_ || (channel == num_colors_ && alpha.empty()))
                    break;
                const float value = sample(bytes + (std::size_t{x} * samples_ + i) * sample_bytes_);
                if (channel == num_colors_)
                    alpha[left + x] = value;
                else if (num_colors_ == 1)
                    pixels[left + x] = glm::vec3(value);
                else
                    pixels[left + x][static_cast<int>(channel)] = value;
            }
    }

    FileBytes file_;
    bool is_big_endian_ = false, is_bottom_up_ = false, is_right_to_left_ = false;
    bool has_alpha_ = false, is_premultiplied_ = false;
    Packing packing_ = Packing::None;
    std::uint64_t predictor_ = 1;
    std::size_t sample_bytes_ = 4;
    std::uint32_t num_colors_ = 3;
    /// Samples side by side in a segment's pixel, and how many planes of them there are
    std::uint32_t samples_ = 3, planes_ = 1;
    /// 0: strips
    std::uint32_t tile_width_ = 0;
    /// The rows of a strip or tile
    std::uint32_t rows_ = 1;
    std::uint32_t columns_ = 1, down_ = 1;
    std::vector<std::uint64_t> offsets_, sizes_;
};

} // namespace

bool is_tiff(std::span<const std::byte> bytes) {
    if (bytes.size() < 4)
        return false;
    const std::string_view mark(reinterpret_cast<const char*>(bytes.data()), 4);
    using namespace std::string_view_literals;
    return mark == "II*\0"sv || mark == "MM\0*"sv || mark == "II+\0"sv || mark == "MM\0+"sv;
}

std::unique_ptr<ImageRows> open_tiff(FileBytes file) {
    return std::make_unique<TiffRows>(std::move(file));
}

} // namespace relumine::cubemap
