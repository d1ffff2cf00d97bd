#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "relight/bounces/bounce_light.h"
#include "relight/bounces/bounce_product.h"
#include "relight/bounces/point_gather.h"

namespace relumine::relight {

namespace {

constexpr std::uint32_t MaxTransposedBounces = 1000;

using Values = std::vector<glm::dvec3>;

/// Products with the transpose of a matrix of bounces.
class TransposedProduct {
public:
    explicit TransposedProduct(const prt::BounceMatrix& matrix) : matrix_(matrix) {}

    /// Returns A^T values; all is by place.
    [[nodiscard]] Values of(const Values& values) {
        Values weighted(values.size());
        for_rows(0, values.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                weighted[i] = static_cast<double>(matrix_.weights[i]) * values[i];
        });
        return scattered(matrix_.emitters, scattered(matrix_.averaged, weighted));
    }

private:
    /// Adds each value to the places of its list. Runs of rows, always the same ones, add up by
    /// themselves, so threads do not matter.
    [[nodiscard]] Values scattered(const prt::PlaceLists& lists, const Values& values) {
        const std::size_t size = values.size();
        files::parallel_for(std::size_t{0}, of_runs_.size(), [&](std::size_t run) {
            Values& sums = of_runs_[run];
            sums.assign(size, glm::dvec3(0.0));
            for (std::size_t row = size * run / NumRuns; row < size * (run + 1) / NumRuns; ++row)
                if (values[row] != glm::dvec3(0.0))
                    for (const std::uint32_t place : lists[row])
                        sums[place] += values[row];
        });
        Values result(size);
        for_rows(0, size, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                for (const Values& sums : of_runs_)
                    result[i] += sums[i];
        });
        return result;
    }

    static constexpr std::size_t NumRuns = 8;
    const prt::BounceMatrix& matrix_;
    std::array<Values, NumRuns> of_runs_;
};

/// The sum of all channels' magnitudes, in a fixed order.
double size_of(const Values& values) {
    double sum = 0.0;
    for (const glm::dvec3& value : values)
        sum += std::abs(value.r) + std::abs(value.g) + std::abs(value.b);
    return sum;
}

} // namespace

std::vector<glm::vec3> bounce_adjoint(const SurfaceBounces& bounces, const prt::Transfer& transfer,
                                      std::span<const glm::vec3> weights,
                                      std::span<const glm::vec3> of_points) {
    const prt::BounceMatrix& matrix = *bounces.matrix;
    const std::size_t n = matrix.num_rows();
    const std::size_t num_points = matrix.points.num_points();
    std::uint32_t order = 1;
    while (order < MaxHarmonicOrder && num_points * num_harmonics(order) < of_points.size())
        ++order;
    if (transfer.num_receivers() != n || bounces.albedo.size() != n || weights.size() != n ||
        (!of_points.empty() && num_points * num_harmonics(order) != of_points.size()))
        throw std::invalid_argument("expected bounces and weights of one scene");
    // By place: what a receiver's light counts after so many bounces, backwards; and all together.
    Values counts(n), sum(n), albedo(n);
    const glm::vec3 safe(largest_safe_albedo(matrix));
    for (std::size_t place = 0; place < n; ++place) {
        counts[place] = weights[transfer.order[place]];
        albedo[place] = glm::min(bounces.albedo[transfer.order[place]], safe);
    }
    // What the light of points counts, by what surfaces send: the first bounce on the way back.
    Values by_sent(n);
    if (num_points != 0) {
        Values own(of_points.begin(), of_points.end());
        for (std::size_t place = 0; place < num_points; ++place) {
            if (of_points.empty())
                own.push_back(mean_radiance(glm::vec3(counts[place])));
            counts[place] = glm::dvec3(0.0);
        }
        PointBasis(matrix.points).scatter(own, order, by_sent);
    }
    const std::vector<std::uint32_t> places =
        bounces.passed_on.empty() ? std::vector<std::uint32_t>() : places_of(transfer.order);
    TransposedProduct product(matrix);
    const std::uint32_t last = bounces.limits.num_bounces.value_or(MaxTransposedBounces);
    double size_before = size_of(counts);
    for (std::uint32_t bounce = 0; bounce < last; ++bounce) {
        counts = product.of(counts);
        for (std::size_t place = 0; place < n; ++place) {
            if (bounce == 0)
                counts[place] += by_sent[place];
        }
        const Values sent = places.empty() ? Values() : counts;
        for (std::size_t place = 0; place < n; ++place)
            counts[place] *= albedo[place];
        for (const PassedOn& own : bounces.passed_on)
            counts[places[own.other]] += glm::dvec3(own.part) * sent[places[own.receiver]];
        for (std::size_t place = 0; place < n; ++place)
            sum[place] += counts[place];
        // The rest is a geometric series, or less. The first terms may fall faster than the others.
        constexpr double LeastRatio = 0.5, PartOfTolerance = 0.1;
        const double size = size_of(counts);
        const double ratio = std::max(LeastRatio, size / std::max(size_before, 1e-300));
        if (size == 0.0 || (!bounces.limits.num_bounces && ratio < 1.0 &&
                            size * ratio / (1.0 - ratio) <=
                                PartOfTolerance * bounces.limits.tolerance * size_of(sum)))
            break;
        size_before = size;
    }
    std::vector<glm::vec3> result(n);
    for (std::size_t place = 0; place < n; ++place)
        result[transfer.order[place]] = sum[place];
    return result;
}

} // namespace relumine::relight
