#include "prt/bounces/thinned_bounces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

namespace relumine::prt {

namespace {

/// Returns how many samples each row sums up.
std::vector<std::size_t> samples_of(const PlaceLists& emitters, const PlaceLists& averaged) {
    std::vector<std::size_t> result(averaged.size());
    for (std::size_t row = 0; row < result.size(); ++row)
        for (const std::uint32_t list : averaged[row])
            result[row] += emitters[list].size();
    return result;
}

/// Returns a number of [0, 1) for each list: the golden ratio's multiples are spread evenly among
/// neighbours, too.
double offset_of(std::size_t list) {
    const double turns = 0.61803398874989485 * static_cast<double>(list + 1);
    return turns - std::floor(turns);
}

PlaceLists thinned_lists(const PlaceLists& lists, double rate) {
    PlaceLists result;
    std::vector<std::uint32_t> kept;
    for (std::size_t list = 0; list < lists.size(); ++list) {
        const std::span<const std::uint32_t> all = lists[list];
        const double offset = offset_of(list);
        const auto size = static_cast<double>(all.size());
        // At least one, so that no row loses all that it gets.
        const auto count = std::min(
            std::max(static_cast<std::size_t>(size * rate + offset), std::size_t{1}), all.size());
        kept.clear();
        for (std::size_t i = 0; i < count; ++i)
            kept.push_back(all[static_cast<std::size_t>((static_cast<double>(i) + offset) * size /
                                                        static_cast<double>(count))]);
        result.append(kept);
    }
    return result;
}

} // namespace

BounceMatrix thinned(const BounceMatrix& matrix, std::size_t samples_per_row) {
    if (samples_per_row == 0)
        throw std::invalid_argument("samples of a row: expected 1 or more, got 0");
    const std::vector<std::size_t> before = samples_of(matrix.emitters, matrix.averaged);
    std::size_t sum = 0, num_rows = 0;
    for (const std::size_t samples : before) {
        sum += samples;
        num_rows += samples > 0 ? 1 : 0;
    }
    if (sum <= num_rows * samples_per_row)
        return matrix;
    BounceMatrix result = matrix;
    result.rays = {};
    result.emitters =
        thinned_lists(matrix.emitters,
                      static_cast<double>(num_rows * samples_per_row) / static_cast<double>(sum));
    const std::vector<std::size_t> after = samples_of(result.emitters, result.averaged);
    for (std::size_t row = 0; row < after.size(); ++row)
        if (after[row] > 0)
            result.weights[row] *= static_cast<float>(static_cast<double>(before[row]) /
                                                      static_cast<double>(after[row]));
    result.spectral_radius = spectral_radius(result);
    return result;
}

} // namespace relumine::prt
