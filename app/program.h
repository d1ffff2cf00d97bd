// The program's command line: all subcommands.
#pragma once

#include "app/command_line/command_line.h"
#include "app/session.h"

namespace relumine::app {

/// Adds the subcommands, whose work runs when the line is read. The session must outlive the
/// program.
void add_commands(CommandLine& program, Session& session);

} // namespace relumine::app
