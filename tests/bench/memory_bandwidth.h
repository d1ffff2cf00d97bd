// What streaming from memory can reach on this machine, measured in the run that it is compared
// with.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <tbb/parallel_for.h>

#include "tests/bench/median.h"

namespace relumine::bench {

/// Bytes per second that all threads read together from memory, from 1 GiB: four times the largest
/// cache known.
inline double memory_bandwidth() {
    constexpr std::size_t NumWords = std::size_t{1} << 27;
    constexpr std::size_t NumParts = 64;
    const std::vector<std::uint64_t> words(NumWords, 1);
    std::atomic<std::uint64_t> total = 0;
    const double seconds = median_seconds([&] {
        tbb::parallel_for(std::size_t{0}, NumParts, [&](std::size_t part) {
            const std::uint64_t* word = words.data() + part * (NumWords / NumParts);
            std::uint64_t sum = 0;
            for (std::size_t i = 0; i < NumWords / NumParts; ++i)
                sum += word[i];
            total += sum;
        });
    });
    if (total == 0) // so that the sums are not optimised away
        throw std::logic_error("sum of ones is zero");
    return static_cast<double>(NumWords * sizeof(std::uint64_t)) / seconds;
}

} // namespace relumine::bench
