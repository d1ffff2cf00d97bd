#include "tests/app/command.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relumine::app {

namespace fs = std::filesystem;

namespace {

/// Of the processors. An unoptimised build with sanitizers is slow.
constexpr double MaxProcessorSeconds = 400.0;
/// On the clock, without any of the processors': the program waits for what never comes.
constexpr double MaxIdleSeconds = 100.0;

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

double seconds_of(const struct timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

std::size_t num_lines(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::string joined(const std::vector<std::string>& words) {
    std::string line = "relumine";
    for (const std::string& word : words)
        line += ' ' + word;
    return line;
}

/// Between fork and exec, so with nothing but system calls.
void become_program(const char* folder, const char* out, const char* err, const RunOptions& options,
                    char* const* arguments) {
    int out_fd = ::open(out, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    int pipe_fds[2];
    if (options.is_unread && ::pipe2(pipe_fds, O_CLOEXEC) == 0) {
        ::close(pipe_fds[0]);
        out_fd = pipe_fds[1];
    }
    const int err_fd = ::open(err, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    const int in_fd = ::open(options.stdin_path.c_str(), O_RDONLY | O_CLOEXEC);
    ::dup2(in_fd, STDIN_FILENO);
    ::dup2(out_fd, STDOUT_FILENO);
    ::dup2(err_fd, STDERR_FILENO);
    if (::chdir(folder) != 0)
        ::_exit(126);
    // A shell that started the tests in the background may have some ignored.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXFSZ, SIGPIPE})
        ::signal(signal, SIG_DFL);
    if (options.ignored_signal != 0)
        ::signal(options.ignored_signal, SIG_IGN);
    const auto limit = [](auto resource, const std::optional<std::uint64_t>& bytes) {
        const struct rlimit most = {bytes.value_or(0), bytes.value_or(0)};
        if (bytes)
            ::setrlimit(resource, &most);
    };
    limit(RLIMIT_FSIZE, options.max_file_bytes);
    limit(RLIMIT_AS, options.max_address_bytes);
    limit(RLIMIT_STACK, options.stack_bytes);
    ::execv(RELUMINE_BINARY, arguments);
    ::_exit(127);
}

} // namespace

std::string Result::described() const {
    return fmt::format(
        "exit code {}, signal {}, {:.2f} processor s, {} bytes\nstdout: {}\nstderr: {}\n",
        exit_code, signal, processor_seconds, peak_bytes, out, err);
}

nlohmann::json Result::json() const {
    nlohmann::json result = nlohmann::json::parse(out, nullptr, false);
    EXPECT_TRUE(result.is_object()) << "expected one JSON object on stdout\n" << described();
    return result.is_object() ? result : nlohmann::json::object();
}

Words::Words(const char* line) {
    std::istringstream words(line);
    assign(std::istream_iterator<std::string>(words), {});
}

Process::Process(const fs::path& folder, const std::vector<std::string>& arguments,
                 const RunOptions& options)
    : start_(now()) {
    static int count = 0;
    const fs::path captured =
        fs::path(testing::TempDir()) / fmt::format("relumine_app_{}_{}", ::getpid(), count++);
    out_ = options.stdout_path.empty() ? fs::path(captured.string() + ".out")
                                       : fs::path(options.stdout_path);
    err_ = captured.string() + ".err";
    std::vector<std::string> words = {"relumine"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    pointers.reserve(words.size() + 1);
    for (std::string& word : words)
        pointers.push_back(word.data());
    pointers.push_back(nullptr);

    pid_ = ::fork();
    if (pid_ < 0)
        throw std::system_error(errno, std::generic_category(), "fork");
    if (pid_ == 0)
        become_program(folder.c_str(), out_.c_str(), err_.c_str(), options, pointers.data());
}

Process::~Process() {
    if (!ended_) {
        ::kill(pid_, SIGKILL);
        poll(true);
    }
    if (fs::is_regular_file(out_))
        fs::remove(out_);
    fs::remove(err_);
}

void Process::send(int signal) const {
    ::kill(pid_, signal);
}

bool Process::poll(bool block) {
    struct rusage usage{};
    if (!ended_ && ::wait4(pid_, &status_, block ? 0 : WNOHANG, &usage) == pid_) {
        ended_ = true;
        result_.seconds = now() - start_;
        result_.processor_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
        result_.peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
        if (WIFEXITED(status_))
            result_.exit_code = WEXITSTATUS(status_);
        if (WIFSIGNALED(status_))
            result_.signal = WTERMSIG(status_);
    }
    return ended_;
}

bool Process::is_running() {
    return !poll(false);
}

double Process::processor_seconds() {
    if (!is_running())
        return result_.processor_seconds;
    // The 14th and 15th member; the second is a name in brackets, which may hold spaces.
    const std::string text = content(fmt::format("/proc/{}/stat", pid_));
    std::istringstream members(text.substr(std::min(text.rfind(')'), text.size() - 1) + 1));
    std::string member;
    for (int i = 3; i < 14; ++i)
        members >> member;
    double user = 0.0, system = 0.0;
    members >> user >> system;
    return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

void Process::wait_until_it_takes(int signal) {
    const std::string status = fmt::format("/proc/{}/status", pid_);
    const std::string name = "SigBlk:";
    while (is_running()) {
        const std::string text = content(status);
        const std::size_t at = text.find(name);
        // Until the program is loaded it has the tests' name, and fork() may block signals for a
        // while.
        if (text.starts_with("Name:\trelumine\n") && at != std::string::npos &&
            (std::strtoull(text.c_str() + at + name.size(), nullptr, 16) >> (signal - 1) & 1u) != 0)
            return;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

Result Process::wait() {
    double busy = 0.0, busy_since = now(), next_look = now();
    while (!poll(false)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (now() < next_look)
            continue;
        next_look = now() + 0.1;
        if (const double seconds = processor_seconds(); seconds != busy) {
            busy = seconds;
            busy_since = now();
        }
        if (busy > MaxProcessorSeconds || now() - busy_since > MaxIdleSeconds) {
            ADD_FAILURE() << "the program did not end: " << busy << " processor seconds, the last "
                          << now() - busy_since << " s ago";
            ::kill(pid_, SIGKILL);
            poll(true);
        }
    }
    if (fs::is_regular_file(out_))
        result_.out = content(out_);
    result_.err = content(err_);
    return result_;
}

AppTest::AppTest() {
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    std::string name =
        fmt::format("relumine_{}_{}_{}", ::getpid(), test.test_suite_name(), test.name());
    std::replace(name.begin(), name.end(), '/', '_');
    folder_ = fs::path(testing::TempDir()) / name;
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    // Scenes are kept in the test's folder, where the program runs.
    ::setenv("RELUMINE_CACHE", "cache", 1); // NOLINT(concurrency-mt-unsafe)
}

AppTest::~AppTest() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

Result AppTest::relumine(const Words& arguments, const RunOptions& options) const {
    return Process(folder_, arguments, options).wait();
}

Result AppTest::succeed(const Words& arguments) const {
    Result result = relumine(arguments);
    EXPECT_EQ(result.exit_code, 0) << joined(arguments) << "\n" << result.described();
    return result;
}

Result AppTest::fail(const Words& arguments, const std::vector<std::string>& parts,
                     const RunOptions& options) const {
    const std::vector<std::string> before = files();
    Result result = relumine(arguments, options);
    const std::string what = joined(arguments) + "\n" + result.described();
    EXPECT_EQ(result.exit_code, 1) << what;
    EXPECT_EQ(num_lines(result.err), 1u) << what;
    EXPECT_EQ(result.err.rfind("relumine: ", 0), 0u) << what;
    EXPECT_EQ(result.out, "") << what;
    for (const std::string& part : parts)
        EXPECT_NE(result.err.find(part), std::string::npos) << "without '" << part << "': " << what;
    EXPECT_EQ(files(), before) << what;
    return result;
}

Result AppTest::misuse(const Words& arguments, const std::string& part) const {
    const std::vector<std::string> before = files();
    Result result = relumine(arguments);
    const std::string what = joined(arguments) + "\n" + result.described();
    EXPECT_EQ(result.exit_code, 2) << what;
    EXPECT_EQ(num_lines(result.err), 1u) << what;
    EXPECT_EQ(result.err.rfind("relumine: ", 0), 0u) << what;
    EXPECT_EQ(result.out, "") << what;
    EXPECT_NE(result.err.find(part), std::string::npos) << "without '" << part << "': " << what;
    EXPECT_EQ(files(), before) << what;
    return result;
}

std::vector<std::string> AppTest::files() const {
    std::vector<std::string> result;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
        const std::string name = fs::relative(entry.path(), folder_).string();
        if (entry.is_symlink())
            result.push_back(name + " -> " + fs::read_symlink(entry.path()).string());
        else if (entry.is_regular_file())
            result.push_back(
                fmt::format("{} {:x}", name, std::hash<std::string>{}(content(entry.path()))));
        else
            result.push_back(
                fmt::format("{} type {}", name, static_cast<int>(entry.status().type())));
    }
    std::sort(result.begin(), result.end());
    return result;
}

void AppTest::write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
}

std::string AppTest::read(const std::string& name) const {
    return content(folder_ / name);
}

} // namespace relumine::app
