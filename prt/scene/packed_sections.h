// Reading a file of sections, as prt/scene/section_file.h writes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace relumine::prt {

/// Where the packed bytes of a section lie.
struct StoredSection {
    std::filesystem::path path = {};
    std::uint64_t offset = 0;
    std::uint64_t stored_size = 0;
    std::uint64_t size = 0;
    /// xxHash64 of the packed bytes
    std::uint64_t checksum = 0;
};

/// Bytes of a piece that PackedSections::stream() gives; the last one may have fewer.
inline constexpr std::size_t SectionPiece = std::size_t{1} << 20;

/// The sections of a file. A section is unpacked when it is asked for, so an unknown one costs no
/// more than its stored bytes. There is one limit on what all sections unpack to: 256 bytes for
/// each byte of the file, 256 MiB for a small file, and no more than the free memory.
///
/// Threads: one at a time.
/// Throws:  std::runtime_error "path: expected X, got Y".
class PackedSections {
public:
    /// Reads a file. Refuses one that is truncated, longer than it says, of another version or byte
    /// order, or changed in any bit, before its sizes are believed.
    explicit PackedSections(const std::filesystem::path& path);
    /// Takes the bytes of such a file. `path` is for messages.
    PackedSections(std::filesystem::path path, std::vector<std::byte> bytes);
    PackedSections(PackedSections&&) = default;
    PackedSections& operator=(PackedSections&&) = default;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] bool has(const std::string& name) const { return entries_.contains(name); }
    [[nodiscard]] std::vector<std::string> names() const;
    /// Returns where a section lies in the file. Fails where there is none.
    [[nodiscard]] StoredSection stored(const std::string& name) const;

    /// Unpacks a section. Fails where there is none. `cost` is the memory that the caller makes of
    /// each byte.
    [[nodiscard]] std::vector<std::byte> bytes(const std::string& name,
                                               std::uint64_t cost = 1) const;

    /// Returns how many bytes a section unpacks to. Fails where there is none. `cost` as in
    /// bytes().
    [[nodiscard]] std::uint64_t size(const std::string& name, std::uint64_t cost = 1) const {
        return entry(name, cost).size;
    }
    /// Unpacks a section into the room that the caller makes for so many bytes. `cost` as in
    /// bytes().
    void unpack(const std::string& name, std::uint64_t cost,
                const std::function<std::span<std::byte>(std::size_t size)>& make_room) const;
    /// Unpacks a section and passes its pieces on, at the same time and in any order, each with its
    /// place in the section. `cost` as in bytes().
    void unpack_pieces(
        const std::string& name, std::uint64_t cost,
        const std::function<void(std::uint64_t begin, std::span<const std::byte>)>& on_piece) const;

    /// Passes the bytes of one section on, piece by piece in their order. Without a `size` it may
    /// have any.
    ///
    /// Memory:  one piece.
    /// Throws:  also where the section is missing or not of `size` bytes.
    void stream(const std::string& name, std::optional<std::uint64_t> size,
                const std::function<void(std::span<const std::byte>)>& on_piece) const;

private:
    struct Entry {
        std::span<const std::byte> stored;
        std::uint64_t size;
        std::uint64_t checksum;
    };
    /// A zstd frame of a section, and where its content begins and how many bytes it says it has.
    struct Frame {
        std::span<const std::byte> stored;
        std::uint64_t begin;
        std::uint64_t size;
    };
    [[nodiscard]] static std::vector<Frame> frames_of(std::span<const std::byte> stored_bytes,
                                                      std::uint64_t size);
    [[nodiscard]] std::vector<Frame> take(const std::string& name, std::uint64_t cost) const;
    void unpack_frame(const std::string& name, const Frame& frame,
                      std::span<std::byte> bytes) const;
    /// Returns a section. Fails where the ones before left fewer than `cost` bytes for each of its.
    [[nodiscard]] const Entry& entry(const std::string& name, std::uint64_t cost) const;
    [[noreturn]] void fail(std::string_view expected, std::string_view got) const;

    std::filesystem::path path_;
    std::vector<std::byte> bytes_;
    std::map<std::string, Entry> entries_;
    /// How many bytes sections may still become.
    mutable std::uint64_t budget_;
};

/// Whether a file begins as a file of sections does.
/// Throws:  std::runtime_error that names the path where it cannot be read.
[[nodiscard]] bool begins_as_sections(const std::filesystem::path& path);

/// Sections of a file by name (1 to 16 ASCII letters), each a string of bytes.
using Sections = std::map<std::string, std::vector<std::byte>>;

/// Unpacks all sections of a file.
/// Throws:  as PackedSections does.
[[nodiscard]] Sections read_sections(const std::filesystem::path& path);

} // namespace relumine::prt
