#include "app/file_watch.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

namespace relumine::app {

namespace {

/// When a file was last written or got its name; now for one that is gone again.
std::chrono::system_clock::time_point change_time(const std::filesystem::path& path) {
    using Clock = std::chrono::system_clock;
    struct stat status{};
    if (::stat(path.c_str(), &status) != 0)
        return Clock::now();
    return Clock::time_point(std::chrono::duration_cast<Clock::duration>(
        std::chrono::seconds(status.st_ctim.tv_sec) +
        std::chrono::nanoseconds(status.st_ctim.tv_nsec)));
}

} // namespace

FileWatch::FileWatch(const std::filesystem::path& path)
    : path_(path), file_name_(path.filename().string()) {
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    descriptor_ = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    // The folder, not the file: a renamed-over file is another file.
    if (descriptor_ < 0 ||
        ::inotify_add_watch(descriptor_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO) < 0) {
        const int error = errno;
        if (descriptor_ >= 0)
            ::close(descriptor_);
        throw std::runtime_error(
            fmt::format("{}: cannot watch: {}", path.string(), std::strerror(error)));
    }
}

std::string FileWatch::state() const {
    struct stat status{};
    if (::stat(path_.c_str(), &status) != 0)
        return {};
    return fmt::format("{} {} {} {}.{}", status.st_dev, status.st_ino, status.st_size,
                       status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

FileWatch::~FileWatch() {
    ::close(descriptor_);
}

std::optional<std::chrono::system_clock::time_point> FileWatch::wait(const std::stop_token& stop) {
    using Clock = std::chrono::steady_clock;
    using std::chrono::milliseconds;
    constexpr milliseconds Poll(50);
    // Programs that write a file in two steps close it twice. Longer than a tick of the file
    // system's clock, so that the next save has another time.
    constexpr milliseconds Settle(12);
    bool is_pending = false;
    Clock::time_point last_event;
    while (!stop.stop_requested()) {
        pollfd entry{.fd = descriptor_, .events = POLLIN, .revents = 0};
        const milliseconds patience = is_pending ? Settle : Poll;
        if (::poll(&entry, 1, static_cast<int>(patience.count())) > 0 && read_events()) {
            is_pending = true;
            last_event = Clock::now();
        }
        if (!is_pending || Clock::now() - last_event < Settle)
            continue;
        is_pending = false;
        // A file that is as it was at the last save, or gone again, has not been saved.
        const std::string before = std::exchange(seen_, state());
        if (!seen_.empty() && seen_ != before)
            return change_time(path_);
    }
    return std::nullopt;
}

/// Returns true if any of the events that have come in is about the file.
bool FileWatch::read_events() const {
    alignas(inotify_event) std::array<char, 4096> buffer;
    bool is_about_file = false;
    for (ssize_t size = 0; (size = ::read(descriptor_, buffer.data(), buffer.size())) > 0;)
        for (std::size_t at = 0; at < static_cast<std::size_t>(size);) {
            inotify_event event{};
            std::memcpy(&event, buffer.data() + at, sizeof event);
            const char* name = buffer.data() + at + sizeof event;
            is_about_file = is_about_file || (event.len > 0 && file_name_ == name);
            at += sizeof event + event.len;
        }
    return is_about_file;
}

} // namespace relumine::app
