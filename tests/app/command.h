// Runs the program as a user would and tells all that it did.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/types.h>

namespace relumine::app {

/// What a build with sanitizers may take of each, in units of what the program as it is shipped may
/// take.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr int SanitizerFactor = 20;
#else
inline constexpr int SanitizerFactor = 1;
#endif

/// Processor seconds for what ends at once, many times what it takes. Other programs do not make
/// it more, as they do a clock's.
inline constexpr double AtOnce = 10.0 * SanitizerFactor;

/// What a command did.
struct Result {
    /// -1 when a signal ended it
    int exit_code = -1;
    /// The signal that ended it
    int signal = 0;
    std::string out;
    std::string err;
    /// On the clock
    double seconds = 0.0;
    double processor_seconds = 0.0;
    /// Largest resident set
    std::uint64_t peak_bytes = 0;

    /// For messages of failed tests.
    [[nodiscard]] std::string described() const;
    /// The object on stdout. A test failure and an empty object when stdout holds anything else.
    [[nodiscard]] nlohmann::json json() const;
};

/// What the program is called with: words, or a line of words without blanks.
struct Words : std::vector<std::string> {
    using std::vector<std::string>::vector;
    Words(const std::vector<std::string>& words) : vector(words) {}
    Words(const char* line);
};

struct RunOptions {
    /// Writing beyond fails, as on a full disk
    std::optional<std::uint64_t> max_file_bytes = {};
    /// Where stdout goes instead of Result::out
    std::string stdout_path = {};
    /// Nobody reads stdout, as behind `| true`
    bool is_unread = false;
    /// Where stdin comes from
    std::string stdin_path = "/dev/null";
    /// `ulimit -v` and `ulimit -s`
    std::optional<std::uint64_t> max_address_bytes = {}, stack_bytes = {};
    /// From the start, as `nohup` does it
    int ignored_signal = 0;
};

/// A running `relumine`. Killed, with a test failure, when it does not end.
class Process {
public:
    Process(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
            const RunOptions& options = {});
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    void send(int signal) const;
    /// False when it ended.
    [[nodiscard]] bool is_running();
    /// Processor seconds until now
    [[nodiscard]] double processor_seconds();
    /// Waits until the program has come so far that it takes signals (its threads block those that
    /// one of them waits for).
    void wait_until_it_takes(int signal);
    /// Fails, and ends the program, where it takes too much processor time, or none for long.
    [[nodiscard]] Result wait();

private:
    bool poll(bool block);

    pid_t pid_ = -1;
    double start_ = 0.0;
    int status_ = 0;
    bool ended_ = false;
    std::filesystem::path out_;
    std::filesystem::path err_;
    Result result_;
};

/// A folder of the test's own, in which the program runs and which goes away with the test.
class AppTest : public testing::Test {
protected:
    AppTest();
    ~AppTest() override;

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

    /// `relumine ARGUMENTS...` with the test's folder as the current one.
    [[nodiscard]] Result relumine(const Words& arguments, const RunOptions& options = {}) const;
    /// The same, expected to succeed.
    Result succeed(const Words& arguments) const;
    /// Expected to end with exit code 1 and one line that begins "relumine: " and holds all of
    /// `parts`, and to leave every file of the folder as it was and no new one.
    Result fail(const Words& arguments, const std::vector<std::string>& parts = {},
                const RunOptions& options = {}) const;
    /// Expected to end with exit code 2, one line on stderr and nothing done.
    Result misuse(const Words& arguments, const std::string& part = {}) const;

    /// Names (relative) and content hashes of all files below the folder.
    [[nodiscard]] std::vector<std::string> files() const;

    void write(const std::string& name, const std::string& content) const;
    [[nodiscard]] std::string read(const std::string& name) const;

private:
    std::filesystem::path folder_;
};

} // namespace relumine::app
