// Portable float maps (.pfm): a header of three words and 32-bit floats, the lowest row first.
// Based on: Paul Debevec, "PFM Portable FloatMap Image Format"; netpbm's pfm(5).
#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "cubemap/image/file_bytes.h"
#include "cubemap/image/image_file.h"
#include "files/printable.h"

namespace relumine::cubemap {

namespace {

class PfmRows : public ImageRows {
public:
    explicit PfmRows(FileBytes file) : file_(std::move(file)) {
        constexpr std::uint64_t MostHeaderBytes = 256;
        const std::vector<std::byte> head = file_.read(0, std::min(file_.size(), MostHeaderBytes));
        header_ = {reinterpret_cast<const char*>(head.data()), head.size()};
        num_channels_ = header_[1] == 'F' ? 3 : 1;
        position_ = 2;
        const double width = number(), height = number(), scale = number();
        const auto is_count = [](double value) {
            return value >= 1.0 && value <= static_cast<double>(MaxPixels) &&
                   value == std::floor(value);
        };
        if (!is_count(width) || !is_count(height))
            file_.refuse("a size that an environment can have",
                         fmt::format("{}x{}", width, height));
        if (!(std::abs(scale) > 1e-30 && std::abs(scale) < 1e30))
            file_.refuse("a scale that is not 0", fmt::format("{}", scale));
        head_.width = static_cast<std::uint32_t>(width);
        head_.height = static_cast<std::uint32_t>(height);
        file_.check_size(head_.width, head_.height, 1);
        pixels_at_ = position_ + 1; // one blank
        is_big_endian_ = scale > 0.0;
        scale_ = static_cast<float>(std::abs(scale));
        if (num_channels_ == 1)
            head_.remarks.emplace_back("luminance only");
        if (std::abs(scale) != 1.0)
            head_.remarks.push_back(
                fmt::format("the header's scale of {:g} multiplied in", std::abs(scale)));
        const std::uint64_t num_bytes = row_bytes() * head_.height;
        if (file_.size() < pixels_at_ || file_.size() - pixels_at_ < num_bytes)
            file_.refuse(fmt::format("{} bytes of pixels", num_bytes),
                         fmt::format("a file of {} bytes", file_.size()));
    }

    Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const override {
        const std::size_t width = head_.width, num_rows = pixels.size() / width;
        for (std::size_t row = 0; row < num_rows; ++row) {
            const std::vector<std::byte> bytes = file_.read(
                pixels_at_ + (head_.height - 1 - (first + row)) * row_bytes(), row_bytes());
            for (std::size_t x = 0; x < width; ++x)
                for (int channel = 0; channel < 3; ++channel)
                    pixels[row * width + x][channel] = value_at(
                        &bytes[4 * (x * num_channels_ +
                                    (num_channels_ == 3 ? static_cast<std::size_t>(channel) : 0))]);
        }
        return {};
    }

private:
    [[nodiscard]] std::uint64_t row_bytes() const {
        return std::uint64_t{4} * num_channels_ * head_.width;
    }

    [[nodiscard]] float value_at(const std::byte* at) const {
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < 4; ++i)
            bits = bits << 8 | std::to_integer<std::uint32_t>(at[is_big_endian_ ? i : 3 - i]);
        return scale_ * std::bit_cast<float>(bits);
    }

    /// Reads the header's next word. Position is then behind it.
    double number() {
        const auto is_blank = [&](std::size_t at) {
            return at < header_.size() &&
                   std::isspace(static_cast<unsigned char>(header_[at])) != 0;
        };
        while (is_blank(position_) || (position_ < header_.size() && header_[position_] == '#'))
            position_ = header_[position_] == '#'
                            ? std::min(header_.find('\n', position_), header_.size())
                            : position_ + 1;
        const std::size_t begin = position_;
        while (position_ < header_.size() && !is_blank(position_))
            ++position_;
        std::string_view word = std::string_view(header_).substr(begin, position_ - begin);
        word.remove_prefix(word.starts_with('+') ? 1 : 0);
        double value = 0.0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || word.empty() ||
            position_ == header_.size())
            file_.refuse("PF, width, height and scale",
                         fmt::format("'{:.60}'", files::printable(word)));
        return value;
    }

    FileBytes file_;
    std::string header_;
    std::size_t position_ = 0, num_channels_ = 3;
    std::uint64_t pixels_at_ = 0;
    bool is_big_endian_ = false;
    float scale_ = 1.0f;
};

} // namespace

bool is_pfm(std::span<const std::byte> bytes) {
    return bytes.size() >= 3 && bytes[0] == std::byte{'P'} &&
           (bytes[1] == std::byte{'F'} || bytes[1] == std::byte{'f'}) &&
           std::isspace(std::to_integer<int>(bytes[2])) != 0;
}

std::unique_ptr<ImageRows> open_pfm(FileBytes file) {
    return std::make_unique<PfmRows>(std::move(file));
}

} // namespace relumine::cubemap
