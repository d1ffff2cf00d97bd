// Waits for a file to be saved by another program.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

namespace relumine::app {

/// Watches one file by name, so that programs that write in place and programs that rename a new
/// file over the old one both count.
class FileWatch {
public:
    /// Throws std::runtime_error naming the path.
    explicit FileWatch(const std::filesystem::path& path);
    ~FileWatch();
    FileWatch(const FileWatch&) = delete;
    FileWatch& operator=(const FileWatch&) = delete;

    /// Blocks until the file has been saved since the last call. Several writes within a few
    /// milliseconds are one save. Returns the file system's time of the last write or renaming, in
    /// steps of a few milliseconds; nothing when asked to stop (noticed within 50 ms).
    [[nodiscard]] std::optional<std::chrono::system_clock::time_point>
    wait(const std::stop_token& stop);

private:
    /// What tells two versions of the file apart; empty for no file.
    [[nodiscard]] std::string state() const;
    bool read_events() const;

    std::filesystem::path path_;
    /// At the last save
    std::string seen_;
    std::string file_name_;
    int descriptor_ = -1;
};

} // namespace relumine::app
