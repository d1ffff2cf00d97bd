// Output files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "files/descriptor.h"

namespace relumine::files {

/// A file that is written under a temporary name beside its target. commit() syncs it to the disk
/// and renames it over the target. Without commit() the destructor removes it, and the target stays
/// as it was.
///
/// A target that is a symbolic link stays a link: the file it points to is replaced. A target that
/// is there keeps its permissions. If several writers share a target, the last commit wins with a
/// whole file. The temporary file of a killed process is taken over by the next writer of the
/// target.
class OutputFile {
public:
    /// Creates the temporary file, so an unwritable folder is found before any work is done.
    /// Throws:  std::runtime_error "path: cannot write: reason".
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Returns the name to write to.
    [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }

    /// Replaces the content of the temporary file.
    /// Throws:  std::runtime_error naming the target. For a full disk, a quota or a limit, the
    ///          message also says how many bytes are needed.
    void write(std::span<const std::byte> bytes);

    /// Adds bytes at the end of the temporary file.
    /// Throws:  as write().
    void append(std::span<const std::byte> bytes);
    /// Replaces bytes that were written before.
    /// Throws:  as write(); std::invalid_argument for bytes beyond the end.
    void replace(std::uint64_t offset, std::span<const std::byte> bytes);
    /// Announces the size of the whole file, or an estimate of it, for the message about a full
    /// disk.
    void expect(std::uint64_t num_bytes) { expected_size_ = num_bytes; }

    /// Syncs the file and renames it over the target.
    /// Throws:  std::runtime_error naming the target; the target is then as it was.
    void commit();

private:
    void open_temporary();
    void keep_permissions();

    std::filesystem::path target_;
    /// The target with symbolic links followed.
    std::filesystem::path place_;
    std::filesystem::path temporary_;
    /// Descriptor of the temporary file, which is locked.
    Descriptor file_;
    std::uint64_t size_ = 0;
    std::uint64_t expected_size_ = 0;
    bool committed_ = false;
};

/// Removes the temporary files of all OutputFiles of this process. Later calls of commit() wait for
/// ever. For a process that calls _exit() now.
void abandon_outputs();

/// Writes a text file. The file appears whole or not at all.
/// Throws:  as OutputFile.
void save_text(const std::filesystem::path& path, std::string_view text);

/// Adds text to the end of a file, all of it or nothing; a crash may leave a part. For records, not
/// for results.
/// Throws:  as OutputFile.
void append_text(const std::filesystem::path& path, std::string_view text);

/// Returns the content of a whole file.
/// Throws:  std::runtime_error "path: cannot read: reason" for a file that is missing or
///          unreadable, and for a folder.
[[nodiscard]] std::vector<std::byte> read(const std::filesystem::path& path);

/// Returns `size` bytes of a file from `offset` on; fewer where it ends before.
/// Throws:  as read().
[[nodiscard]] std::vector<std::byte> read(const std::filesystem::path& path, std::uint64_t offset,
                                          std::size_t size);

/// Returns the size of a file in bytes.
/// Throws:  as read().
[[nodiscard]] std::size_t size(const std::filesystem::path& path);

/// Makes a folder and those above it; one that is there stays.
///
/// Throws:  std::runtime_error "path: cannot make the folder: ...".
void make_folder(const std::filesystem::path& path);

} // namespace relumine::files
