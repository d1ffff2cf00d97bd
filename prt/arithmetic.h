// Which processors give the same results.
#pragma once

#include <string>

namespace relumine::prt {

/// Returns a word for how this processor computes: "AVX2" on x86 from AVX2 on, which rounds
/// products and sums in one step, else its best instruction set. Processors with the same word give
/// the same results (docs/robustness.md).
[[nodiscard]] std::string arithmetic();

} // namespace relumine::prt
