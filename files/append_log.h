// A file that grows by whole records. A crash in the middle of a record does no harm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "files/posix_file.h"

namespace relumine::files {

/// A log of records. A record is a head of 24 bytes (a mark, the record's size, xxHash64 of its
/// bytes) and its bytes. append() syncs before it returns, so a record on the disk is either whole
/// or recognised as torn.
class AppendLog {
public:
    /// Only keeps the path. No file is touched.
    explicit AppendLog(std::filesystem::path path);

    /// Returns the whole records in the first `max_bytes` of the file; none if there is no file. A
    /// torn or damaged record ends the list. Later records are appended after the last returned
    /// one, and replace what the file has there.
    /// Throws:  std::runtime_error if the file cannot be read.
    [[nodiscard]] std::vector<std::vector<std::byte>>
    read(std::optional<std::uint64_t> max_bytes = {});

    /// Appends a record.
    /// Throws:  std::runtime_error naming the file; the log is then as before.
    void append(std::span<const std::byte> record);

    /// Drops records from the end. `size` is an earlier result of size().
    void cut(std::uint64_t size) { size_ = size; }

    /// Returns the size of all records in bytes.
    [[nodiscard]] std::uint64_t size() const { return size_; }

private:
    void open();

    std::filesystem::path path_;
    Descriptor file_;
    std::uint64_t size_ = 0;
};

} // namespace relumine::files
