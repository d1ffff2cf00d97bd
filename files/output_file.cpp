#include "files/output_file.h"

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/large_vector.h"
#include "files/posix_file.h"

namespace relumine::files {

namespace {

/// Opens a file for reading and returns its size. Refuses everything that is not a regular file.
std::pair<Descriptor, std::size_t> open_for_reading(const std::filesystem::path& path) {
    // Without O_NONBLOCK, opening a pipe would wait for a writer.
    Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file.is_open())
        fail(path, "read", errno);
    struct stat status{};
    if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode))
        throw std::runtime_error(fmt::format("{}: cannot read: not a regular file", path.string()));
    return {std::move(file), static_cast<std::size_t>(status.st_size)};
}

/// Returns the place that a write to `path` reaches: a symbolic link's target, which need not
/// exist.
std::filesystem::path followed(const std::filesystem::path& path) {
    constexpr int MaxLinks = 40; // as in Linux
    std::filesystem::path place = path;
    for (int i = 0; i < MaxLinks; ++i) {
        std::error_code error;
        const std::filesystem::path next = std::filesystem::read_symlink(place, error);
        if (error)
            return place;
        place = next.is_absolute() ? next : place.parent_path() / next;
    }
    fail(path, "write", ELOOP);
}

/// Returns true if an open and locked file may be written by this process: the file is still there
/// under its name and belongs to no one else.
bool is_own(int file, const std::filesystem::path& name) {
    struct stat opened{};
    struct stat named{};
    return ::fstat(file, &opened) == 0 && ::lstat(name.c_str(), &named) == 0 &&
           S_ISREG(opened.st_mode) && opened.st_nlink == 1 && opened.st_uid == ::geteuid() &&
           opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

/// The temporary files that exist. Whoever renames or removes one holds the mutex.
struct Temporaries {
    std::mutex mutex;
    std::set<std::filesystem::path> names;
};
Temporaries& temporaries() {
    static auto& all = *new Temporaries; // outlives the outputs of other static objects
    return all;
}

} // namespace

