// Which processors, with which library of rays, give the same results.
#pragma once

#include <string>

namespace relumine::prt {

/// Returns how this processor computes, and the version of Embree: "AVX2, Embree 4". AVX2 stands
/// for all x86 processors from AVX2 on, which round products and sums in one step; others name
/// their best instruction set. Where the text is the same, so are the results (docs/robustness.md).
[[nodiscard]] std::string arithmetic();

} // namespace relumine::prt
