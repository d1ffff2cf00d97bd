#include "prt/bounces/bounce_matrix.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/parallel.h"
#include "prt/bounces/matrix_rows.h"

namespace relumine::prt {

namespace {

/// Row sums are 1 at most; weights are rounded.
constexpr double LargestRowSum = 1.0 + 1e-4;

constexpr int NumPowerIterations = 30;

void require_lists(const PlaceLists& lists, std::size_t num_receivers) {
    if (lists.begin.size() != num_receivers + 1)
        throw std::invalid_argument(fmt::format("expected bounces of {} receivers, got {}",
                                                num_receivers, lists.begin.size() - 1));
    if (lists.begin.front() != 0 || lists.begin.back() != lists.places.size() ||
        !std::is_sorted(lists.begin.begin(), lists.begin.end()))
        throw std::invalid_argument("expected rows of bounces that follow each other");
    for (const std::uint32_t place : lists.places)
        if (place >= num_receivers)
            throw std::invalid_argument(fmt::format(
                "expected bounces between {} receivers, got number {}", num_receivers, place));
}

} // namespace

void require_points(const PointRows& rows, std::size_t num_receivers) {
    if (rows.num_points() * rows.num_directions != rows.emitters.size() ||
        rows.num_points() > num_receivers)
        throw std::invalid_argument("expected as many directions of each point");
    for (const std::uint32_t place : rows.emitters)
        if (place != NoEmitter && place >= num_receivers)
            throw std::invalid_argument(fmt::format(
                "expected bounces between {} receivers, got number {}", num_receivers, place));
}

void require_bounces(const BounceMatrix& matrix, std::size_t num_receivers) {
    if (matrix.num_rows() != num_receivers)
        throw std::invalid_argument(fmt::format("expected bounces of {} receivers, got {}",
                                                num_receivers, matrix.num_rows()));
    require_lists(matrix.emitters, num_receivers);
    require_points(matrix.points, num_receivers);
    std::vector<std::uint32_t> num_emitters;
    for (std::size_t place = 0; place < num_receivers; ++place)
        num_emitters.push_back(static_cast<std::uint32_t>(matrix.emitters[place].size()));
    require_rows(matrix, num_emitters);
}

void require_rows(const BounceMatrix& matrix, std::span<const std::uint32_t> num_emitters) {
    const std::size_t num_receivers = matrix.num_rows();
    require_lists(matrix.averaged, num_receivers);
    for (std::size_t place = 0; place < num_receivers; ++place) {
        double sum_of_emitters = 0.0;
        for (const std::uint32_t other : matrix.averaged[place])
            sum_of_emitters += static_cast<double>(num_emitters[other]);
        const double sum = static_cast<double>(matrix.weights[place]) * sum_of_emitters;
        if (!(matrix.weights[place] >= 0.0f && sum <= LargestRowSum))
            throw std::invalid_argument(fmt::format(
                "expected bounces that keep at most all of the light, got a factor of {}", sum));
    }
    if (!(matrix.spectral_radius >= 0.0f && matrix.spectral_radius <= LargestRowSum))
        throw std::invalid_argument(fmt::format(
            "expected bounces that keep 0 to 1 of the light, got {}", matrix.spectral_radius));
}

std::size_t first_emitter(const BounceMatrix& matrix) {
    const PlaceLists& emitters = matrix.emitters;
    if (emitters.places.empty())
        return 0;
    std::size_t lowest = emitters.size();
    for (std::size_t row = 0; row < emitters.size(); ++row)
        if (!emitters[row].empty())
            lowest = std::min(lowest, std::size_t{emitters[row].front()});
    return first_emitter(lowest, matrix.averaged);
}

std::size_t first_emitter(std::size_t lowest_place, const PlaceLists& averaged) {
    std::size_t first = lowest_place;
    // Those that share samples with rows from there on belong to them.
    for (std::size_t end = averaged.size(); first < end;) {
        std::size_t lowest = first;
        for (std::size_t row = first; row < end; ++row)
            if (!averaged[row].empty())
                lowest = std::min(lowest, std::size_t{averaged[row].front()});
        end = std::exchange(first, lowest);
    }
    const auto end = static_cast<std::ptrdiff_t>(averaged.begin[first]);
    const bool are_apart = std::all_of(averaged.places.begin(), averaged.places.begin() + end,
                                       [first](std::uint32_t place) { return place < first; });
    return are_apart ? first : 0;
}

float spectral_radius(const BounceMatrix& matrix) {
    return spectral_radius(matrix, NumPowerIterations);
}

float spectral_radius(const BounceMatrix& matrix, int num_bounces) {
    const std::size_t n = matrix.num_rows();
    if (matrix.emitters.places.empty())
        return 0.0f;
    const std::size_t first = first_emitter(matrix);
    std::vector<float> x(n, 1.0f);
    std::vector<float> gathered(n);
    std::vector<float> product(n);
    const auto sum_of = [](std::span<const std::uint32_t> places, const std::vector<float>& from) {
        // Several sums at a time, as an addition takes longer than the load that feeds it.
        std::array<double, 4> sums{};
        std::size_t i = 0;
        for (; i + sums.size() <= places.size(); i += sums.size())
            for (std::size_t k = 0; k < sums.size(); ++k)
                sums[k] += static_cast<double>(from[places[i + k]]);
        for (; i < places.size(); ++i)
            sums[0] += static_cast<double>(from[places[i]]);
        return (sums[0] + sums[1]) + (sums[2] + sums[3]);
    };
    double norm = std::sqrt(static_cast<double>(n - first));
    double radius = 0.0;
    for (int iteration = 0; iteration < num_bounces; ++iteration) {
        files::parallel_for(first, n, [&](std::size_t place) {
            gathered[place] = static_cast<float>(sum_of(matrix.emitters[place], x));
        });
        files::parallel_for(first, n, [&](std::size_t place) {
            product[place] = static_cast<float>(static_cast<double>(matrix.weights[place]) *
                                                sum_of(matrix.averaged[place], gathered));
        });
        double squares = 0.0;
        for (const float value : product)
            squares += static_cast<double>(value) * static_cast<double>(value);
        const double next = std::sqrt(squares);
        radius = next / norm;
        if (next == 0.0)
            return 0.0f;
        for (std::size_t i = 0; i < n; ++i)
            x[i] = static_cast<float>(static_cast<double>(product[i]) / next);
        norm = 1.0;
    }
    return static_cast<float>(std::min(radius, 1.0));
}

} // namespace relumine::prt
