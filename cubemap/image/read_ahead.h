// Loading the next one while the present one is worked on.
#pragma once

#include <cstddef>
#include <functional>
#include <future>
#include <utility>

namespace relumine::cubemap {

/// Values 0, 1, ... of a list, each made by a function that takes its time. While the caller works
/// on one, the next is made by a thread of its own; so two exist at a time. One thread at a time
/// may call get().
template<typename T>
class ReadAhead {
public:
    /// `make(index)` may run on another thread, though never twice at once.
    ReadAhead(std::size_t size, std::function<T(std::size_t)> make)
        : size_(size), make_(std::move(make)) {}

    /// The value of an index below the size; throws what make() throws. In ascending order it was
    /// mostly made already; any other order works, too.
    [[nodiscard]] T get(std::size_t index) {
        std::future<T> next = std::exchange(next_, {});
        const bool is_here = next.valid() && next_index_ == index;
        if (next.valid() && !is_here)
            next.wait(); // what it made, or threw, was not asked for
        T value = is_here ? next.get() : make_(index);
        if (index + 1 < size_) {
            next_index_ = index + 1;
            next_ = std::async(std::launch::async, [this, index] { return make_(index + 1); });
        }
        return value;
    }

private:
    std::size_t size_;
    std::function<T(std::size_t)> make_;
    std::size_t next_index_ = 0;
    /// Last: its destructor waits for the thread, which uses the others
    std::future<T> next_;
};

} // namespace relumine::cubemap
