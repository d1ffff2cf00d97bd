#include "prt/arithmetic.h"

#include <cstdint>

#include <fmt/format.h>
#include <hwy/targets.h>

namespace relumine::prt {

std::string arithmetic() {
    // The lowest bit is the best target.
    const auto targets = static_cast<std::int64_t>(hwy::SupportedTargets());
    const std::int64_t best = targets & -targets;
    const char* name = hwy::TargetName(best);
#if HWY_ARCH_X86
    if (best <= HWY_AVX2)
        name = "AVX2";
#endif
    return fmt::format("{}, Embree {}", name, RELUMINE_EMBREE);
}

} // namespace relumine::prt
