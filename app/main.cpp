#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "app/commands.h"
#include "prt/precompute.h"

namespace {

/// One line, whatever the library's message looked like.
std::string one_line(std::string message) {
    while (!message.empty() && (message.back() == '\n' || message.back() == ' '))
        message.pop_back();
    for (char& c : message)
        if (c == '\n' || c == '\r')
            c = ' ';
    return message;
}

} // namespace

int main(int argc, char** argv) {
    using namespace relumine;
    app::Session session;
    CLI::App program{"Relights meshes under measured environment light. Exit code 0: done, 1: the work "
                     "failed, 2: wrong usage.",
                     "relumine"};
    program.set_version_flag("--version", "relumine " RELUMINE_VERSION);
    program.require_subcommand(1);
    app::add_precompute(program, session);
    app::add_relight(program, session);
    app::add_animate(program, session);
    app::add_edit(program, session);
    app::add_verify(program, session);
    app::add_lights(program, session);
    app::add_info(program, session);
    app::add_generate(program, session);
    app::add_env(program, session);
    app::add_view(program, session);

    // A script's unset variable must not read as 0 or as the current folder.
    const CLI::Validator not_empty(
        [](const std::string& text) {
            return text.empty() ? std::string("expected a value, got ''") : std::string();
        },
        "");
    const std::function<void(CLI::App&)> refuse_empty = [&](CLI::App& app) {
        for (CLI::App* command : app.get_subcommands({})) {
            for (CLI::Option* option : command->get_options())
                if (option->get_expected_min() > 0)
                    option->check(not_empty);
            refuse_empty(*command);
        }
    };
    refuse_empty(program);

    // The subcommand runs after parsing, so that wrong usage and failed work cannot be confused.
    std::unique_ptr<tbb::global_control> thread_limit;
    program.parse_complete_callback([&] {
        if (session.num_threads > 0)
            thread_limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                                 session.num_threads);
    });
    const auto fail = [&](const std::string& message) {
        session.end_progress();
        fmt::print(stderr, "relumine: {}\n", one_line(message));
        return 1;
    };
    // What was printed may still be in the buffer: a full disk behind `> file` shows only here.
    const auto done = [&] {
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
            return fail("cannot write to standard output");
        return 0;
    };
    try {
        program.parse(argc, argv);
        return done();
    } catch (const CLI::Success& success) { // --help, --version
        program.exit(success);
        return done();
    } catch (const CLI::ParseError& error) {
        const std::vector<std::string> rest = program.remaining();
        const bool no_subcommand = program.get_subcommands().empty() && !rest.empty();
        fmt::print(stderr, "relumine: {} (see relumine --help)\n",
                   one_line(no_subcommand ? fmt::format("expected a subcommand, got '{}'", rest.front())
                                          : error.what()));
        return 2;
    } catch (const prt::Cancelled&) {
        return fail("cancelled; nothing was written");
    } catch (const std::bad_alloc&) {
        return fail("out of memory");
    } catch (const std::exception& error) {
        return fail(error.what());
    }
}
