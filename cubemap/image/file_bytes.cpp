#include "cubemap/image/file_bytes.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "cubemap/image/image_file.h"
#include "files/output_file.h"

namespace relumine::cubemap {

FileBytes::FileBytes(std::span<const std::byte> bytes, std::string name)
    : bytes_(bytes), name_(std::move(name)), size_(bytes.size()) {}

FileBytes::FileBytes(const std::filesystem::path& path)
    : path_(path), name_(path.string()), size_(files::size(path)) {}

std::vector<std::byte> FileBytes::read(std::uint64_t offset, std::uint64_t num_bytes) const {
    if (offset > size_ || num_bytes > size_ - offset)
        refuse(fmt::format("{} bytes from byte {} on", num_bytes, offset),
               fmt::format("a file of {} bytes", size_));
    if (!path_.empty()) {
        std::vector<std::byte> piece = files::read(path_, offset, num_bytes);
        if (piece.size() != num_bytes)
            refuse(fmt::format("{} bytes", size_), "a file that became shorter");
        return piece;
    }
    const auto piece = bytes_.subspan(offset, num_bytes);
    return {piece.begin(), piece.end()};
}

void FileBytes::check_size(std::uint64_t width, std::uint64_t height,
                           std::uint64_t most_pixels_per_byte) const {
    constexpr std::uint64_t AlwaysAllowed = std::uint64_t{1} << 22;
    if (width == 0 || height == 0 || width > MaxPixels || height > MaxPixels ||
        width * height > MaxPixels)
        refuse("a size that an environment can have", fmt::format("{}x{}", width, height));
    if (width * height > std::max(AlwaysAllowed, size_ * most_pixels_per_byte))
        refuse(fmt::format("data for {}x{} pixels", width, height), fmt::format("{} bytes", size_));
}

void FileBytes::refuse(std::string_view expected, std::string_view got) const {
    throw std::runtime_error(fmt::format("{}: expected {}, got {}", name_, expected, got));
}

std::uint64_t Fields::number(std::uint64_t offset, std::size_t num_bytes) const {
    if (offset > bytes_.size() || num_bytes > bytes_.size() - offset)
        file_->refuse(fmt::format("a header of {} bytes or more", offset + num_bytes),
                      fmt::format("{}", bytes_.size()));
    std::uint64_t result = 0;
    for (std::size_t i = 0; i < num_bytes; ++i)
        result = result << 8 | std::to_integer<std::uint64_t>(
                                   bytes_[offset + (is_big_endian_ ? i : num_bytes - 1 - i)]);
    return result;
}

} // namespace relumine::cubemap
