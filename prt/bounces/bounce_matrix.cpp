#include "prt/bounces/bounce_matrix.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace relumine::prt {

namespace {

/// Row sums are 1 at most; weights are rounded.
constexpr double LargestRowSum = 1.0 + 1e-4;

constexpr int NumPowerIterations = 30;

} // namespace

void require_bounces(const BounceMatrix& matrix, std::size_t num_rows, std::size_t num_emitters) {
    if (matrix.num_rows() != num_rows || matrix.row_begin.size() != num_rows + 1)
        throw std::invalid_argument(
            fmt::format("expected bounces of {} receivers, got {}", num_rows, matrix.num_rows()));
    if (matrix.row_begin.front() != 0 || matrix.row_begin.back() != matrix.columns.size() ||
        !std::is_sorted(matrix.row_begin.begin(), matrix.row_begin.end()))
        throw std::invalid_argument("expected rows of bounces that follow each other");
    for (std::size_t place = 0; place < num_rows; ++place) {
        const double sum = static_cast<double>(matrix.weights[place]) *
                           static_cast<double>(matrix.row(place).size());
        if (!(matrix.weights[place] >= 0.0f && sum <= LargestRowSum))
            throw std::invalid_argument(fmt::format(
                "expected bounces that keep at most all of the light, got a factor of {}", sum));
    }
    for (const std::uint32_t column : matrix.columns)
        if (column >= num_emitters)
            throw std::invalid_argument(fmt::format(
                "expected bounces from {} emitters, got number {}", num_emitters, column));
    if (!(matrix.spectral_radius >= 0.0f && matrix.spectral_radius <= LargestRowSum))
        throw std::invalid_argument(fmt::format(
            "expected bounces that keep 0 to 1 of the light, got {}", matrix.spectral_radius));
}

float spectral_radius(const BounceMatrix& matrix) {
    const std::size_t n = matrix.num_rows();
    if (matrix.columns.empty())
        return 0.0f;
    std::vector<float> x(n, 1.0f);
    std::vector<float> product(n);
    double norm = std::sqrt(static_cast<double>(n));
    double radius = 0.0;
    for (int iteration = 0; iteration < NumPowerIterations; ++iteration) {
        tbb::parallel_for(std::size_t{0}, n, [&](std::size_t place) {
            double sum = 0.0;
            for (const std::uint32_t column : matrix.row(place))
                sum += static_cast<double>(x[column]);
            product[place] = static_cast<float>(static_cast<double>(matrix.weights[place]) * sum);
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
