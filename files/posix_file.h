// POSIX files for the classes of this folder: whole writes, and errors that say what is missing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "files/descriptor.h"

namespace relumine::files {

/// Throws std::runtime_error "path: cannot ACTION: reason".
[[noreturn]] void fail(const std::filesystem::path& path, const char* action, int error);

/// Throws:  std::runtime_error "path: cannot write: reason". For a full disk, a quota or a limit,
///          the message adds the bytes needed, and the bytes available where the system tells.
///          `file` lies on the disk in question.
[[noreturn]] void fail_to_write(const std::filesystem::path& path, int error,
                                std::uint64_t bytes_needed, int file);

/// Writes all bytes at an offset.
/// Throws:  as fail_to_write(). The file is first cut to `size_after_error`, so the space that was
///          free is free again.
void write_at(const std::filesystem::path& path, int file, std::uint64_t offset,
              std::span<const std::byte> bytes, std::uint64_t bytes_needed,
              std::uint64_t size_after_error);

/// Syncs a folder after a file appeared in it or vanished, so that the disk holds the change. A
/// file system that cannot do so does it by itself.
void sync_folder(const std::filesystem::path& folder);

/// Returns the folder of a file; "." if the path has none.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& path);

} // namespace relumine::files
