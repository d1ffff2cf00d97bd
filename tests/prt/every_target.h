// Runs a test once per instruction set that this processor has; the test may ask for the set.
#pragma once

#include <cstdint>
#include <type_traits>

#include <gtest/gtest.h>
#include <hwy/highway.h>

namespace relumine::scenes {

template<typename Test>
void on_every_target(const Test& test) {
    const std::int64_t supported = hwy::SupportedTargets() & HWY_TARGETS;
    for (std::int64_t rest = supported; rest != 0; rest &= rest - 1) {
        const std::int64_t target = rest & -rest;
        SCOPED_TRACE(hwy::TargetName(target));
        hwy::GetChosenTarget().Update(target);
        if constexpr (std::is_invocable_v<Test, std::int64_t>)
            test(target);
        else
            test();
    }
    hwy::GetChosenTarget().Update(supported);
}

} // namespace relumine::scenes
