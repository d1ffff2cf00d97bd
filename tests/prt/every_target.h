// Runs a test once per instruction set that this processor has.
#pragma once

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
        test();
    }
    hwy::GetChosenTarget().Update(supported);
}

} // namespace relumine::scenes
