#include "files/posix_file.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace relumine::files {

Descriptor::~Descriptor() {
    if (fd_ >= 0)
        ::close(fd_);
}

Descriptor::Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
}

void fail(const std::filesystem::path& path, const char* action, int error) {
    const std::filesystem::path folder = path.parent_path();
    std::error_code ignored;
    const bool is_missing =
        error == ENOENT && !folder.empty() && !std::filesystem::exists(folder, ignored);
    throw std::runtime_error(
        fmt::format("{}: cannot {}: {}{}", path.string(), action, std::strerror(error),
                    is_missing ? fmt::format(": there is no folder {}", folder.string()) : ""));
}

void fail_to_write(const std::filesystem::path& path, int error, std::uint64_t bytes_needed,
                   int file) {
    std::string figures;
    if (error == ENOSPC || error == EDQUOT || error == EFBIG)
        figures = fmt::format(": {} bytes needed", bytes_needed);
    struct statvfs disk{};
    struct rlimit limit{};
    // There is no portable way to ask how much a quota leaves.
    if (error == ENOSPC && ::fstatvfs(file, &disk) == 0)
        figures +=
            fmt::format(", {} free", static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize);
    else if (error == EFBIG && ::getrlimit(RLIMIT_FSIZE, &limit) == 0 &&
             limit.rlim_cur != RLIM_INFINITY)
        figures += fmt::format(", {} allowed", limit.rlim_cur);
    throw std::runtime_error(
        fmt::format("{}: cannot write: {}{}", path.string(), std::strerror(error), figures));
}

void write_at(const std::filesystem::path& path, int file, std::uint64_t offset,
              std::span<const std::byte> bytes, std::uint64_t bytes_needed,
              std::uint64_t size_after_error) {
    while (!bytes.empty()) {
        const ssize_t written =
            ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0) {
            const int error = written < 0 ? errno : ENOSPC;
            static_cast<void>(::ftruncate(file, static_cast<off_t>(size_after_error)) == 0);
            fail_to_write(path, error, bytes_needed, file);
        }
        bytes = bytes.subspan(static_cast<std::size_t>(written));
        offset += static_cast<std::uint64_t>(written);
    }
}

void sync_folder(const std::filesystem::path& folder) {
    const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (descriptor.is_open())
        static_cast<void>(::fsync(descriptor.get()) == 0);
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

} // namespace relumine::files
