#include <optional>
#include <string>

#include "app/command_line/command_line.h"
#include "app/command_line/printed.h"
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
        app::print(program.run({argv + 1, argv + argc}));
    };
    return app::exit_code_of(program, run,
                             [&](const std::string& message) { session.complain(message); });
}
