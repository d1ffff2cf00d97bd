// The program's command line: all subcommands and what is asked of each of their options.
#pragma once

#include <CLI/CLI.hpp>

#include "app/session.h"

namespace relumine::app {

/// Adds the subcommands, whose work runs when the line is parsed, and refuses empty values. The
/// session must outlive the program.
void add_commands(CLI::App& program, Session& session);

} // namespace relumine::app
