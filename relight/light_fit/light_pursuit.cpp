#include "relight/light_fit/light_pursuit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "relight/light_fit/non_negative_fit.h"

namespace relumine::relight {

namespace {

// A column with a smaller new part than this is a combination of others. Well above float rounding.
constexpr float LeastNewPart = 1e-4f;

// A smaller gain of an exchange is rounding, and exchanging for it could go on for ever.
constexpr double LeastGain = 1e-9;

/// Candidates of one task of sums over lights: tens of microseconds, and they stay in the cache.
constexpr std::size_t CandidatesPerTask = 1024;

} // namespace

LightPursuit::LightPursuit(const TransferMatrix& matrix, std::span<const glm::vec3> radiance)
    : matrix_(matrix), norms_(matrix.num_directions()) {
    for (std::size_t j = 0; j < norms_.size(); ++j)
        norms_[j] = TransferMatrix::dot(matrix.column(j), matrix.column(j));
    new_norms_ = norms_;
    std::vector<float> channel(radiance.size());
    for (std::size_t c = 0; c < 3; ++c) {
        std::transform(radiance.begin(), radiance.end(), channel.begin(),
                       [c](const glm::vec3& b) { return b[static_cast<int>(c)]; });
        targets_[c] = matrix.products(channel);
    }
    correlations_ = targets_;
}

void LightPursuit::take(std::span<const std::size_t> lights) {
    for (const std::size_t candidate : lights)
        push_back(candidate, glm::dvec3(0.0));
    fit();
}

bool LightPursuit::take_best() {
    correlate();
    const std::size_t best = best_candidate();
    if (gain(best) <= 0.0)
        return false;
    push_back(best, glm::dvec3(0.0));
    fit();
    return true;
}

bool LightPursuit::exchange() {
    bool moved = false;
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
        const double old_error = error();
        const Light old = chosen_.front();
        pop_front();
        const std::vector<Light> others = chosen_;
        fit();
        correlate();
        const std::size_t best = best_candidate();
        if (best != old.candidate && gain(best) > 0.0) {
            push_back(best, glm::dvec3(0.0));
            fit();
            if (error() < (1.0 - LeastGain) * old_error) {
                moved = true;
                continue;
            }
            pop_back();
        }
        chosen_ = others;
        push_back(old.candidate, old.irradiance);
    }
    return moved;
}

double LightPursuit::error() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
        glm::dvec3 slope(0.0);
        for (std::size_t l = 0; l < chosen_.size(); ++l)
            slope +=
                chosen_[l].irradiance * static_cast<double>(products_[l][chosen_[k].candidate]);
        sum += glm::dot(chosen_[k].irradiance, slope - 2.0 * target(chosen_[k].candidate));
    }
    return sum;
}

void LightPursuit::push_back(std::size_t candidate, const glm::dvec3& irradiance) {
    std::vector<float> products = matrix_.products(matrix_.column(candidate));
    std::vector<float> row = products;
    files::parallel_for(candidates(), [&](const auto& some) {
        for (const std::vector<float>& other : basis_) {
            const float common = other[candidate];
            for (std::size_t j = some.begin(); j < some.end(); ++j)
                row[j] -= common * other[j];
        }
    });
    const float scale =
        1.0f / std::sqrt(std::max(row[candidate], std::numeric_limits<float>::min()));
    for (std::size_t j = 0; j < row.size(); ++j) {
        row[j] *= scale;
        new_norms_[j] -= row[j] * row[j];
    }
    chosen_.push_back({candidate, irradiance});
    products_.push_back(std::move(products));
    basis_.push_back(std::move(row));
}

void LightPursuit::pop_back() {
    const std::vector<float>& row = basis_.back();
    for (std::size_t j = 0; j < row.size(); ++j)
        new_norms_[j] += row[j] * row[j];
    basis_.pop_back();
    products_.pop_back();
    chosen_.pop_back();
}

void LightPursuit::pop_front() {
    for (std::size_t k = 1; k < chosen_.size(); ++k) {
        const std::size_t candidate = chosen_[k].candidate;
        const float a = basis_[k - 1][candidate];
        const float b = basis_[k][candidate];
        const float length = std::hypot(a, b);
        const float cosine = length > 0.0f ? a / length : 1.0f;
        const float sine = length > 0.0f ? b / length : 0.0f;
        files::parallel_for(candidates(), [&](const auto& some) {
            float* first = basis_[k - 1].data();
            float* second = basis_[k].data();
            for (std::size_t j = some.begin(); j < some.end(); ++j) {
                const float turned = cosine * first[j] + sine * second[j];
                second[j] = cosine * second[j] - sine * first[j];
                first[j] = turned;
            }
        });
    }
    std::rotate(chosen_.begin(), chosen_.begin() + 1, chosen_.end());
    std::rotate(products_.begin(), products_.begin() + 1, products_.end());
    pop_back();
}

void LightPursuit::fit() {
    const std::size_t n = chosen_.size();
    std::vector<double> gram(n * n);
    for (std::size_t l = 0; l < n; ++l)
        for (std::size_t k = 0; k < n; ++k) // products_[l] of k and products_[k] of l are equal
            gram[l * n + k] = static_cast<double>(products_[l][chosen_[k].candidate]);
    files::parallel_for(0, 3, [&](int channel) {
        std::vector<double> targets(n);
        std::vector<double> x(n);
        for (std::size_t k = 0; k < n; ++k) {
            targets[k] = target(chosen_[k].candidate)[channel];
            x[k] = chosen_[k].irradiance[channel];
        }
        fit_non_negative(gram, targets, x);
        for (std::size_t k = 0; k < n; ++k)
            chosen_[k].irradiance[channel] = x[k];
    });
}

void LightPursuit::correlate() {
    files::parallel_for(candidates(), [&](const auto& some) {
        for (std::size_t c = 0; c < 3; ++c) {
            float* correlations = correlations_[c].data();
            std::copy_n(targets_[c].data() + some.begin(), some.size(),
                        correlations + some.begin());
            for (std::size_t l = 0; l < chosen_.size(); ++l) {
                const auto irradiance =
                    static_cast<float>(chosen_[l].irradiance[static_cast<int>(c)]);
                const float* products = products_[l].data();
                for (std::size_t j = some.begin(); j < some.end(); ++j)
                    correlations[j] -= irradiance * products[j];
            }
        }
    });
}

double LightPursuit::gain(std::size_t candidate) const {
    if (!(new_norms_[candidate] > LeastNewPart * norms_[candidate]))
        return 0.0; // a combination of the chosen columns
    double useful = 0.0;
    for (const std::vector<float>& correlations : correlations_) {
        const auto common = static_cast<double>(std::max(correlations[candidate], 0.0f));
        useful += common * common;
    }
    return useful / static_cast<double>(new_norms_[candidate]);
}

std::size_t LightPursuit::best_candidate() const {
    std::size_t best = 0;
    for (std::size_t j = 1; j < norms_.size(); ++j)
        if (gain(j) > gain(best))
            best = j;
    return best;
}

glm::dvec3 LightPursuit::target(std::size_t candidate) const {
    return {targets_[0][candidate], targets_[1][candidate], targets_[2][candidate]};
}

files::IndexRange<std::size_t> LightPursuit::candidates() const {
    return {0, norms_.size(), CandidatesPerTask};
}

} // namespace relumine::relight
