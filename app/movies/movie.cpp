#include "app/movies/movie.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "files/descriptor.h"
#include "files/output_file.h"
#include "relumine/in/shared_work.h"
#include "relumine/options/option_table.h"

namespace relumine::app {

namespace {

namespace fs = std::filesystem;

/// ffmpeg with a pipe to its input; its complaints go to a file beside the movie.
class Encoder {
public:
    Encoder(const fs::path& ffmpeg, const fs::path& output, const fs::path& complaints,
            double fps) {
        std::array<int, 2> ends{};
        if (::pipe2(ends.data(), O_CLOEXEC) != 0)
            throw std::runtime_error(fmt::format("cannot start ffmpeg: {}", std::strerror(errno)));
        const files::Descriptor read_end(ends[0]);
        input_ = files::Descriptor(ends[1]);
        std::vector<std::string> words = words_of(ffmpeg, output, fps);
        std::vector<char*> arguments;
        arguments.reserve(words.size() + 1);
        for (std::string& word : words)
            arguments.push_back(word.data());
        arguments.push_back(nullptr);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, read_end.get(), STDIN_FILENO);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, complaints.c_str(),
                                         O_WRONLY | O_CREAT | O_TRUNC, 0600);
        // This program blocks the signals that end programs, to take them in a thread of its own;
        // ffmpeg must not inherit that.
        posix_spawnattr_t attributes;
        posix_spawnattr_init(&attributes);
        sigset_t none;
        sigemptyset(&none);
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
        const int error =
            ::posix_spawn(&pid_, ffmpeg.c_str(), &actions, &attributes, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
        if (error != 0) {
            pid_ = -1;
            throw std::runtime_error(
                fmt::format("{}: cannot start: {}", ffmpeg.string(), std::strerror(error)));
        }
    }
    ~Encoder() {
        if (pid_ > 0) { // left early
            ::kill(pid_, SIGTERM);
            static_cast<void>(wait());
        }
    }
    Encoder(const Encoder&) = delete;
    Encoder& operator=(const Encoder&) = delete;

    /// False when ffmpeg does not listen any more.
    [[nodiscard]] bool write(std::span<const std::byte> bytes) const {
        while (!bytes.empty()) {
            const ssize_t written = ::write(input_.get(), bytes.data(), bytes.size());
            if (written < 0 && errno == EINTR)
                continue;
            if (written <= 0)
                return false;
            bytes = bytes.subspan(static_cast<std::size_t>(written));
        }
        return true;
    }

    /// Whether ffmpeg ended well.
    [[nodiscard]] bool wait() {
        input_ = files::Descriptor();
        int status = 0;
        while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
        pid_ = -1;
        return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    }

private:
    static std::vector<std::string> words_of(const fs::path& ffmpeg, const fs::path& output,
                                             double fps) {
        // Players want even sides and 4:2:0.
        std::vector<std::string> words =
            split(fmt::format("ffmpeg -y -loglevel error -f image2pipe -c:v png -framerate {} -i - "
                              "-vf pad=ceil(iw/2)*2:ceil(ih/2)*2 -c:v libx264 -crf 17 -pix_fmt "
                              "yuv420p -movflags +faststart -f mp4",
                              fps),
                  ' ');
        words.front() = ffmpeg.string();
        words.push_back(output.string());
        return words;
    }

    files::Descriptor input_;
    pid_t pid_ = -1;
};

std::string last_line(const fs::path& path) {
    const std::vector<std::byte> bytes = files::read(path);
    std::istringstream lines(
        std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    std::string last = "no reason given";
    for (std::string line; std::getline(lines, line);)
        if (!line.empty())
            last = line;
    return last;
}

} // namespace

fs::path find_ffmpeg(const std::string& movie) {
    const char* path = std::getenv("PATH"); // NOLINT(concurrency-mt-unsafe): nothing changes it
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');) {
        fs::path candidate = fs::path(folder.empty() ? "." : folder) / "ffmpeg";
        if (::access(candidate.c_str(), X_OK) == 0 && !fs::is_directory(candidate))
            return candidate;
    }
    throw std::runtime_error(
        fmt::format("{}: expected ffmpeg on the PATH to make it, found none", movie));
}

void make_movie(const fs::path& ffmpeg, const std::string& movie,
                std::span<const std::string> pictures, double frames_per_second,
                const std::stop_token& stop) {
    files::OutputFile output{fs::path(movie)};
    const files::OutputFile complaints{fs::path(movie + ".log")}; // never committed
    Encoder encoder(ffmpeg, output.temporary(), complaints.temporary(), frames_per_second);
    bool listens = true;
    for (std::size_t i = 0; i < pictures.size() && listens; ++i) {
        if (stop.stop_requested())
            throw prt::Cancelled();
        listens = encoder.write(files::read(pictures[i]));
    }
    if (!encoder.wait() || !listens)
        throw std::runtime_error(
            fmt::format("{}: ffmpeg failed: {}", movie, last_line(complaints.temporary())));
    output.commit();
}

} // namespace relumine::app
