#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include <tbb/global_control.h>

#include "app/command_line/command_line.h"
#include "app/program.h"

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
    const auto run = [&] {
        std::fputs(program.run({argv + 1, argv + argc}).c_str(), stdout);
        // What was printed may still be in the buffer: a full disk behind `> file` shows only here.
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
            throw std::runtime_error("cannot write to standard output");
    };
    return app::exit_code_of(program, run,
                             [&](const std::string& message) { session.complain(message); });
}
