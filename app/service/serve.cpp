#include <csignal>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/service/line_server.h"
#include "app/service/service.h"
#include "prt/precompute.h"

namespace relumine::app {

namespace {

void run(const std::string& place, Session& session) {
    // A reader that has gone is told by the call that writes.
    std::signal(SIGPIPE, SIG_IGN);
    // The socket is removed and the exit code is 0, even if a long request ends first. Never given
    // back, since the process ends soon after.
    [[maybe_unused]] static const auto& patience = *new Patience;
    Service service(session);
    const LineService lines{.answer = [&](std::string_view line) { return service.answer(line); },
                            .refuse = Service::refusal};
    std::unique_ptr<LineSocket> socket;
    if (place != "-")
        socket = std::make_unique<LineSocket>(place);
    if (socket)
        session.say(fmt::format("{}: serving; Ctrl-C ends", place));
    session.json = true; // stdout has answers and nothing else
    try {
        if (socket)
            socket->serve(lines, session.stop());
        else
            serve_standard_streams(lines, session.stop());
    } catch (const prt::Cancelled&) {
        // Being asked to stop is how a server ends.
    }
}

} // namespace

void add_serve(Command& program, Session& session) {
    Command command = program.add_command(
        "serve", "keep a scene loaded and answer requests: JSON lines in, JSON lines out");
    auto place = std::make_shared<std::string>();
    command.add(row("SOCKET", *place,
                    "Unix socket to make, which only its owner may open; - for stdin and stdout",
                    {.file = true, .required = true}));
    session.add_common_options(command);
    command.footer("\n\nA request is one line: {\"do\": \"scene\", \"scene\": \"bunny.prt\"}. "
                   "{\"do\": \"help\"} lists all requests; docs/serve.md has an example.\n");
    command.on_run([place, &session] { run(*place, session); });
}

} // namespace relumine::app
