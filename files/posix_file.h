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

/// Throws std::runtime_error "path: cannot write: reason", for a full disk, a quota or a limit with
/// the bytes needed, and what there is where the system tells. `file` lies on the disk in question.
[[noreturn]] void fail_to_write(const std::filesystem::path& path, int error,
                                std::uint64_t bytes_needed, int file);

/// Writes all bytes at an offset. Throws as fail_to_write() does, the file cut to
/// `size_after_error` before, so that what is free is what was free before.
void write_at(const std::filesystem::path& path, int file, std::uint64_t offset,
              std::span<const std::byte> bytes, std::uint64_t bytes_needed,
              std::uint64_t size_after_error);

/// After a file appeared or went, so that it does so on the disk. Not all file systems can; those
/// that cannot do it by themselves.
void sync_folder(const std::filesystem::path& folder);

/// The folder a file lies in, "." where its name has none.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& path);

} // namespace relumine::files
