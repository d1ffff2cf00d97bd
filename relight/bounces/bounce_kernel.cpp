#include "relight/bounces/bounce_kernel.h"

#include <cstdint>

namespace relumine::relight {

void gather_rows(const prt::BounceMatrix& matrix, std::span<const PaddedRgb> sent,
                 std::size_t begin, std::size_t end, std::span<PaddedRgb> result) {
    // Several sums at a time, as an addition takes longer than the load that feeds it.
    constexpr std::size_t NumSums = 4;
    for (std::size_t place = begin; place < end; ++place) {
        const std::span<const std::uint32_t> row = matrix.row(place);
        std::array<PaddedRgb, NumSums> sums{};
        std::size_t i = 0;
        for (; i + NumSums <= row.size(); i += NumSums)
            for (std::size_t k = 0; k < NumSums; ++k)
                for (std::size_t c = 0; c < 4; ++c)
                    sums[k].rgb[c] += sent[row[i + k]].rgb[c];
        for (; i < row.size(); ++i)
            for (std::size_t c = 0; c < 4; ++c)
                sums[0].rgb[c] += sent[row[i]].rgb[c];
        for (std::size_t c = 0; c < 4; ++c)
            result[place].rgb[c] = matrix.weights[place] * ((sums[0].rgb[c] + sums[1].rgb[c]) +
                                                            (sums[2].rgb[c] + sums[3].rgb[c]));
    }
}

} // namespace relumine::relight
