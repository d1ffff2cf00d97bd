// xxHash64 of bytes: checksums in files, and what tells one input from another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace relumine::files {

[[nodiscard]] std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t seed = 0);

/// Returns the hash of a file's bytes.
/// Throws:  as read().
[[nodiscard]] std::uint64_t file_hash(const std::filesystem::path& path);

} // namespace relumine::files
