// The command line at the edges of numbers, all of them: tests/fuzz/command_line.cpp draws some.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace relumine::fuzz {

/// Names of commands that work, all different.
[[nodiscard]] std::vector<std::string> working_commands();

/// Runs a working command with each of its options at every edge. Returns how many lines that were.
std::size_t run_all_edges(std::size_t command);

} // namespace relumine::fuzz
