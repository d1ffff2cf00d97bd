// The script that completes the program's commands, options and values in bash, made from the
// tables of its command line.
#pragma once

#include <string>

#include "app/command_table.h"

namespace relumine::app {

/// Returns it. It needs bash alone, not the package bash-completion.
[[nodiscard]] std::string bash_completion(const CommandTable& program);

} // namespace relumine::app
