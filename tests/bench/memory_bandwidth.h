// What streaming from memory can reach on this machine, measured in the run that it is compared
// with.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "files/parallel.h"
#include "tests/bench/times.h"

namespace relumine::bench {

/// Bytes per second that all threads read together from memory, from 1 GiB: four times the largest
/// cache known. Tiny: from 1 MiB, which says nothing of memory.
inline double memory_bandwidth(bool tiny = false) {
    const std::size_t num_words = std::size_t{1} << (tiny ? 17 : 27);
    constexpr std::size_t NumParts = 64;
    const std::vector<std::uint64_t> words(num_words, 1);
    std::atomic<std::uint64_t> total = 0;
    const double seconds = median_seconds([&] {
        files::parallel_for(std::size_t{0}, NumParts, [&](std::size_t part) {
            const std::uint64_t* word = words.data() + part * (num_words / NumParts);
            std::uint64_t sum = 0;
            for (std::size_t i = 0; i < num_words / NumParts; ++i)
                sum += word[i];
            total += sum;
        });
    });
    if (total == 0) // so that the sums are not optimised away
        throw std::logic_error("sum of ones is zero");
    return static_cast<double>(num_words * sizeof(std::uint64_t)) / seconds;
}

} // namespace relumine::bench
