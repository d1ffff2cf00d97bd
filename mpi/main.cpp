// The program `relumine-mpi`: commands of `relumine` whose work the processes of mpirun or srun
// share.
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "app/command_line/command_line.h"
#include "app/commands.h"
#include "app/session.h"
#include "mpi/communicator.h"
#include "mpi/greeting.h"
#include "prt/precompute.h"

namespace relumine::mpi {

namespace {

int run(const std::vector<std::string>& arguments, app::Session& session, Communicator& team) {
    const bool is_first = team.part().index == 0;
    const auto complain = [&](const std::string& message) {
        std::fputs(fmt::format("relumine-mpi: {}{}\n",
                               is_first ? "" : fmt::format("process {}: ", team.part().index),
                               app::one_line(message))
                       .c_str(),
                   stderr);
    };
    const auto fail = [&](const std::string& message) {
        if (team.fail())
            complain(message);
        return 1;
    };
    app::CommandLine program("relumine-mpi",
                             "Shares the work of one command out to the processes that mpirun or "
                             "srun starts. `relumine` has the other commands. Exit code 0: done, "
                             "1: the work failed, 2: wrong usage.",
                             RELUMINE_VERSION);
    double timeout = 3600.0;
    app::Command root = program.root();
    app::add_precompute(root, session);
    app::add_relight(root, session);
    for (const char* name : {"precompute", "relight"})
        root.command(name)
            .add_option("--timeout", timeout,
                        "end all processes when one has not answered for so many seconds; 0: wait")
            .between(0.0, 1e9)
            .show_default();

    std::unique_ptr<tbb::global_control> thread_limit;
    program.before_run([&] {
        if (session.num_threads > 0)
            thread_limit = std::make_unique<tbb::global_control>(
                tbb::global_control::max_allowed_parallelism, session.num_threads);
        // The first process speaks for all.
        session.quiet = session.quiet || !is_first;
        session.json = session.json && is_first;
        session.team = &team;
        team.set_timeout(timeout, complain);
    });
    try {
        const Greeting own = greeting(arguments);
        const std::string differs = difference(unpacked(team.broadcast(packed(own))), own);
        if (!differs.empty())
            throw std::runtime_error(differs);
        team.meet();
        if (!arguments.empty() && !arguments[0].empty() && arguments[0][0] != '-' &&
            arguments[0] != "precompute" && arguments[0] != "relight")
            throw app::UsageError(arguments[0],
                                  "expected precompute or relight: the other commands are those "
                                  "of `relumine`, without mpirun");
        const std::string text = program.run(arguments);
        if (is_first)
            std::fputs(text.c_str(), stdout);
        team.meet();
        return 0;
    } catch (const OtherFailed&) {
        return 1;
    } catch (const app::UsageError& error) {
        if (team.fail())
            complain(fmt::format("{} (see {} --help)", error.what(), program.command_name()));
        return 2;
    } catch (const prt::Cancelled&) {
        return fail("cancelled; nothing was written");
    } catch (const std::bad_alloc&) {
        return fail("out of memory");
    } catch (const std::exception& error) {
        return fail(error.what());
    }
}

} // namespace

} // namespace relumine::mpi

int main(int argc, char** argv) {
    // Before MPI starts threads, which must leave signals to the session.
    relumine::app::Session session;
    relumine::mpi::Communicator team;
    return relumine::mpi::run({argv + 1, argv + argc}, session, team);
}
