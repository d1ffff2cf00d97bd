// Based on: unix(7), poll(2).
#include "app/line_server.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstring>
#include <optional>
#include <stdexcept>
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
        if (std::exchange(is_too_long_, false))
            refuse_length(service);
        else if (line.find_first_not_of(" \t") != std::string_view::npos)
            answers_ += service.answer(line) + '\n';
    }

    void refuse_length(const LineService& service) {
        answers_ += service.refuse(fmt::format("expected a line of at most {} bytes, got more",
                                               service.max_line_bytes)) +
                    '\n';
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
        // Of a line that is too long only its end is looked for.
        if (lines_.find('\n', searched_) == std::string::npos &&
            (is_too_long_ || lines_.size() > service.max_line_bytes)) {
            is_too_long_ = true;
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

/// Whether a program answers at that socket. A full queue is an answer.
bool is_served(const fs::path& path) {
    const files::Descriptor probe = new_socket();
    const sockaddr_un address = address_of(path);
    return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) ==
               0 ||
           errno == EAGAIN || errno == EINPROGRESS;
}

bool is_a_socket(const fs::path& path) {
    struct stat status {};
    return ::lstat(path.c_str(), &status) == 0 && S_ISSOCK(status.st_mode);
}

/// Removes a socket that nobody serves. `aside` is a name of this process. The socket is looked at
/// under that name: of several programs that start together one alone can take it there, and a
/// socket that turns out to be served gets its name back.
void remove_stale(const fs::path& path, const fs::path& aside) {
    if (!is_a_socket(path))
        throw std::runtime_error(fmt::format(
            "{}: expected a new name, or a socket, got a file of another kind", path.string()));
    if (is_served(path))
        throw std::runtime_error(
            fmt::format("{}: expected a socket that nobody serves, got one in use", path.string()));
    if (::rename(path.c_str(), aside.c_str()) != 0) {
        if (errno == ENOENT)
            return;
        fail_to_serve(path, errno);
    }
    const bool is_stale = is_a_socket(aside) && !is_served(aside);
    if (!is_stale)
        static_cast<void>(::link(aside.c_str(), path.c_str()));
    ::unlink(aside.c_str());
    if (!is_stale)
        throw std::runtime_error(
            fmt::format("{}: expected a socket that nobody serves, got one in use", path.string()));
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
    // The socket gets its name when it is ready, so that every name that others see is of a socket
    // that is served or stale.
    fs::path hidden = path;
    hidden += fmt::format(".{}", ::getpid());
    fs::path aside = hidden;
    aside += "~";
    constexpr std::size_t MaxLength = sizeof(sockaddr_un::sun_path) - 1;
    if (aside.native().size() > MaxLength)
        throw std::runtime_error(fmt::format(
            "{}: expected a name of at most {} bytes, got {}", path.string(),
            MaxLength - (aside.native().size() - path.native().size()), path.native().size()));
    files::Descriptor listener = new_socket();
    ::unlink(hidden.c_str()); // of an earlier process of this number
    const sockaddr_un address = address_of(hidden);
    const mode_t mask = ::umask(0177);
    const int bound =
        ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
    const int bind_error = errno;
    ::umask(mask);
    if (bound != 0)
        fail_to_serve(path, bind_error);
    struct stat status {};
    constexpr int QueueLength = 16, MaxTries = 8;
    int error = ::listen(listener.get(), QueueLength) == 0 && ::lstat(hidden.c_str(), &status) == 0
                    ? EEXIST
                    : errno;
    try {
        for (int i = 0; error == EEXIST && i < MaxTries; ++i) {
            error = ::link(hidden.c_str(), path.c_str()) == 0 ? 0 : errno;
            if (error == EEXIST)
                remove_stale(path, aside);
        }
    } catch (...) {
        ::unlink(hidden.c_str());
        throw;
    }
    ::unlink(hidden.c_str());
    if (error != 0)
        fail_to_serve(path, error);
    device_ = status.st_dev;
    inode_ = status.st_ino;
    listener_ = std::move(listener);
}

LineSocket::~LineSocket() {
    struct stat status {};
    if (::lstat(path_.c_str(), &status) == 0 && status.st_dev == device_ && status.st_ino == inode_)
        ::unlink(path_.c_str());
}

void LineSocket::serve(const LineService& service, const std::stop_token& stop) {
    constexpr std::size_t MaxPeers = 64;
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
