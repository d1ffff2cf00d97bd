#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "app/program.h"
#include "prt/precompute.h"

namespace {

/// One line of plain text, whatever the library's message looked like: what a file holds may be
/// quoted in it.
std::string one_line(std::string message) {
    while (!message.empty() && (message.back() == '\n' || message.back() == ' '))
        message.pop_back();
    for (char& c : message)
        if ((c >= 0 && c < ' ') || c == '\x7f')
            c = ' ';
    return message;
}

} // namespace

int main(int argc, char** argv) {
    using namespace relumine;
    app::Session session;
    CLI::App program{
        "Relights meshes under measured environment light. Exit code 0: done, 1: the work "
        "failed, 2: wrong usage.",
        "relumine"};
    program.set_version_flag("--version", "relumine " RELUMINE_VERSION);
    app::add_commands(program, session);

    // The subcommand runs after parsing, so that wrong usage and failed work cannot be confused.
    std::unique_ptr<tbb::global_control> thread_limit;
    program.parse_complete_callback([&] {
        if (session.num_threads > 0)
            thread_limit = std::make_unique<tbb::global_control>(
                tbb::global_control::max_allowed_parallelism, session.num_threads);
    });
    const auto fail = [&](const std::string& message) {
        session.end_progress();
        // Not fmt::print, which throws where stderr cannot be written.
        std::fputs(fmt::format("relumine: {}\n", one_line(message)).c_str(), stderr);
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
                   one_line(no_subcommand
                                ? fmt::format("expected a subcommand, got '{}'", rest.front())
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
