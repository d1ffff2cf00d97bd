// Based on: unix(7), poll(2).
#include "app/service/line_server.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "files/descriptor.h"

namespace relumine::app {

namespace {

namespace fs = std::filesystem;

/// So many programs are answered. As many more may wait until one of the first goes.
constexpr std::size_t MaxPeers = 64;

[[noreturn]] void fail_to_serve(const fs::path& path, int error) {
    throw std::runtime_error(
        fmt::format("{}: cannot serve: {}", path.string(), std::strerror(error)));
}

/// Wakes poll() when the program is asked to stop.
class StopEvent {
public:
    explicit StopEvent(const std::stop_token& stop)
        : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)), callback_(stop, Notify{event_.get()}) {}
    [[nodiscard]] pollfd entry() const {
        return {.fd = event_.get(), .events = POLLIN, .revents = 0};
    }

private:
    struct Notify {
        int event;
        void operator()() const {
            const std::uint64_t one = 1;
            static_cast<void>(!::write(event, &one, sizeof one));
        }
    };
    files::Descriptor event_;
    std::stop_callback<Notify> callback_;
};

/// One program at the other end: what it has sent, and what it has not read yet.
class Peer {
public:
    /// Of stdin and stdout, which are not closed.
    Peer() : in_(STDIN_FILENO), out_(STDOUT_FILENO) {}
    explicit Peer(files::Descriptor&& socket)
        : socket_(std::move(socket)), in_(socket_.get()), out_(socket_.get()) {}

    /// True when there is nothing more to do for it.
    [[nodiscard]] bool is_done() const { return is_gone_ || (has_ended_ && answers_.empty()); }

    /// Reads nothing while answers wait: a program that does not read them is not listened to.
    [[nodiscard]] pollfd entry() const {
        return answers_.empty() ? pollfd{.fd = in_, .events = POLLIN, .revents = 0}
                                : pollfd{.fd = out_, .events = POLLOUT, .revents = 0};
    }

    /// Reads or writes once, after poll() said that it will not block, and answers the whole lines.
    void step(const LineService& service, const std::stop_token& stop) {
        if (answers_.empty())
            read(service);
        else
            write();
        while (answers_.empty() && !is_gone_ && !stop.stop_requested()) {
            const std::size_t end = lines_.find('\n', searched_);
            if (end == std::string::npos)
                break;
            answer(service, std::string_view(lines_).substr(0, end));
            lines_.erase(0, end + 1);
            searched_ = 0;
            write();
        }
        if (answers_.empty() && lines_.find('\n', searched_) == std::string::npos)
            finish(service);
    }

private:
    void answer(const LineService& service, std::string_view line) {
        if (line.ends_with('\r'))
            line.remove_suffix(1);
        if (!std::exchange(is_too_long_, false) &&
            line.find_first_not_of(" \t") != std::string_view::npos)
            answers_ += service.answer(line) + '\n';
    }

    /// The last line may have no line break.
    void finish(const LineService& service) {
        searched_ = lines_.size();
        if (!at_end_ || has_ended_)
            return;
        has_ended_ = true;
        answer(service, lines_);
        lines_.clear();
        write();
    }

    void read(const LineService& service) {
        std::array<char, 65536> buffer;
        const ssize_t size = ::read(in_, buffer.data(), buffer.size());
        if (size < 0 && (errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK))
            return;
        if (size < 0)
            is_gone_ = true;
        if (size <= 0) {
            at_end_ = true;
            return;
        }
        lines_.append(buffer.data(), static_cast<std::size_t>(size));
        // A line that is too long is refused at once. Of the rest only its end is looked for.
        if (lines_.find('\n', searched_) == std::string::npos &&
            (is_too_long_ || lines_.size() > service.max_line_bytes)) {
            if (!std::exchange(is_too_long_, true))
                answers_ += service.refuse(fmt::format("expected a line of at most {} bytes, got "
                                                       "more",
                                                       service.max_line_bytes)) +
                            '\n';
            lines_.clear();
            searched_ = 0;
        }
    }

    void write() {
        // A pipe that poll() calls writable takes so much without blocking.
        const std::size_t size = std::min<std::size_t>(answers_.size(), PIPE_BUF);
        if (size == 0)
            return;
        const ssize_t written = socket_.is_open() ? ::send(out_, answers_.data(), answers_.size(),
                                                           MSG_NOSIGNAL | MSG_DONTWAIT)
                                                  : write_to_pipe(size);
        if (written >= 0)
            answers_.erase(0, static_cast<std::size_t>(written));
        else if (errno != EINTR && errno != EAGAIN && errno != EWOULDBLOCK)
            is_gone_ = true;
    }

    [[nodiscard]] ssize_t write_to_pipe(std::size_t size) const {
        pollfd entry{.fd = out_, .events = POLLOUT, .revents = 0};
        if (::poll(&entry, 1, 0) <= 0)
            return 0;
        return ::write(out_, answers_.data(), size);
    }

    files::Descriptor socket_;
    int in_;
    int out_;
    /// What was read and not answered.
    std::string lines_;
    /// So much of it has no line break.
    std::size_t searched_ = 0;
    std::string answers_;
    bool is_too_long_ = false;
    bool at_end_ = false;
    bool has_ended_ = false;
    bool is_gone_ = false;
};

