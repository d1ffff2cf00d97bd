#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "app/command_line/command_line.h"
#include "app/program.h"
#include "prt/precompute.h"

int main(int argc, char** argv) {
    using namespace relumine;
    app::Session session;
    app::CommandLine program("relumine",
                             "Relights meshes under measured environment light. Exit code 0: done, "
                             "1: the work failed, 2: wrong usage.",
                             RELUMINE_VERSION);
    app::add_commands(program, session);

    std::unique_ptr<tbb::global_control> thread_limit;
    program.before_run([&] {
        if (session.num_threads > 0)
            thread_limit = std::make_unique<tbb::global_control>(
                tbb::global_control::max_allowed_parallelism, session.num_threads);
    });
    const auto fail = [&](const std::string& message) {
        session.complain(message);
        return 1;
    };
    // What was printed may still be in the buffer: a full disk behind `> file` shows only here.
    const auto done = [&] {
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
            return fail("cannot write to standard output");
        return 0;
    };
    try {
        std::fputs(program.run({argv + 1, argv + argc}).c_str(), stdout);
        return done();
    } catch (const app::UsageError& error) {
        std::fputs(fmt::format("relumine: {} (see {} --help)\n", app::one_line(error.what()),
                               program.command_name())
                       .c_str(),
                   stderr);
        return 2;
    } catch (const prt::Cancelled&) {
        return fail("cancelled; nothing was written");
    } catch (const std::bad_alloc&) {
        return fail("out of memory");
    } catch (const std::exception& error) {
        return fail(error.what());
    }
}
