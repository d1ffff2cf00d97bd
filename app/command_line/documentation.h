// Commands that explain the command line itself.
#pragma once

#include "app/command_line/command_line.h"

namespace relumine::app {

/// `relumine completion SHELL`. The program must outlive its command's work.
void add_completion(CommandLine& program);
/// `relumine man PAGE`, likewise. To be called last: it knows the commands that are there.
void add_man(CommandLine& program);
/// `relumine help [COMMAND]`, likewise.
void add_help(CommandLine& program);

} // namespace relumine::app
