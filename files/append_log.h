// A file that grows by whole records, and survives a crash in the middle of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "files/posix_file.h"

namespace relumine::files {

/// Each record is 24 bytes of head (a mark, its size, xxHash64 of its bytes) and its bytes.
/// append() syncs before it returns, so a record is either whole on the disk or torn and known as
/// torn.
class AppendLog {
public:
    /// Nothing is touched yet.
    explicit AppendLog(std::filesystem::path path);

    /// The whole records of the first `max_bytes` of the file, none where there is no file; later
    /// records follow the last of them and what was behind it goes. A torn or damaged record ends
    /// the list. Throws std::runtime_error when the file cannot be read.
    [[nodiscard]] std::vector<std::vector<std::byte>>
    read(std::optional<std::uint64_t> max_bytes = {});

    /// Throws std::runtime_error naming the file; the log is then as before.
    void append(std::span<const std::byte> record);

    /// Takes back records: those up to a size() of before stay.
    void cut(std::uint64_t size) { size_ = size; }

    /// Bytes of all records.
    [[nodiscard]] std::uint64_t size() const { return size_; }

private:
    void open();

    std::filesystem::path path_;
    Descriptor file_;
    std::uint64_t size_ = 0;
};

} // namespace relumine::files
