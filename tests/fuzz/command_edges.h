// The command line at the edges of numbers, all of them: tests/fuzz/command_line.cpp draws some.
#pragma once

#include <cstddef>

namespace relumine::fuzz {

/// Runs every working command with each of its options at every edge. Returns how many lines that
/// were.
std::size_t run_all_edges();

} // namespace relumine::fuzz
