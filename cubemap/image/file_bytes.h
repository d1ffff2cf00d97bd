// The bytes of a file for readers that take them piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace relumine::cubemap {

/// A file in memory or on the disk.
///
/// Threads: read() may be called from several at once.
class FileBytes {
public:
    /// `bytes` stay where they are. `name` stands for the file in messages.
    FileBytes(std::span<const std::byte> bytes, std::string name);
    /// Throws:  as files::size().
    explicit FileBytes(const std::filesystem::path& path);

    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] const std::string& name() const { return name_; }

    /// Returns a piece of the file. Nothing is allocated for one beyond its end.
    /// Throws:  std::runtime_error "name: expected X, got Y".
    [[nodiscard]] std::vector<std::byte> read(std::uint64_t offset, std::uint64_t num_bytes) const;

    /// Checks that a picture may be so large, and that its file has a byte for each
    /// `most_pixels_per_byte` pixels. Below 4.2 million pixels any file will do.
    /// Throws:  std::runtime_error "name: expected X, got Y".
    void check_size(std::uint64_t width, std::uint64_t height,
                    std::uint64_t most_pixels_per_byte) const;

    /// Throws std::runtime_error "name: expected X, got Y".
    [[noreturn]] void refuse(std::string_view expected, std::string_view got) const;

private:
    std::span<const std::byte> bytes_;
    /// Empty: the file is in memory
    std::filesystem::path path_;
    std::string name_;
    std::uint64_t size_;
};

/// Numbers within bytes that were read, of the file's byte order.
class Fields {
public:
    Fields(const FileBytes& file, std::vector<std::byte> bytes, bool is_big_endian = false)
        : file_(&file), bytes_(std::move(bytes)), is_big_endian_(is_big_endian) {}

    /// Returns the number of `num_bytes` bytes at `offset`.
    /// Throws:  std::runtime_error for one beyond the end.
    [[nodiscard]] std::uint64_t number(std::uint64_t offset, std::size_t num_bytes) const;
    [[nodiscard]] std::uint32_t u32(std::uint64_t offset) const {
        return static_cast<std::uint32_t>(number(offset, 4));
    }
    [[nodiscard]] std::uint16_t u16(std::uint64_t offset) const {
        return static_cast<std::uint16_t>(number(offset, 2));
    }
    [[nodiscard]] const std::vector<std::byte>& bytes() const { return bytes_; }

private:
    const FileBytes* file_;
    std::vector<std::byte> bytes_;
    bool is_big_endian_;
};

} // namespace relumine::cubemap
