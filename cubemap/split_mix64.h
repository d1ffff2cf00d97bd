// Random numbers that are the same on every system.
// Based on: G. L. Steele, D. Lea, C. H. Flood, "Fast Splittable Pseudorandom Number Generators",
// 2014.
#pragma once

#include <cstddef>
#include <cstdint>

namespace relumine::cubemap {

/// A stream of 64-bit numbers: a counter whose values are mixed.
class SplitMix64 {
public:
    /// The counter's step, 2^64 over the golden ratio. Two seeds that differ by the step start the
    /// same stream, one number apart.
    static constexpr std::uint64_t Step = 0x9e3779b97f4a7c15u;

    explicit SplitMix64(std::uint64_t seed) : counter_(seed) {}

    [[nodiscard]] std::uint64_t next() {
        std::uint64_t z = (counter_ += Step);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }

    /// Returns a number in [0, n) for n > 0. Small numbers are more likely by at most n in 2^64.
    [[nodiscard]] std::size_t below(std::size_t n) { return next() % n; }

private:
    std::uint64_t counter_;
};

/// Returns a number in [0, 1) from the upper bits.
[[nodiscard]] constexpr double unit_interval(std::uint64_t bits) {
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

} // namespace relumine::cubemap
