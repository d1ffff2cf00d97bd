#include "prt/arithmetic.h"

#include <cstdint>

#include <fmt/format.h>
#include <hwy/targets.h>

namespace relumine::prt {

std::string arithmetic() {
    // The lowest bit is the best target.
    const auto targets = static_cast<std::int64_t>(hwy::SupportedTargets());
    const std::int64_t best = targets & -targets;
#if HWY_ARCH_X86
    if (best <= HWY_AVX2)
        return fmt::format("AVX2, Embree {}", RELUMINE_EMBREE);
#endif
    return fmt::format("{}, Embree {}", hwy::TargetName(best), RELUMINE_EMBREE);
}

} // namespace relumine::prt
