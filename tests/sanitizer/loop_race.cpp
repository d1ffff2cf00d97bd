// What the thread sanitizer must see through TBB (cmake/tsan): with an argument there is a race
// between the parts of a loop, without one there is none.
#include <cstddef>
#include <cstdio>
#include <numeric>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

int main(int argc, char**) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 4);
    constexpr std::size_t Size = 100000;
    const std::vector<int> ones(Size, 1);
    std::vector<int> counts(Size);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, Size, 10), [&](const auto& some) {
        for (std::size_t i = some.begin(); i < some.end(); ++i)
            counts[i] = ones[i];
    });
    tbb::parallel_for(std::size_t{0}, Size, [&](std::size_t i) { counts[i] += ones[i]; });
    const auto add = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            counts[i] += ones[i];
    };
    tbb::parallel_invoke([&] { add(0, Size / 2); }, [&] { add(Size / 2, Size); });
    int sum = std::accumulate(counts.begin(), counts.end(), 0);
    if (argc > 1)
        tbb::parallel_for(std::size_t{0}, Size, [&](std::size_t i) { sum += counts[i]; });
    std::printf("%d\n", sum);
}
