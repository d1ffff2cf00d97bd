// Pages of the manual in roff, made from the tables of the command line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/command_table.h"

namespace relumine::app {

/// One page: its name without the section, "relumine-precompute", and its text.
struct ManPage {
    std::string name = {};
    std::string text = {};
};

/// The program's page, then a page for each of its commands and the commands below these.
/// `version` stands at the foot of every page.
[[nodiscard]] std::vector<ManPage> man_pages(const CommandTable& program, std::string_view version);

} // namespace relumine::app
