// What all subcommands share: common options, cancellation, progress, output.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "app/command_line/command_line.h"
#include "app/progress_lines.h"
#include "app/report.h"
#include "app/run_estimate.h"

namespace relumine::prt {
class Team;
struct Work;
} // namespace relumine::prt

namespace relumine::app {

/// Options and state of one run of the program.
class Session {
public:
    bool json = false;
    bool quiet = false;
    bool verbose = false;
    /// 0: all
    unsigned num_threads = 0;
    /// The processes that share the command's work, of `relumine-mpi`; null: there is but this one.
    prt::Team* team = nullptr;
    /// In the others: whether the first process is known to be alive. Empty: nobody knows.
    std::function<bool()> is_first_alive = {};

    Session();

    /// The team, or this process alone.
    [[nodiscard]] prt::Team& processes() const;
    /// Whether this process writes the outputs.
    [[nodiscard]] bool is_first() const;

    /// Adds --json, --threads, -q and -v to a subcommand.
    void add_common_options(Command& command);

    /// Set by Ctrl-C, SIGTERM and SIGHUP. Work that goes on for more than 0.15 s is ended
    /// from outside: outputs that are not complete disappear. See Patience.
    [[nodiscard]] std::stop_token stop() const { return stop_source_.get_token(); }
    /// Throws prt::Cancelled after Ctrl-C, or after cancel().
    void poll() const;
    /// Ends the work as Ctrl-C does, but for what is said.
    void cancel() { stop_source_.request_stop(); }

    /// Shows a bar with the time left on a terminal, lines elsewhere (ProgressLines), nothing in
    /// the first second or with -q. To be called with fractions in [0, 1].
    /// While a run is open, stages of the run show one percentage of all.
    [[nodiscard]] std::function<void(double)> progress(const std::string& what);
    /// Opens a run of several stages, whose progress() is shown as one until end_run(). A terminal
    /// shows it twice a second, whether a stage says something or not.
    void begin_run(const std::string& what, std::vector<RunEstimate::Stage> stages);
    void end_run();
    /// The handle of long work that shows its progress, without its processes.
    [[nodiscard]] prt::Work work(const std::string& what);
    /// Ends the bar's line. Harmless when there is none.
    void end_progress() const;

    /// One line of result for people, at once; nothing with --json or -q.
    void say(const std::string& line) const;
    /// One line only with -v.
    void detail(const std::string& line) const;
    /// One line on stderr, "warning: ..."; nothing with -q. The report has it, too.
    void warn(const std::string& message) const;
    /// One line on stderr, "relumine: ...", for a failure after which the command goes on. Of an
    /// end by a signal that was told of already, nothing.
    void complain(const std::string& message, const char* program = "relumine") const;
    /// Adds a field to the report of this run.
    void add_to_report(const std::string& name, const Report& value) const;
    /// The result: with --json the object on stdout, with what add_to_report() gathered, and all
    /// warnings as the list "warnings".
    void report(Report result) const;

private:
    struct Run {
        std::string what;
        RunEstimate estimate;
        double start = 0.0;
        ProgressLines lines = {};
    };
    void show_run() const;

    std::stop_source stop_source_;
    /// Guards the others, since progress and warnings come from other threads, too.
    mutable std::mutex mutex_;
    mutable bool bar_open_ = false;
    mutable std::vector<std::string> warnings_;
    mutable Report more_fields_;
    mutable std::optional<Run> run_;
    /// Shows the run; ends before what it shows.
    std::jthread ticker_;
};

/// What is said when the work is ended from outside, at first "cancelled; nothing was written".
void set_cancelled_message(const std::string& message);
/// Another process says that the work was ended from outside, and this one does not.
void leave_last_words_to_others();
/// For processes that share work: what one says that was told to end and waits for the others,
/// since one of them may be gone. Its starter kills it soon. Nothing is said where
/// `does_another_say_it`, which is asked when the signal comes.
void set_waiting_message(std::function<std::string()> message,
                         std::function<bool()> does_another_say_it = {});

/// One line of plain text, whatever the message looked like: what a file holds may be quoted in it.
[[nodiscard]] std::string one_line(std::string message);

/// While it exists, Ctrl-C waits for the work to end by itself, as where another program must be
/// told. A second signal, at least a second later, ends the program nevertheless.
class Patience {
public:
    Patience();
    ~Patience();
    Patience(const Patience&) = delete;
    Patience& operator=(const Patience&) = delete;
};

/// Seconds since it was made or last asked.
class Stopwatch {
public:
    Stopwatch();
    /// Seconds since the start or the last lap().
    double lap();
    [[nodiscard]] double total() const;

private:
    double start_;
    double last_;
};

/// Largest memory use of this process so far.
[[nodiscard]] std::uint64_t peak_bytes();

} // namespace relumine::app
