// As parallel_for.h beside it.
#pragma once

#include_next <tbb/parallel_invoke.h>

#include <tbb/parallel_for.h>

namespace tbb {

template<class First, class Second>
void marked_parallel_invoke(const First& first, const Second& second) {
    const auto either = [&](bool is_second) {
        if (is_second)
            second();
        else
            first();
    };
    relumine::tsan::mark(either, [&](const auto& marked) {
        parallel_invoke([marked] { marked(false); }, [marked] { marked(true); });
    });
}

} // namespace tbb

#define parallel_invoke marked_parallel_invoke
