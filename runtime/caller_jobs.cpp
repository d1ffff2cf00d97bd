// In the runtime this stands in the place of files/parallel.cpp, which runs loops by oneTBB.
#include "runtime/caller_jobs.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <utility>

#include "files/parallel.h"

namespace relumine::runtime {

namespace {

/// Null: loops run on this thread.
thread_local const CallerJobs* jobs_of_thread = nullptr;

} // namespace

WithJobs::WithJobs(const CallerJobs& jobs) {
    jobs_of_thread = jobs.run != nullptr && jobs.num_threads > 1 ? &jobs : nullptr;
}

WithJobs::~WithJobs() {
    jobs_of_thread = nullptr;
}

namespace {

/// A loop that is taken in pieces. No exception goes through the caller's function.
struct Loop {
    std::size_t size, num_pieces;
    files::detail::LoopBody call;
    const void* body;
    std::atomic<bool> has_failed = false;
    std::exception_ptr failure = nullptr;

    void run(std::size_t piece) noexcept {
        const CallerJobs* before = std::exchange(jobs_of_thread, nullptr);
        try {
            if (!has_failed.load(std::memory_order_relaxed))
                call(body, size * piece / num_pieces, size * (piece + 1) / num_pieces);
        } catch (...) {
            if (!has_failed.exchange(true))
                failure = std::current_exception();
        }
        jobs_of_thread = before;
    }
};

} // namespace

} // namespace relumine::runtime

namespace relumine::files {

using runtime::jobs_of_thread;

std::size_t num_threads() {
    return jobs_of_thread == nullptr ? 1 : jobs_of_thread->num_threads;
}

struct ThreadLimit::Control {};
ThreadLimit::ThreadLimit(std::size_t) {}
ThreadLimit::~ThreadLimit() = default;

void run_isolated(const std::function<void()>& work) {
    work();
}

void detail::run_loop(std::size_t size, std::size_t grain, LoopBody call, const void* body) {
    // Some pieces a thread, so that they end at the same time; each has a grain at least.
    constexpr std::size_t PiecesPerThread = 8;
    const std::size_t num_pieces =
        std::min(size / std::max<std::size_t>(grain, 1), num_threads() * PiecesPerThread);
    if (num_pieces <= 1 || jobs_of_thread == nullptr) {
        call(body, 0, size);
        return;
    }
    runtime::Loop loop{.size = size, .num_pieces = num_pieces, .call = call, .body = body};
    jobs_of_thread->run(
        jobs_of_thread->user, num_pieces,
        [](void* of, std::size_t i) { static_cast<runtime::Loop*>(of)->run(i); }, &loop);
    if (loop.failure)
        std::rethrow_exception(loop.failure);
}

} // namespace relumine::files
