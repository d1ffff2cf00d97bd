// Output files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/descriptor.h"

namespace relumine::files {

/// A file being written under a temporary name beside its target. commit() syncs it to the disk and
/// renames it over the target; without commit() the destructor removes it and the target stays as
/// it was. A target that is a symbolic link stays one: what it points to is replaced. Of several
/// writers of one target the last to commit wins, whole. The temporary file of a killed process is
/// taken over by the next one that writes the target.
class OutputFile {
public:
    /// Creates the temporary file, so that an unwritable folder is found before any work is done.
    /// Throws std::runtime_error "path: cannot write: reason".
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// The name to write to.
    [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }

    /// Replaces the content of the temporary file. Throws std::runtime_error naming the target; for
    /// a full disk, a quota or a limit also the bytes needed.
    void write(std::span<const std::byte> bytes);

    /// Adds to it. Throws as write() does.
    void append(std::span<const std::byte> bytes);
    /// How large it will be, for that message.
    void expect(std::uint64_t num_bytes) { expected_size_ = num_bytes; }

    /// fsync and rename. Throws std::runtime_error naming the target; the target is then as it was.
    void commit();

private:
    void open_temporary();

    std::filesystem::path target_;
    /// The target, links followed
    std::filesystem::path place_;
    std::filesystem::path temporary_;
    /// Of the temporary file, locked
    Descriptor file_;
    std::uint64_t size_ = 0;
    std::uint64_t expected_size_ = 0;
    bool committed_ = false;
};

/// Writes a text file. Whole or not at all; throws as OutputFile does.
void save_text(const std::filesystem::path& path, std::string_view text);

/// Adds text to a file's end; all of it or nothing, but for a crash. Throws as OutputFile does. For
/// records, not for results.
void append_text(const std::filesystem::path& path, std::string_view text);

/// The whole file. Throws std::runtime_error "path: cannot read: reason" for what is missing,
/// unreadable or a folder.
[[nodiscard]] std::vector<std::byte> read(const std::filesystem::path& path);

/// The file's size in bytes, with the errors of read().
[[nodiscard]] std::size_t size(const std::filesystem::path& path);

} // namespace relumine::files
