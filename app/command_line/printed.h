// What commands print.
#pragma once

#include <string>

namespace relumine::app {

/// Writes to standard output. Once its reader is gone, as behind `| head -1`, nothing more is
/// printed, and the command goes on with what else it does. SIGPIPE must be ignored.
///
/// Throws:  std::runtime_error where it cannot be written: a full disk behind `> file`.
void print(const std::string& text);

} // namespace relumine::app
