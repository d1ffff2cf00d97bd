#include "files/parallel.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace relumine::files {

std::size_t num_threads() {
    return std::min(
        static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()),
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

struct ThreadLimit::Control {
    tbb::global_control control;
};

ThreadLimit::ThreadLimit(std::size_t num_threads)
    : control_(num_threads == 0
                   ? nullptr
                   : new Control{{tbb::global_control::max_allowed_parallelism, num_threads}}) {}

ThreadLimit::~ThreadLimit() = default;

void run_isolated(const std::function<void()>& work) {
    tbb::this_task_arena::isolate(work);
}

void detail::run_loop(std::size_t size, std::size_t grain, LoopBody call, const void* body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size, grain),
                      [=](const tbb::blocked_range<std::size_t>& range) {
                          call(body, range.begin(), range.end());
                      });
}

} // namespace relumine::files