OutputFile::OutputFile(std::filesystem::path target) : target_(std::move(target)) {
    // Renaming over a pipe or a device would replace it by a file.
    struct stat status{};
    if (::stat(target_.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
        if (S_ISDIR(status.st_mode))
            fail(target_, "write", EISDIR);
        throw std::runtime_error(
            fmt::format("{}: cannot write: not a regular file", target_.string()));
    }
    place_ = followed(target_);
    // The temporary name may be shorter.
    if (::stat(place_.c_str(), &status) != 0 && errno == ENAMETOOLONG)
        fail(target_, "write", errno);
    const std::scoped_lock lock(temporaries().mutex);
    open_temporary();
    temporaries().names.insert(temporary_);
}

// Temporary names are numbered. A name belongs to the process that has locked its file. The file of
// a killed process is not locked and is taken over, so such files do not pile up. The extension is
// kept for writers that look at it.
void OutputFile::open_temporary() {
    constexpr int MaxWriters = 1000; // of one target at the same time
    // The name of the target may be as long as names can be; the temporary name must not be longer.
    constexpr std::size_t MaxExtension = 32, MaxStem = 255 - MaxExtension - 16;
    std::string extension = place_.extension().string();
    std::string stem = place_.stem().string();
    if (extension.size() > MaxExtension)
        extension.clear();
    stem.resize(std::min(stem.size(), MaxStem));
    for (int i = 0; i < MaxWriters; ++i) {
        const std::filesystem::path name =
            place_.parent_path() / fmt::format(".{}.writing-{}{}", stem, i, extension);
        Descriptor file(
            ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
        if (!file.is_open()) {
            const int error = errno; // access() changes it
            if (error == ELOOP || error == EISDIR ||
                (error == EACCES && ::access(name.c_str(), F_OK) == 0))
                continue; // the file of another user
            fail(target_, "write", error);
        }
        if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
            if (errno == EWOULDBLOCK)
                continue;
            break; // a file system without locks
        }
        if (!is_own(file.get(), name)) {
            // The file was renamed or removed before it was locked, so the name is free again.
            if (::access(name.c_str(), F_OK) != 0)
                --i;
            continue;
        }
        if (::ftruncate(file.get(), 0) != 0)
            fail(target_, "write", errno);
        temporary_ = name;
        file_ = std::move(file);
        keep_permissions();
        return;
    }
    // mkstemps chooses a name that no other process has.
    std::string name =
        (place_.parent_path() / fmt::format(".{}.XXXXXX{}", stem, extension)).string();
    file_ = Descriptor(::mkstemps(name.data(), static_cast<int>(extension.size())));
    if (!file_.is_open())
        fail(target_, "write", errno);
    temporary_ = name;
    // mkstemps makes private files. An output gets the usual permissions instead.
    const mode_t mask = ::umask(0);
    ::umask(mask);
    ::fchmod(file_.get(), 0666 & ~mask);
    keep_permissions();
}

/// A file that its owner made private stays private.
void OutputFile::keep_permissions() {
    struct stat status{};
    if (::stat(place_.c_str(), &status) != 0)
        return;
    constexpr mode_t Permissions = 0777;
    if (::fchmod(file_.get(), status.st_mode & Permissions) != 0)
        fail(target_, "write", errno);
}

OutputFile::~OutputFile() {
    if (committed_)
        return;
    const std::scoped_lock lock(temporaries().mutex);
    ::unlink(temporary_.c_str()); // before the lock ends with the descriptor
    temporaries().names.erase(temporary_);
}

void OutputFile::write(std::span<const std::byte> bytes) {
    if (::ftruncate(file_.get(), 0) != 0)
        fail(target_, "write", errno);
    size_ = 0;
    expect(bytes.size());
    append(bytes);
}

void OutputFile::append(std::span<const std::byte> bytes) {
    write_at(target_, file_.get(), size_, bytes,
             std::max<std::uint64_t>(expected_size_, size_ + bytes.size()), 0);
    size_ += bytes.size();
}

void OutputFile::replace(std::uint64_t offset, std::span<const std::byte> bytes) {
    if (offset > size_ || bytes.size() > size_ - offset)
        throw std::invalid_argument(
            fmt::format("{}: expected bytes within the {} that were written, got {} at {}",
                        target_.string(), size_, bytes.size(), offset));
    write_at(target_, file_.get(), offset, bytes, std::max(expected_size_, size_), 0);
}

void OutputFile::commit() {
    // Some file systems report a full disk only now.
    if (::fsync(file_.get()) != 0)
        fail_to_write(target_, errno, std::max(expected_size_, size_), file_.get());
    {
        const std::scoped_lock lock(temporaries().mutex);
        if (::rename(temporary_.c_str(), place_.c_str()) != 0)
            fail(target_, "write", errno);
        committed_ = true;
        temporaries().names.erase(temporary_);
    }
    sync_folder(folder_of(place_));
}

void abandon_outputs() {
    temporaries().mutex.lock();
    for (const std::filesystem::path& name : temporaries().names)
        ::unlink(name.c_str());
}

void save_text(const std::filesystem::path& path, std::string_view text) {
    OutputFile file(path);
    file.write(std::as_bytes(std::span(text.data(), text.size())));
    file.commit();
}

void append_text(const std::filesystem::path& path, std::string_view text) {
    const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
    struct stat status{};
    if (!file.is_open() || ::fstat(file.get(), &status) != 0)
        fail(path, "write", errno);
    const auto size = static_cast<std::uint64_t>(status.st_size);
    write_at(path, file.get(), size, std::as_bytes(std::span(text.data(), text.size())),
             text.size(), size);
}

namespace {

std::vector<std::byte> read_from(const std::filesystem::path& path, const Descriptor& file,
                                 std::uint64_t offset, std::size_t size) {
    auto bytes = large_vector<std::byte>(size);
    std::size_t done = 0;
    while (done < size) {
        const ssize_t got = ::pread(file.get(), bytes.data() + done, size - done,
                                    static_cast<off_t>(offset + done));
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

} // namespace

std::vector<std::byte> read(const std::filesystem::path& path) {
    const auto [file, num_bytes] = open_for_reading(path);
    return read_from(path, file, 0, num_bytes);
}

std::vector<std::byte> read(const std::filesystem::path& path, std::uint64_t offset,
                            std::size_t size) {
    const auto [file, num_bytes] = open_for_reading(path);
    return read_from(path, file, offset, size);
}

std::size_t size(const std::filesystem::path& path) {
    const auto [file, num_bytes] = open_for_reading(path);
    return num_bytes;
}

void make_folder(const std::filesystem::path& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error)
        throw std::runtime_error(
            fmt::format("{}: cannot make the folder: {}", path.string(), error.message()));
}

} // namespace relumine::files
