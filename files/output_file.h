// Output files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace relumine::files {

/// A file being written under a temporary name beside its target. commit() syncs it to the disk and renames it over
/// the target; without commit() the destructor removes it and the target stays as it was.
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

    /// Replaces the content of the temporary file. Throws std::runtime_error naming the target (a full disk, say).
    void write(std::span<const std::byte> bytes);

    /// fsync and rename. Throws std::runtime_error naming the target; the target is then as it was.
    void commit();

private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    bool committed_ = false;
};

/// Writes a text file. Whole or not at all; throws as OutputFile does.
void save_text(const std::filesystem::path& path, std::string_view text);

/// The whole file. Throws std::runtime_error "path: cannot read: reason" for what is missing, unreadable or a folder.
[[nodiscard]] std::vector<std::byte> read(const std::filesystem::path& path);

/// The file's size in bytes, with the errors of read().
[[nodiscard]] std::size_t size(const std::filesystem::path& path);

} // namespace relumine::files
