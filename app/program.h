// The program's command line: all subcommands, and what becomes of their errors.
#pragma once

#include <functional>
#include <string>

#include "app/command_line/command_line.h"
#include "app/session.h"

namespace relumine::app {

/// Adds the subcommands, whose work runs when the line is read. The session must outlive the
/// program.
void add_commands(CommandLine& program, Session& session);

/// Runs a command and turns what it throws into an exit code: 0 done, 1 the work failed, 2 wrong
/// usage. `complain` gets the line that says why.
[[nodiscard]] int exit_code_of(const CommandLine& line, const std::function<void()>& work,
                               const std::function<void(const std::string&)>& complain);

} // namespace relumine::app
