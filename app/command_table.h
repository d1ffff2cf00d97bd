// Commands and options as plain data: what completion and the tests of docs are made from.
#pragma once

#include <string>
#include <vector>

#include "relumine/options/option_table.h"

namespace relumine::app {

/// One command, with the commands below it.
struct CommandTable {
    std::string name = {};
    std::string description = {};
    /// In their order, --help included
    OptionTable options = {};
    std::vector<CommandTable> commands = {};
};

} // namespace relumine::app
