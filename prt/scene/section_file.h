// A file of named, compressed, checksummed sections: the container of .prt files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace relumine::prt {

/// The version that is written. All versions up to this one are read.
inline constexpr std::uint32_t SceneFileVersion = 4;

/// Sections by name (1 to 16 ASCII letters), each a string of bytes.
using Sections = std::map<std::string, std::vector<std::byte>>;

/// Writes sections compressed (zstd), with sizes and xxHash64 checksums; whole or not at all.
/// Returns the file's size.
///
/// Throws:  std::runtime_error that names the path.
std::uint64_t write_sections(const std::filesystem::path& path, const Sections& sections);

/// Reads a file of sections, all but those in `left_out`. Refuses a file that is truncated, longer
/// than it says, of an unknown version or byte order, or changed in any bit, before its sizes are
/// believed. `version` receives the file's version, 1 to SceneFileVersion.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] Sections read_sections(const std::filesystem::path& path,
                                     std::uint32_t* version = nullptr,
                                     std::span<const std::string> left_out = {});

/// Bytes of a piece that stream_section() gives; the last one may have fewer.
inline constexpr std::size_t SectionPiece = std::size_t{1} << 20;

/// Passes the bytes of one section on, piece by piece in their order. Without a `size` it may have
/// any.
///
/// Memory:  the file's bytes, compressed as they are, and one piece.
/// Throws:  as read_sections(), also where the section is missing or not of `size` bytes.
void stream_section(const std::filesystem::path& path, const std::string& name,
                    std::optional<std::uint64_t> size,
                    const std::function<void(std::span<const std::byte>)>& on_piece);

} // namespace relumine::prt
