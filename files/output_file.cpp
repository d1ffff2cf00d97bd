#include "files/output_file.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace relumine::files {

namespace {

/// A POSIX file descriptor that closes itself.
struct Descriptor {
    int fd;
    explicit Descriptor(int descriptor) : fd(descriptor) {}
    ~Descriptor() {
        if (fd >= 0)
            ::close(fd);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
};

[[noreturn]] void fail(const std::filesystem::path& path, const char* action, int error) {
    throw std::runtime_error(fmt::format("{}: cannot {}: {}", path.string(), action, std::strerror(error)));
}

/// Opens for reading and states the size; refuses everything that is not a regular file.
std::pair<int, std::size_t> open_for_reading(const std::filesystem::path& path) {
    // Without O_NONBLOCK, opening a pipe would wait for a writer.
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        fail(path, "read", errno);
    struct stat status {};
    if (::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
        ::close(fd);
        throw std::runtime_error(fmt::format("{}: cannot read: not a regular file", path.string()));
    }
    return {fd, static_cast<std::size_t>(status.st_size)};
}

} // namespace

OutputFile::OutputFile(std::filesystem::path target) : target_(std::move(target)) {
    // Renaming over a pipe or a device would put a file in its place.
    struct stat status {};
    if (::stat(target_.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
        if (S_ISDIR(status.st_mode))
            fail(target_, "write", EISDIR);
        throw std::runtime_error(fmt::format("{}: cannot write: not a regular file", target_.string()));
    }
    // mkstemp chooses a name that no other process has; the extension is kept for writers that look at it.
    const std::string extension = target_.extension().string();
    std::string name =
        (target_.parent_path() / fmt::format(".{}.XXXXXX{}", target_.stem().string(), extension)).string();
    const Descriptor file(::mkstemps(name.data(), static_cast<int>(extension.size())));
    if (file.fd < 0)
        fail(target_, "write", errno);
    temporary_ = name;
    // mkstemp makes private files; an output has the permissions any other program would give it.
    const mode_t mask = ::umask(0);
    ::umask(mask);
    ::fchmod(file.fd, 0666 & ~mask);
}

OutputFile::~OutputFile() {
    if (!committed_)
        ::unlink(temporary_.c_str());
}

void OutputFile::write(std::span<const std::byte> bytes) {
    const Descriptor file(::open(temporary_.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC));
    if (file.fd < 0)
        fail(target_, "write", errno);
    while (!bytes.empty()) {
        const ssize_t written = ::write(file.fd, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            fail(target_, "write", written < 0 ? errno : ENOSPC);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void OutputFile::commit() {
    const Descriptor file(::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.fd < 0 || ::fsync(file.fd) != 0)
        fail(target_, "write", errno);
    if (::rename(temporary_.c_str(), target_.c_str()) != 0)
        fail(target_, "write", errno);
    committed_ = true;
}

void save_text(const std::filesystem::path& path, std::string_view text) {
    OutputFile file(path);
    file.write(std::as_bytes(std::span(text)));
    file.commit();
}

std::vector<std::byte> read(const std::filesystem::path& path) {
    const auto [fd, num_bytes] = open_for_reading(path);
    const Descriptor file(fd);
    std::vector<std::byte> bytes(num_bytes);
    std::size_t done = 0;
    while (done < num_bytes) {
        const ssize_t got = ::read(file.fd, bytes.data() + done, num_bytes - done);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            fail(path, "read", errno);
        if (got == 0)
            break; // the file became shorter while it was read
        done += static_cast<std::size_t>(got);
    }
    bytes.resize(done);
    return bytes;
}

std::size_t size(const std::filesystem::path& path) {
    const auto [fd, num_bytes] = open_for_reading(path);
    const Descriptor file(fd);
    return num_bytes;
}

} // namespace relumine::files
