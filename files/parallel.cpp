#include "files/parallel.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <utility>

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

void make_in_order(std::size_t count,
                   const std::function<std::vector<std::byte>(std::size_t)>& make,
                   const std::function<void(std::span<const std::byte>)>& take) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::map<std::size_t, std::vector<std::byte>> made;
    std::size_t num_taken = 0;
    bool is_taking = false;
    const auto make_and_take = [&](std::size_t i) {
        std::vector<std::byte> bytes = make(i);
        std::unique_lock lock(mutex);
        made.emplace(i, std::move(bytes));
        if (is_taking)
            return; // who takes looks again before it ends
        is_taking = true;
        for (auto first = made.extract(num_taken); first; first = made.extract(num_taken)) {
            ++num_taken;
            lock.unlock();
            take(first.mapped());
            lock.lock();
        }
        is_taking = false;
    };
    // Each thread goes on with the least number that is left, so that few wait for those before.
    tbb::parallel_for(std::size_t{0}, num_threads(), [&](std::size_t) {
        try {
            for (std::size_t i = next++; i < count; i = next++)
                make_and_take(i);
        } catch (...) {
            next = count;
            throw;
        }
    });
}

void detail::run_loop(std::size_t size, std::size_t grain, LoopBody call, const void* body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size, grain),
                      [=](const tbb::blocked_range<std::size_t>& range) {
                          call(body, range.begin(), range.end());
                      });
}

} // namespace relumine::files
