// Times, and the middle of several: one slow run does not move it.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <vector>

namespace relumine::bench {

/// Of an even number the upper of the two in the middle. `values` must not be empty.
inline double median(std::vector<double> values) {
    std::nth_element(values.begin(),
                     values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

/// A clock on the wall that runs from where it was made.
class Stopwatch {
public:
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(Clock::now() - start_).count();
    }
    void restart() { start_ = Clock::now(); }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

/// Of one run, on the wall.
template<class Work>
double seconds_of(const Work& work) {
    const Stopwatch watch;
    work();
    return watch.seconds();
}

/// Of one run, on all processors together: other programs change it less.
template<class Work>
double processor_seconds_of(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// The median of 21 runs, after one that is not counted.
template<class Work>
double median_seconds(const Work& work) {
    constexpr int NumRuns = 21;
    work();
    std::vector<double> seconds;
    for (int i = 0; i < NumRuns; ++i)
        seconds.push_back(seconds_of(work));
    return median(seconds);
}

} // namespace relumine::bench
