// Based on: W. Madow, "On the Theory of Systematic Sampling, II", 1949, sampling with probability
//           proportional to size. The estimate is Horvitz and Thompson's, 1952.
#include "relight/light_fit/scaled_receivers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>

namespace relumine::relight {

namespace {

// The expected errors belong to other lights. So some receivers are chosen whatever is expected; a
// scale stays below 1/sqrt(this part).
constexpr double EvenPart = 0.3;

// An expected error is averaged over so many neighbours on each side: shadows of other lights lie
// near by, not at the same place.
constexpr std::size_t Neighbours = 3;

std::vector<double> averaged(std::span<const double> values) {
    std::vector<double> result(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t begin = i - std::min(i, Neighbours);
        const std::size_t end = std::min(i + Neighbours + 1, values.size());
        for (std::size_t j = begin; j < end; ++j)
            result[i] += values[j];
        result[i] /= static_cast<double>(end - begin);
    }
    return result;
}

/// Returns the factor k for which the sum of min(k share, 1) is `count`. More shares than that
/// must be above 0.
double scale_to(std::span<const double> shares, double count) {
    std::vector<double> descending(shares.begin(), shares.end());
    std::sort(descending.rbegin(), descending.rend());
    double rest = std::accumulate(descending.begin(), descending.end(), 0.0);
    std::size_t num_certain = 0;
    while (num_certain < descending.size() && rest > 0.0) {
        const double factor = (count - static_cast<double>(num_certain)) / rest;
        if (factor * descending[num_certain] <= 1.0)
            return factor;
        rest -= descending[num_certain++];
    }
    return 0.0;
}

} // namespace

ScaledReceivers choose_receivers(const prt::Transfer& transfer, std::span<const double> expected,
                                 std::size_t count) {
    ScaledReceivers chosen;
    for (std::size_t place = 0; place < transfer.num_receivers(); ++place)
        if (transfer.normals[place] != glm::vec3(0.0f))
            chosen.places.push_back(place);
    const std::size_t num_lit = chosen.places.size();
    if (num_lit <= count) {
        chosen.scales.assign(num_lit, 1.0f);
        return chosen;
    }
    const std::vector<std::size_t> lit = std::move(chosen.places);
    chosen.places.clear();
    const std::vector<double> smooth = averaged(expected);
    double sum = 0.0;
    for (const std::size_t place : lit)
        sum += smooth[place];
    const double even = (sum > 0.0 ? EvenPart : 1.0) / static_cast<double>(num_lit);
    std::vector<double> shares;
    shares.reserve(num_lit);
    for (const std::size_t place : lit)
        shares.push_back(even + (sum > 0.0 ? (1.0 - EvenPart) * smooth[place] / sum : 0.0));
    const double factor = scale_to(shares, static_cast<double>(count));
    double next = 0.5; // a receiver is taken where the running sum passes n + 0.5
    double before = 0.0;
    for (std::size_t i = 0; i < num_lit; ++i) {
        const double probability = std::min(factor * shares[i], 1.0);
        before += probability;
        if (before < next)
            continue;
        next += 1.0;
        chosen.places.push_back(lit[i]);
        chosen.scales.push_back(static_cast<float>(1.0 / std::sqrt(probability)));
    }
    return chosen;
}

void add_squared_errors(const Relighter& relighter, const LightGoal& goal,
                        std::span<const lights::DistantLight> lights, std::span<double> errors) {
    const prt::Transfer& transfer = relighter.transfer();
    std::vector<glm::vec3> normals(transfer.num_receivers());
    for (std::size_t place = 0; place < normals.size(); ++place)
        normals[transfer.order[place]] = transfer.normals[place];
    const std::vector<glm::vec3> radiance =
        radiance_under(lights, normals, relighter.shadow_rays());
    std::vector<double> squares(errors.size());
    for (std::size_t place = 0; place < squares.size(); ++place) {
        const std::uint32_t receiver = transfer.order[place];
        const glm::dvec3 difference =
            glm::dvec3(radiance[receiver]) - glm::dvec3(goal.radiance[receiver]);
        const double weight =
            goal.weights.empty() ? 1.0 : static_cast<double>(goal.weights[receiver]);
        squares[place] = weight * glm::dot(difference, difference);
    }
    const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
    if (sum > 0.0)
        for (std::size_t place = 0; place < squares.size(); ++place)
            errors[place] += squares[place] / sum;
}

} // namespace relumine::relight
