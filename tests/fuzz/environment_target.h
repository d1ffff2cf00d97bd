// What the formats of environments have in common for fuzzing.
#pragma once

#include "tests/fuzz/fuzz.h"

namespace relumine::fuzz {

/// Reads an environment as the program does, size, picture and all, and resamples it if it is
/// small.
void read_environment(std::span<const std::byte> content);

} // namespace relumine::fuzz
