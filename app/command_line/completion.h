// Shell scripts that complete the program's commands, options and values; made from the tables of
// its command line.
#pragma once

#include <string>

#include "app/command_table.h"

namespace relumine::app {

/// For bash, without the package bash-completion.
[[nodiscard]] std::string bash_completion(const CommandTable& program);
/// For zsh: a file _relumine of its function path.
[[nodiscard]] std::string zsh_completion(const CommandTable& program);
[[nodiscard]] std::string fish_completion(const CommandTable& program);

} // namespace relumine::app
