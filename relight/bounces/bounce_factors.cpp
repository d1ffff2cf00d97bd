#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "relight/bounces/bounce_light.h"

namespace relumine::relight {

namespace {

constexpr std::uint32_t MaxTransposedBounces = 1000;

} // namespace

std::vector<glm::dvec3> bounce_factors(const SurfaceBounces& bounces, const prt::Transfer& transfer,
                                       std::span<const std::uint32_t> receivers) {
    const prt::BounceMatrix& matrix = *bounces.matrix;
    const std::size_t n = matrix.num_rows();
    if (receivers.empty() || transfer.num_receivers() != n || bounces.albedo.size() != n)
        throw std::invalid_argument("expected bounces and receivers of one scene");
    std::vector<std::uint32_t> place_of(n);
    for (std::uint32_t place = 0; place < n; ++place)
        place_of[transfer.order[place]] = place;

    // By place: what a receiver's light counts after so many bounces, backwards; and all together.
    std::vector<glm::dvec3> counts(n, glm::dvec3(0.0));
    std::vector<glm::dvec3> sum(n, glm::dvec3(0.0));
    for (const std::uint32_t receiver : receivers) {
        if (receiver >= n)
            throw std::invalid_argument("expected an index of a receiver");
        counts[place_of[receiver]] += glm::dvec3(1.0 / static_cast<double>(receivers.size()));
    }
    std::vector<glm::dvec3> through(n);
    const std::uint32_t last = bounces.limits.num_bounces.value_or(MaxTransposedBounces);
    double total = 0.0;
    for (std::uint32_t bounce = 0; bounce < last; ++bounce) {
        std::fill(through.begin(), through.end(), glm::dvec3(0.0));
        for (std::size_t place = 0; place < n; ++place)
            if (counts[place] != glm::dvec3(0.0))
                for (const std::uint32_t other : matrix.averaged[place])
                    through[other] += static_cast<double>(matrix.weights[place]) * counts[place];
        std::fill(counts.begin(), counts.end(), glm::dvec3(0.0));
        for (std::size_t place = 0; place < n; ++place)
            if (through[place] != glm::dvec3(0.0))
                for (const std::uint32_t emitter : matrix.emitters[place])
                    counts[emitter] += through[place];
        double size = 0.0;
        for (std::size_t place = 0; place < n; ++place) {
            counts[place] *= glm::dvec3(bounces.albedo[transfer.order[place]]);
            sum[place] += counts[place];
            size += counts[place].r + counts[place].g + counts[place].b;
        }
        total += size;
        if (!bounces.limits.num_bounces && size <= 0.1 * bounces.limits.tolerance * total)
            break;
    }
    std::vector<glm::dvec3> result(n);
    for (std::size_t place = 0; place < n; ++place)
        result[transfer.order[place]] = sum[place];
    return result;
}

} // namespace relumine::relight
