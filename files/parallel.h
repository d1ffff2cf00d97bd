// Loops whose rounds may run at the same time, on the threads of oneTBB.
//
// The body of a loop is called through a pointer, once for each piece of the loop, so that TBB's
// templates are compiled once and not with each body.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace relumine::files {

/// Returns how many threads loops run on at most, the caller's among them.
[[nodiscard]] std::size_t num_threads();

/// While it lives, loops run on at most so many threads; 0: on as many as without it.
class ThreadLimit {
public:
    explicit ThreadLimit(std::size_t num_threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    struct Control;
    std::unique_ptr<Control> control_;
};

/// Runs `work`, whose loops may use other threads. While the caller waits for them, it takes up no
/// other loop's work: such work could ask for a lock that the caller holds.
void run_isolated(const std::function<void()>& work);

/// Makes bytes for the numbers [0, count) at the same time, and gives them to `take` one by one, in
/// their order, while others are made. Throws what either throws first.
void make_in_order(std::size_t count,
                   const std::function<std::vector<std::byte>(std::size_t)>& make,
                   const std::function<void(std::span<const std::byte>)>& take);

/// The numbers [begin(), end()), or a piece of them. Pieces hold no fewer numbers than half of
/// `grain`.
template<typename Index>
class IndexRange {
public:
    IndexRange(Index begin, Index end, std::size_t grain = 1)
        : begin_(begin), end_(end), grain_(grain) {}

    [[nodiscard]] Index begin() const { return begin_; }
    [[nodiscard]] Index end() const { return end_; }
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
    [[nodiscard]] std::size_t grain() const { return grain_; }

private:
    Index begin_, end_;
    std::size_t grain_;
};

namespace detail {

using LoopBody = void (*)(const void* body, std::size_t begin, std::size_t end);
/// Calls `call(body, begin, end)` for pieces of [0, size).
void run_loop(std::size_t size, std::size_t grain, LoopBody call, const void* body);

} // namespace detail

/// Calls `body(IndexRange)` for pieces that make up `range`, at the same time and in any order.
///
/// Throws:  what a body throws first; pieces that have not begun are then left out.
template<typename Index, typename Body>
void parallel_for(const IndexRange<Index>& range, const Body& body) {
    if (range.begin() >= range.end())
        return;
    struct Loop {
        const Body& body;
        Index begin;
    };
    const Loop loop{body, range.begin()};
    detail::run_loop(
        range.size(), range.grain(),
        [](const void* of, std::size_t begin, std::size_t end) {
            const Loop& here = *static_cast<const Loop*>(of);
            here.body(IndexRange<Index>(static_cast<Index>(here.begin + static_cast<Index>(begin)),
                                        static_cast<Index>(here.begin + static_cast<Index>(end))));
        },
        &loop);
}

/// Calls `body(i)` for the numbers [first, last), at the same time and in any order. Throws as
/// above.
template<typename Index, typename Body>
void parallel_for(Index first, Index last, const Body& body) {
    parallel_for(IndexRange<Index>(first, last), [&body](const IndexRange<Index>& range) {
        for (Index i = range.begin(); i != range.end(); ++i)
            body(i);
    });
}

} // namespace relumine::files
