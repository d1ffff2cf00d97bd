// Makes the next value while the caller works on the present one.
#pragma once

#include <cstddef>
#include <functional>
#include <future>
#include <utility>

namespace relumine::cubemap {

/// Values 0, 1, ... of a list, each made by a slow function. While the caller works on one value, a
/// thread makes the next, so two values exist at a time.
///
/// Threads: only one thread at a time may call get().
template<typename T>
class ReadAhead {
public:
    /// `make(index)` may run on another thread, but never twice at once.
    ReadAhead(std::size_t size, std::function<T(std::size_t)> make)
        : size_(size), make_(std::move(make)) {}

    /// Returns the value of an index below the size. In ascending order most values are already
    /// made; any other order works too.
    /// Throws:  what make() throws.
    [[nodiscard]] T get(std::size_t index) {
        std::future<T> next = std::exchange(next_, {});
        const bool is_here = next.valid() && next_index_ == index;
        if (next.valid() && !is_here)
            next.wait(); // nobody asked for its value or its exception
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
    /// The last member: its destructor waits for the thread, which uses the other members.
    std::future<T> next_;
};

} // namespace relumine::cubemap
