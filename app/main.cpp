#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>

#include "app/command_line/command_line.h"
#include "app/program.h"
#include "files/parallel.h"
#include "relumine/version.h"

int main(int argc, char** argv) {
    using namespace relumine;
    app::Session session;
    app::CommandLine program("relumine",
                             "Relights meshes under measured environment light. Exit code 0: done, "
                             "1: the work failed, 2: wrong usage.",
                             long_version);
    app::add_commands(program, session);

    std::optional<files::ThreadLimit> thread_limit;
    program.before_run([&] {
        if (session.num_threads > 0)
            thread_limit.emplace(session.num_threads);
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
