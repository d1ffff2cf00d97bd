#include "app/session.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "app/command_line/printed.h"
#include "files/output_file.h"
#include "files/printable.h"
#include "relumine/in/shared_work.h"

namespace relumine::app {

namespace {

// To stderr by fputs() alone: fmt::print() throws where it cannot be written.

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// Ctrl-C, SIGTERM and a closed terminal, unless `nohup` says that it is none of the program's
/// business.
sigset_t signals_to_stop() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    struct sigaction on_hangup{};
    if (::sigaction(SIGHUP, nullptr, &on_hangup) == 0 && on_hangup.sa_handler != SIG_IGN)
        sigaddset(&signals, SIGHUP);
    return signals;
}

std::string duration(double seconds) {
    const long whole = std::lround(seconds);
    return whole < 60 ? fmt::format("{} s", whole)
                      : fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

/// What the thread of signals shares with the others. It may outlive the Session.
struct Shared {
    std::atomic<int> num_patient = 0;
    std::atomic<bool> is_bar_open = false;
    std::mutex mutex;
    /// True once the main thread has said how the work ended after a signal.
    bool is_said = false;
    /// What waits for other processes has said that it was told to end.
    bool is_waiting_said = false;
    bool leaves_words_to_others = false;
    std::string cancelled_message = "cancelled; nothing was written";
    std::function<std::string()> waiting_message = {};
    std::function<bool()> does_another_say_it = {};
    bool is_signalled = false;
};
Shared& shared() {
    static auto& all = *new Shared;
    return all;
}

[[noreturn]] void end_now() {
    files::abandon_outputs();
    std::string text = shared().is_bar_open ? "\r\033[K" : "";
    // Nobody holds the mutex for long.
    const std::scoped_lock lock(shared().mutex);
    if (shared().is_said || shared().is_waiting_said || shared().leaves_words_to_others)
        ::_exit(1);
    text += fmt::format("{}: {}\n", program_invocation_short_name, shared().cancelled_message);
    static_cast<void>(!::write(STDERR_FILENO, text.data(), text.size()));
    ::_exit(1);
}

/// Whoever was killed is gone before the others are signalled; whoever ends with them is not.
void find_who_says_it() {
    const std::scoped_lock lock(shared().mutex);
    shared().is_signalled = true;
    if (shared().does_another_say_it && shared().does_another_say_it())
        shared().waiting_message = {};
}

/// Says once that this process waits for others.
void say_waiting() {
    const std::scoped_lock lock(shared().mutex);
    const auto message = std::exchange(shared().waiting_message, {});
    if (!message || shared().is_said)
        return;
    std::fputs(fmt::format("relumine-mpi: {}\n", message()).c_str(), stderr);
    shared().is_waiting_said = true;
}

} // namespace

Session::Session() {
    // A write beyond the process's limit fails then like one on a full disk, with a message and
    // nothing left behind.
    std::signal(SIGXFSZ, SIG_IGN);
    // A pipe that nobody reads any more is an error of the write, which print() takes for the end
    // of what is wanted, and ffmpeg's end is said by whoever feeds it.
    std::signal(SIGPIPE, SIG_IGN);
    // Signals are taken by one thread, so that whatever it calls need not be safe inside a handler.
    // Threads started later inherit the mask.
    const sigset_t signals = signals_to_stop();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    const auto wait_for_signals = [signals, source = stop_source_]() mutable {
        int signal = 0;
        sigwait(&signals, &signal);
        const double first = now();
        find_who_says_it();
        source.request_stop();
        // What polls ends by itself before, with its own message. Libraries that read, write or
        // compress do not poll.
        constexpr double MostPatience = 0.15; // seconds
        // `timeout` and batch systems signal a process and then its whole group: the same wish
        // twice, not impatience.
        constexpr double SameWish = 1.0; // seconds
        // mpirun kills a second after its first signal.
        constexpr double WaitingSeconds = 0.3;
        constexpr timespec Tick = {.tv_sec = 0, .tv_nsec = 10'000'000};
        bool is_impatient = false;
        while (!is_impatient && (shared().num_patient > 0 || now() - first < MostPatience)) {
            if (now() - first >= WaitingSeconds)
                say_waiting();
            is_impatient = sigtimedwait(&signals, nullptr, &Tick) > 0 && now() - first >= SameWish;
        }
        end_now();
    };
    try {
        std::thread(wait_for_signals).detach();
    } catch (const std::system_error& error) {
        complain(fmt::format("cannot start a thread: {}", error.code().message()));
        ::_exit(1);
    }
}

void set_cancelled_message(const std::string& message) {
    const std::scoped_lock lock(shared().mutex);
    shared().cancelled_message = message;
}

void leave_last_words_to_others() {
    const std::scoped_lock lock(shared().mutex);
    shared().leaves_words_to_others = true;
}

void set_waiting_message(std::function<std::string()> message,
                         std::function<bool()> does_another_say_it) {
    const std::scoped_lock lock(shared().mutex);
    if (shared().is_signalled && does_another_say_it)
        return; // too late to ask: the other may have ended since
    shared().waiting_message = std::move(message);
    shared().does_another_say_it = std::move(does_another_say_it);
}

Patience::Patience() {
    ++shared().num_patient;
}

Patience::~Patience() {
    --shared().num_patient;
}

prt::Team& Session::processes() const {
    return team != nullptr ? *team : prt::alone();
}

bool Session::is_first() const {
    return processes().is_first();
}

void Session::add_common_options(Command& command) {
    OptionTable table = {
        row("--json", json, "print one JSON object with all figures on stdout"),
        row("--threads", num_threads, "threads to use, 0 for all", {.min = 0, .max = 4096}),
        row("-q,--quiet", quiet, "print errors only"), row("-v,--verbose", verbose, "print more")};
    for (OptionRow& each : table) {
        each.shapes_frames = false;
        command.add(std::move(each));
    }
}

void Session::poll() const {
    if (stop_source_.stop_requested())
        throw prt::Cancelled();
}

std::function<void(double)> Session::progress(const std::string& what) {
    if (quiet)
        return {};
    struct State {
        /// When it was first called
        double start = -1.0;
        /// And with what: the run may take up another one
        double first_fraction = 0.0;
        double last_shown = 0.0;
        ProgressLines lines = {};
    };
    const bool terminal = ::isatty(STDERR_FILENO) != 0;
    return [this, what, terminal, state = State{}](double fraction) mutable {
        const std::scoped_lock lock(mutex_);
        const double time = now();
        if (run_)
            if (const std::optional<std::size_t> stage = run_->estimate.find(what)) {
                run_->estimate.tell(*stage, fraction, time - run_->start);
                return show_run();
            }
        if (state.start < 0.0) {
            state.start = time;
            state.first_fraction = fraction;
        }
        const double elapsed = time - state.start;
        const double done = fraction - state.first_fraction;
        if (elapsed < 1.0 || done <= 0.0)
            return;
        // The first guess of how much there is may be far off.
        constexpr double LeastToJudge = 0.01;
        const std::string left =
            done < LeastToJudge
                ? ""
                : fmt::format(", about {} left", duration(elapsed / done * (1.0 - fraction)));
        if (terminal) {
            if (time - state.last_shown < 0.1 && fraction < 1.0)
                return;
            state.last_shown = time;
            std::fputs(fmt::format("\r{}: {:3.0f} %{}   ", what, 100.0 * fraction, left).c_str(),
                       stderr);
            std::fflush(stderr);
            bar_open_ = true;
            shared().is_bar_open = true;
        } else if (state.lines.is_due(fraction, elapsed)) {
            std::fputs(fmt::format("{}: {:.0f} %{}\n", what, 100.0 * fraction, left).c_str(),
                       stderr);
        }
    };
}

void Session::begin_run(const std::string& what, std::vector<RunEstimate::Stage> stages) {
    end_run();
    if (quiet || !is_first())
        return;
    {
        const std::scoped_lock lock(mutex_);
        run_ = Run{.what = what, .estimate = RunEstimate(std::move(stages)), .start = now()};
    }
    ticker_ = std::jthread([this](const std::stop_token& ended) {
        std::mutex waits;
        std::condition_variable_any change;
        for (std::unique_lock lock(waits);
             !change.wait_for(lock, ended, std::chrono::milliseconds(500), [] { return false; }) &&
             !ended.stop_requested();) {
            const std::scoped_lock shows(mutex_);
            if (run_)
                show_run();
        }
    });
}

void Session::end_run() {
    ticker_ = {};
    {
        const std::scoped_lock lock(mutex_);
        run_.reset();
    }
    end_progress();
}

/// Shows the run as it stands. The mutex is held.
void Session::show_run() const {
    const double elapsed = now() - run_->start;
    if (elapsed < 1.0 || stop_source_.stop_requested())
        return;
    const double fraction = run_->estimate.fraction(elapsed);
    const std::optional<double> left = run_->estimate.seconds_left(elapsed);
    const std::string text =
        fmt::format("{}: {:.0f} %{}{}", run_->what, 100.0 * fraction,
                    run_->estimate.present().empty() ? "" : ", " + run_->estimate.present(),
                    left ? fmt::format(", about {} left", duration(*left)) : "");
    if (::isatty(STDERR_FILENO) != 0) {
        std::fputs(("\r" + text + "\033[K").c_str(), stderr);
        std::fflush(stderr);
        bar_open_ = true;
        shared().is_bar_open = true;
    } else if (run_->lines.is_due(fraction, elapsed)) {
        std::fputs((text + "\n").c_str(), stderr);
    }
}

prt::Work Session::work(const std::string& what) {
    return {.stop = stop(), .on_progress = progress(what)};
}

void Session::end_progress() const {
    const std::scoped_lock lock(mutex_);
    if (bar_open_)
        std::fputs("\r\033[K", stderr);
    bar_open_ = false;
    shared().is_bar_open = false;
}

void Session::say(const std::string& line) const {
    if (json || quiet)
        return;
    end_progress();
    print(files::printable(line) + "\n"); // names in files may be anything
}

void Session::detail(const std::string& line) const {
    if (verbose)
        say(line);
}

void Session::warn(const std::string& message) const {
    end_progress();
    if (!quiet)
        std::fputs(fmt::format("warning: {}\n", one_line(message)).c_str(), stderr);
    const std::scoped_lock lock(mutex_);
    warnings_.push_back(message);
}

void Session::complain(const std::string& message, const char* program) const {
    {
        const std::scoped_lock lock(mutex_);
        run_.reset();
    }
    end_progress();
    const std::scoped_lock lock(shared().mutex);
    if (shared().is_waiting_said && message.starts_with("cancelled"))
        return;
    shared().is_said = stop_source_.stop_requested();
    std::fputs(fmt::format("{}: {}\n", program, one_line(message)).c_str(), stderr);
}

void Session::add_to_report(const std::string& name, const Report& value) const {
    const std::scoped_lock lock(mutex_);
    more_fields_.set(name, value);
}

void Session::report(Report result) const {
    if (!json)
        return;
    {
        const std::scoped_lock lock(mutex_);
        files::update(result, std::exchange(more_fields_, Report()));
        result.set("warnings", std::exchange(warnings_, {}));
    }
    print(result.text(2) + "\n");
}

std::string one_line(std::string message) {
    while (!message.empty() && (message.back() == '\n' || message.back() == ' '))
        message.pop_back();
    // Not files::printable(): a path may have any bytes, and is named as the system knows it.
    for (char& c : message)
        if ((c >= 0 && c < ' ') || c == '\x7f')
            c = ' ';
    return message;
}

Stopwatch::Stopwatch() : start_(now()), last_(start_) {}

double Stopwatch::lap() {
    const double time = now();
    return time - std::exchange(last_, time);
}

double Stopwatch::total() const {
    return now() - start_;
}

std::uint64_t peak_bytes() {
    struct rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

} // namespace relumine::app