sockaddr_un address_of(const fs::path& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.c_str(),
                std::min(path.native().size(), sizeof address.sun_path - 1));
    return address;
}

files::Descriptor new_socket() {
    return files::Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

[[noreturn]] void refuse_socket_in_use(const fs::path& path) {
    throw std::runtime_error(
        fmt::format("{}: expected a socket that nobody serves, got one in use", path.string()));
}

/// Takes the socket's name for this process, for as long as the result lives. Of several programs
/// that start together one gets it. The lock is a name in the system's abstract namespace, which
/// leaves no file behind; nobody listens there.
files::Descriptor name_lock(const fs::path& path) {
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    struct stat status{};
    if (::stat(folder.c_str(), &status) != 0)
        fail_to_serve(path, errno);
    const std::string name = fmt::format("relumine {:x} {:x} {:x}", status.st_dev, status.st_ino,
                                         std::hash<std::string>{}(path.filename().native()));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path + 1, sizeof address.sun_path - 1); // after a zero
    files::Descriptor lock = new_socket();
    if (::bind(lock.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
        return lock;
    if (errno == EADDRINUSE)
        refuse_socket_in_use(path);
    fail_to_serve(path, errno);
}

/// Refuses a name that is not free. A socket that nobody serves is.
void require_free(const fs::path& path) {
    struct stat status{};
    if (::lstat(path.c_str(), &status) != 0)
        return;
    if (!S_ISSOCK(status.st_mode))
        throw std::runtime_error(fmt::format(
            "{}: expected a new name, or a socket, got a file of another kind", path.string()));
    // A program elsewhere, in a container, may not see the lock.
    const files::Descriptor probe = new_socket();
    const sockaddr_un address = address_of(path);
    if (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
        errno != ECONNREFUSED)
        refuse_socket_in_use(path);
}

} // namespace

void serve_standard_streams(const LineService& service, const std::stop_token& stop) {
    const StopEvent stopped(stop);
    Peer peer;
    while (!peer.is_done() && !stop.stop_requested()) {
        std::array<pollfd, 2> entries = {stopped.entry(), peer.entry()};
        if (::poll(entries.data(), entries.size(), -1) > 0 && entries[1].revents != 0)
            peer.step(service, stop);
    }
}

LineSocket::LineSocket(const fs::path& path) : path_(path) {
    // The socket gets its name when programs can connect to it.
    fs::path hidden = path;
    hidden += fmt::format(".{}", ::getpid());
    constexpr std::size_t MaxLength = sizeof(sockaddr_un::sun_path) - 1;
    const std::size_t num_added = hidden.native().size() - path.native().size();
    if (hidden.native().size() > MaxLength)
        throw std::runtime_error(fmt::format("{}: expected a name of at most {} bytes, got {}",
                                             path.string(), MaxLength - num_added,
                                             path.native().size()));
    lock_ = name_lock(path);
    require_free(path);
    listener_ = new_socket();
    ::unlink(hidden.c_str()); // of an earlier process of this number
    const sockaddr_un address = address_of(hidden);
    const mode_t mask = ::umask(0177);
    const int bound =
        ::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
    const int bind_error = errno;
    ::umask(mask);
    if (bound != 0)
        fail_to_serve(path, bind_error);
    constexpr int QueueLength = static_cast<int>(MaxPeers);
    struct stat status{};
    if (::listen(listener_.get(), QueueLength) != 0 || ::lstat(hidden.c_str(), &status) != 0 ||
        ::rename(hidden.c_str(), path.c_str()) != 0) {
        const int error = errno;
        ::unlink(hidden.c_str());
        fail_to_serve(path, error);
    }
    device_ = status.st_dev;
    inode_ = status.st_ino;
}

LineSocket::~LineSocket() {
    struct stat status{};
    if (::lstat(path_.c_str(), &status) == 0 && status.st_dev == device_ && status.st_ino == inode_)
        ::unlink(path_.c_str());
}

void LineSocket::serve(const LineService& service, const std::stop_token& stop) {
    const StopEvent stopped(stop);
    std::vector<Peer> peers;
    std::vector<pollfd> entries;
    while (!stop.stop_requested()) {
        entries = {stopped.entry(),
                   {.fd = listener_.get(),
                    .events = static_cast<short>(peers.size() < MaxPeers ? POLLIN : 0),
                    .revents = 0}};
        for (const Peer& peer : peers)
            entries.push_back(peer.entry());
        if (::poll(entries.data(), entries.size(), -1) <= 0)
            continue;
        for (std::size_t i = 0; i < peers.size() && !stop.stop_requested(); ++i)
            if (entries[i + 2].revents != 0)
                peers[i].step(service, stop);
        std::erase_if(peers, [](const Peer& peer) { return peer.is_done(); });
        if ((entries[1].revents & POLLIN) != 0) {
            files::Descriptor socket(
                ::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
            if (socket.is_open())
                peers.emplace_back(std::move(socket));
        }
    }
}

} // namespace relumine::app
