// The program `relumine-mpi`: commands of `relumine` whose work the processes of mpirun or srun
// share.
#include <algorithm>
#include <array>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "app/command_line/command_line.h"
#include "app/command_line/printed.h"
#include "app/commands.h"
#include "app/program.h"
#include "app/session.h"
#include "files/joined.h"
#include "files/parallel.h"
#include "mpi/communicator.h"
#include "mpi/greeting.h"
#include "mpi/processors.h"
#include "relumine/version.h"

namespace relumine::mpi {

namespace {

constexpr std::array<const char*, 4> Commands = {"precompute", "relight", "animate", "verify"};

/// Returns what to say of processors that nobody uses, after all processes have said that they are
/// of one program and one call.
std::string meet(const std::vector<std::string>& arguments, Communicator& team) {
    const Greeting own = greeting(arguments);
    const std::string differs = difference(unpacked(team.broadcast(packed(own))), own);
    if (!differs.empty())
        throw std::runtime_error(differs);
    team.meet();
    std::vector<Processors> all;
    for (const std::vector<std::byte>& bytes : team.gather(packed(processors())))
        all.push_back(unpacked_processors(bytes));
    return idle_processors(all);
}

/// Returns what says whether the first process is known to be alive. Only processes of its host
/// can know.
std::function<bool()> watch_over_first(Communicator& team) {
    const std::string own = fmt::format("{}\n{}", processors().host, ::getpid());
    const auto bytes = std::as_bytes(std::span(own));
    std::string first;
    for (const std::byte byte : team.broadcast({bytes.begin(), bytes.end()}))
        first += static_cast<char>(byte);
    const std::size_t end = first.find('\n');
    if (team.part().index == 0 || first.substr(0, end) != own.substr(0, own.find('\n')))
        return {};
    return [pid = static_cast<::pid_t>(std::stol(first.substr(end)))] {
        return ::kill(pid, 0) == 0;
    };
}

/// What starters of processes tell before MPI does.
bool is_started_as_other() {
    for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"})
        if (const char* rank = std::getenv(name))
            return std::string_view(rank) != "0";
    return false;
}

/// Throws for a command that `relumine` has and this program does not.
void require_command(const std::vector<std::string>& arguments) {
    if (!arguments.empty() && !arguments[0].empty() && arguments[0][0] != '-' &&
        std::find(Commands.begin(), Commands.end(), arguments[0]) == Commands.end())
        throw app::UsageError(arguments[0],
                              fmt::format("expected {}: the other commands are those of "
                                          "`relumine`, without mpirun",
                                          files::joined(Commands, ", ")));
}

/// Does the work and returns the exit code. Of processes that fail for the same reason one
/// complains.
int code_of(const app::CommandLine& program, Communicator& team, const std::function<void()>& work,
            const std::function<void(const std::string&)>& complain) {
    bool has_other_failed = false;
    const int code = app::exit_code_of(
        program,
        [&] {
            try {
                work();
            } catch (const OtherFailed&) {
                has_other_failed = true;
            }
        },
        [&](const std::string& message) {
            if (team.fail())
                complain(message);
        });
    return has_other_failed ? 1 : code;
}

int run(const std::vector<std::string>& arguments, app::Session& session, Communicator& team) {
    const bool is_first = team.part().index == 0;
    const auto complain = [&](const std::string& message) {
        session.complain(fmt::format("{}{}",
                                     is_first ? "" : fmt::format("process {}: ", team.part().index),
                                     message),
                         "relumine-mpi");
        // The starter ends those that are left when the first one of them has ended.
        app::leave_last_words_to_others();
    };
    if (!is_first)
        app::leave_last_words_to_others();
    app::CommandLine program("relumine-mpi",
                             "Shares the work of one command out to the processes that mpirun or "
                             "srun starts. `relumine` has the other commands. Exit code 0: done, "
                             "1: the work failed, 2: wrong usage.",
                             relumine::long_version);
    double timeout = 3600.0;
    app::Command root = program.root();
    app::add_precompute(root, session);
    app::add_relight(root, session);
    app::add_animate(root, session);
    app::add_verify(root, session);
    for (const char* name : Commands)
        root.command(name).add(
            row("--timeout", timeout,
                "end all processes when one has not answered for so many seconds; 0: wait",
                {.min = 0, .max = 1e9, .shapes_frames = false}));

    // Said unless a number of threads, or the share of a job, shows that it is meant.
    std::string idle;
    std::optional<files::ThreadLimit> thread_limit;
    program.before_run([&] {
        if (session.num_threads > 0)
            thread_limit.emplace(session.num_threads);
        else if (is_first && !idle.empty() && std::getenv("SLURM_CPUS_PER_TASK") == nullptr)
            session.warn(idle);
        // The first process speaks for all.
        session.quiet = session.quiet || !is_first;
        session.json = session.json && is_first;
        session.team = &team;
        team.set_timeout(timeout, complain);
    });
    const auto work = [&] {
        idle = meet(arguments, team);
        session.is_first_alive = watch_over_first(team);
        require_command(arguments);
        const std::string text = program.run(arguments);
        if (is_first)
            app::print(text);
        team.meet();
    };
    return code_of(program, team, work, complain);
}

} // namespace

} // namespace relumine::mpi

int main(int argc, char** argv) {
    if (relumine::mpi::is_started_as_other())
        relumine::app::leave_last_words_to_others();
    // Before MPI starts threads, which must leave signals to the session.
    relumine::app::Session session;
    relumine::mpi::Communicator team;
    return relumine::mpi::run({argv + 1, argv + argc}, session, team);
}
