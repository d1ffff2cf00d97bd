#include "relight/bounces/bounce_kernel.h"

#include <cstdint>

namespace relumine::relight {

void sum_lists(const prt::PlaceLists& lists, std::span<const PaddedRgb> values, std::size_t begin,
               std::size_t end, std::span<PaddedRgb> sums) {
    // Several sums at a time, as an addition takes longer than the load that feeds it.
    constexpr std::size_t NumSums = 4;
    for (std::size_t place = begin; place < end; ++place) {
        const std::span<const std::uint32_t> list = lists[place];
        std::array<PaddedRgb, NumSums> parts{};
        std::size_t i = 0;
        for (; i + NumSums <= list.size(); i += NumSums)
            for (std::size_t k = 0; k < NumSums; ++k)
                for (std::size_t c = 0; c < 4; ++c)
                    parts[k].rgb[c] += values[list[i + k]].rgb[c];
        for (; i < list.size(); ++i)
            for (std::size_t c = 0; c < 4; ++c)
                parts[0].rgb[c] += values[list[i]].rgb[c];
        for (std::size_t c = 0; c < 4; ++c)
            sums[place].rgb[c] =
                (parts[0].rgb[c] + parts[1].rgb[c]) + (parts[2].rgb[c] + parts[3].rgb[c]);
    }
}

} // namespace relumine::relight
