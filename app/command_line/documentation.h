// Commands that explain the command line itself.
#pragma once

#include "app/command_line/command_line.h"

namespace relumine::app {

/// `relumine completion`. The program must outlive its command's work.
void add_completion(CommandLine& program);
/// `relumine help [COMMAND]`, likewise.
void add_help(CommandLine& program);

} // namespace relumine::app
