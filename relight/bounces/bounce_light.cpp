#include "relight/bounces/bounce_light.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "relight/bounces/bounce_kernel.h"
#include "relight/bounces/coarse_bounces.h"

namespace relumine::relight {

namespace {

/// Differences of earlier iterates that an accelerated step combines.
constexpr std::size_t AndersonDepth = 2;

/// More products than any scene needs whose light does not grow for ever.
constexpr std::uint32_t MaxBounces = 1000;

/// Rows that one task handles; sums over them are added in order, so that threads do not matter.
constexpr std::size_t RowsPerTask = 1024;

/// Steps are assumed to shrink by no more than this, whatever the last ones did: light in narrow
/// gaps is found late. The light that is left is then at least as large as the last step.
constexpr double LeastRatio = 0.5;

/// Solves the normal equations of up to AndersonDepth unknowns by Cholesky's method; a column that
/// depends on those before gets the factor 0.
std::array<double, AndersonDepth>
least_squares(std::array<std::array<double, AndersonDepth>, AndersonDepth> matrix,
              std::array<double, AndersonDepth> right, std::size_t size) {
    constexpr double SmallestPivot = 1e-12;
    std::array<double, AndersonDepth> largest{};
    std::array<bool, AndersonDepth> used{};
    for (std::size_t i = 0; i < size; ++i)
        largest[i] = matrix[i][i];
    for (std::size_t i = 0; i < size; ++i) {
        for (std::size_t k = 0; k < i; ++k)
            if (used[k])
                matrix[i][i] -= matrix[i][k] * matrix[i][k];
        used[i] = matrix[i][i] > SmallestPivot * largest[i];
        if (!used[i])
            continue;
        matrix[i][i] = std::sqrt(matrix[i][i]);
        for (std::size_t j = i + 1; j < size; ++j) {
            for (std::size_t k = 0; k < i; ++k)
                if (used[k])
                    matrix[j][i] -= matrix[j][k] * matrix[i][k];
            matrix[j][i] /= matrix[i][i];
        }
        for (std::size_t k = 0; k < i; ++k)
            if (used[k])
                right[i] -= matrix[i][k] * right[k];
        right[i] /= matrix[i][i];
    }
    std::array<double, AndersonDepth> result{};
    for (std::size_t i = size; i-- > 0;) {
        if (!used[i])
            continue;
        double value = right[i];
        for (std::size_t j = i + 1; j < size; ++j)
            if (used[j])
                value -= matrix[j][i] * result[j];
        result[i] = value / matrix[i][i];
    }
    return result;
}

} // namespace

class BounceLight::Impl {
public:
    Impl(const prt::BounceMatrix& matrix, const prt::Transfer& transfer)
        : matrix_(matrix), transfer_(transfer), size_(transfer.num_receivers()),
          coarse_(checked(matrix, size_)), coarse_sent_(coarse_.num_groups()), albedo_(size_),
          direct_(size_), sent_(size_), gathered_(size_), indirect_(size_), next_(size_),
          published_(size_, glm::vec3(0.0f)) {}

    void set_albedo(std::span<const glm::vec3> albedo) {
        if (albedo.size() != size_)
            throw std::invalid_argument(
                fmt::format("expected the albedo of {} receivers, got {}", size_, albedo.size()));
        float largest = 0.0f;
        for (const glm::vec3& value : albedo)
            for (int channel = 0; channel < 3; ++channel) {
                if (!(value[channel] >= 0.0f && std::isfinite(value[channel])))
                    throw std::invalid_argument(
                        fmt::format("expected an albedo >= 0, got {}", value[channel]));
                largest = std::max(largest, value[channel]);
            }
        const float safe = largest_safe_albedo();
        if (largest > safe)
            throw std::invalid_argument(
                fmt::format("expected an albedo up to {:.4g}, beyond which bounces grow for ever, "
                            "got {}",
                            safe, largest));
        contraction_ = static_cast<double>(largest) * static_cast<double>(matrix_.spectral_radius);
        for (std::size_t place = 0; place < size_; ++place)
            albedo_[place] = padded(albedo[transfer_.order[place]]);
        coarse_.set_albedo(albedo_);
    }

    BounceReport solve(std::span<const glm::vec3> direct, const BounceLimits& limits) {
        const auto start = std::chrono::steady_clock::now();
        set_direct(direct);
        std::fill(indirect_.begin(), indirect_.end(), PaddedRgb{});
        BounceReport report;
        forget_steps();
        const std::uint32_t last = limits.num_bounces.value_or(MaxBounces);
        while (report.num_bounces < last && contraction_ > 0.0) {
            bounce();
            ++report.num_bounces;
            if (limits.num_bounces) {
                indirect_.swap(next_);
                continue;
            }
            add_coarse_bounces();
            report.error = error_after(step_size());
            if (report.error <= limits.tolerance) {
                indirect_.swap(next_);
                break;
            }
            accelerate();
        }
        publish();
        report.seconds = seconds_since(start);
        return report;
    }

    BounceReport step(std::span<const glm::vec3> direct) {
        const auto start = std::chrono::steady_clock::now();
        set_direct(direct);
        BounceReport report;
        if (contraction_ > 0.0) {
            bounce();
            add_coarse_bounces();
            report.error = step_size();
            report.num_bounces = 1;
            indirect_.swap(next_);
        } else {
            std::fill(indirect_.begin(), indirect_.end(), PaddedRgb{});
        }
        publish();
        report.seconds = seconds_since(start);
        return report;
    }

    [[nodiscard]] std::span<const glm::vec3> indirect() const { return published_; }

private:
    static const prt::BounceMatrix& checked(const prt::BounceMatrix& matrix, std::size_t size) {
        if (matrix.num_rows() != size)
            throw std::invalid_argument(
                fmt::format("expected bounces of {} receivers, got {}", size, matrix.num_rows()));
        return matrix;
    }

    void forget_steps() {
        history_size_ = 0;
        last_step_ = 0.0;
        largest_ratio_ = 0.0;
    }

    static double seconds_since(std::chrono::steady_clock::time_point start) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    [[nodiscard]] float largest_safe_albedo() const {
        constexpr float Margin = 0.999f;
        return matrix_.spectral_radius > 0.0f ? Margin / matrix_.spectral_radius
                                              : std::numeric_limits<float>::max();
    }

    void set_direct(std::span<const glm::vec3> direct) {
        if (direct.size() != size_)
            throw std::invalid_argument(fmt::format(
                "expected the direct light of {} receivers, got {}", size_, direct.size()));
        for_rows([&](std::size_t begin, std::size_t end) {
            for (std::size_t place = begin; place < end; ++place)
                direct_[place] = padded(direct[transfer_.order[place]]);
        });
    }

    template<typename Function>
    void for_rows(const Function& function) const {
        tbb::parallel_for(
            std::size_t{0}, (size_ + RowsPerTask - 1) / RowsPerTask, [&](std::size_t task) {
                function(task * RowsPerTask, std::min(size_, (task + 1) * RowsPerTask));
            });
    }

    /// Sums arrays of doubles over all rows in a fixed order.
    template<std::size_t N, typename Function>
    [[nodiscard]] std::array<double, N> sum_over_rows(const Function& function) const {
        std::vector<std::array<double, N>> parts((size_ + RowsPerTask - 1) / RowsPerTask);
        for_rows([&](std::size_t begin, std::size_t end) {
            parts[begin / RowsPerTask] = function(begin, end);
        });
        std::array<double, N> sum{};
        for (const std::array<double, N>& part : parts)
            for (std::size_t k = 0; k < N; ++k)
                sum[k] += part[k];
        return sum;
    }

    /// next_ = A rho (B + indirect_).
    void bounce() {
        for_rows([&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c)
                    sent_[i].rgb[c] = albedo_[i].rgb[c] * (direct_[i].rgb[c] + indirect_[i].rgb[c]);
        });
        for_rows([&](std::size_t begin, std::size_t end) {
            sum_lists(matrix_.emitters, sent_, begin, end, gathered_);
        });
        for_rows([&](std::size_t begin, std::size_t end) {
            sum_lists(matrix_.averaged, gathered_, begin, end, next_);
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c)
                    next_[i].rgb[c] *= matrix_.weights[i];
        });
    }

    /// Adds what the change next_ - indirect_ becomes in all further bounces, as the groups of
    /// receivers tell. Places without any light stay black, whatever group they are in.
    void add_coarse_bounces() {
        for_rows([&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c)
                    sent_[i].rgb[c] = albedo_[i].rgb[c] * (next_[i].rgb[c] - indirect_[i].rgb[c]);
        });
        means_of_groups(sent_, coarse_.group_size(), coarse_sent_);
        const std::span<const PaddedRgb> more = coarse_.sum_of_bounces(coarse_sent_);
        for_rows([&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c)
                    next_[i].rgb[c] +=
                        next_[i].rgb[c] > 0.0f ? more[i / coarse_.group_size()].rgb[c] : 0.0f;
        });
    }

    /// Returns |next_ - indirect_| over |B + next_|.
    [[nodiscard]] double step_size() const {
        const auto [steps, all] = sum_over_rows<2>([&](std::size_t begin, std::size_t end) {
            // The fourth channel is 0 everywhere.
            std::array<double, 4> step_sums{}, light_sums{};
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c) {
                    const auto step = static_cast<double>(next_[i].rgb[c] - indirect_[i].rgb[c]);
                    const auto light = static_cast<double>(next_[i].rgb[c] + direct_[i].rgb[c]);
                    step_sums[c] += step * step;
                    light_sums[c] += light * light;
                }
            const auto sum_of = [](const std::array<double, 4>& sums) {
                return sums[0] + sums[1] + sums[2];
            };
            const std::array<double, 2> part = {sum_of(step_sums), sum_of(light_sums)};
            return part;
        });
        return all > 0.0 ? std::sqrt(steps / all) : 0.0;
    }

    /// Estimates the error after a step: steps become smaller by the largest ratio that was seen.
    /// After the first one the factor of the matrix itself is all that is known.
    double error_after(double step) {
        double ratio = contraction_;
        if (last_step_ > 0.0) {
            largest_ratio_ = std::max({largest_ratio_, step / last_step_, LeastRatio});
            ratio = largest_ratio_;
        }
        last_step_ = step;
        ratio = std::min(ratio, MaxContraction);
        return step * ratio / (1.0 - ratio);
    }

    /// Takes the next iterate: next_, corrected by the least squares of the last steps [Anderson
    /// 1965], for each channel by itself.
    void accelerate() {
        Step& now = history_[newest_];
        const std::size_t depth = history_size_;
        now.change.resize(size_);
        next_.swap(now.result);
        next_.resize(size_);
        for_rows([&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c)
                    now.change[i].rgb[c] = now.result[i].rgb[c] - indirect_[i].rgb[c];
        });
        std::array<std::array<float, 4>, AndersonDepth> factors{};
        if (depth > 0)
            factors = least_squares_of_changes(now, depth);
        for_rows([&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c) {
                    float value = now.result[i].rgb[c];
                    for (std::size_t a = 0; a < depth; ++a)
                        value -= factors[a][c] *
                                 (now.result[i].rgb[c] - step_before(a).result[i].rgb[c]);
                    indirect_[i].rgb[c] = value;
                }
        });
        newest_ = (newest_ + 1) % history_.size();
        history_size_ = std::min(history_size_ + 1, AndersonDepth);
    }

    struct Step {
        std::vector<PaddedRgb> change;
        std::vector<PaddedRgb> result;
    };

    /// Returns the factors of the differences to the `depth` steps before that make the change
    /// smallest.
    [[nodiscard]] std::array<std::array<float, 4>, AndersonDepth>
    least_squares_of_changes(const Step& now, std::size_t depth) const {
        // Of each channel: products of each difference with the change, then with each other.
        constexpr std::size_t NumSums = AndersonDepth * (1 + AndersonDepth);
        const auto sums = sum_over_rows<3 * NumSums>([&](std::size_t begin, std::size_t end) {
            std::array<std::array<double, 4>, NumSums> sums_of_task{};
            for (std::size_t i = begin; i < end; ++i) {
                const std::array<float, 4>& change = now.change[i].rgb;
                std::array<std::array<double, 4>, AndersonDepth> differences{};
                for (std::size_t a = 0; a < depth; ++a)
                    for (std::size_t c = 0; c < 4; ++c)
                        differences[a][c] =
                            static_cast<double>(change[c] - step_before(a).change[i].rgb[c]);
                for (std::size_t a = 0; a < depth; ++a)
                    for (std::size_t c = 0; c < 4; ++c) {
                        sums_of_task[a][c] += static_cast<double>(change[c]) * differences[a][c];
                        for (std::size_t b = 0; b <= a; ++b)
                            sums_of_task[AndersonDepth * (1 + a) + b][c] +=
                                differences[a][c] * differences[b][c];
                    }
            }
            std::array<double, 3 * NumSums> part{};
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t k = 0; k < NumSums; ++k)
                    part[c * NumSums + k] = sums_of_task[k][c];
            return part;
        });
        std::array<std::array<float, 4>, AndersonDepth> factors{};
        for (std::size_t c = 0; c < 3; ++c) {
            std::array<std::array<double, AndersonDepth>, AndersonDepth> matrix{};
            std::array<double, AndersonDepth> vector{};
            for (std::size_t a = 0; a < depth; ++a) {
                vector[a] = sums[c * NumSums + a];
                for (std::size_t b = 0; b <= a; ++b)
                    matrix[a][b] = matrix[b][a] = sums[c * NumSums + AndersonDepth * (1 + a) + b];
            }
            const auto solution = least_squares(matrix, vector, depth);
            for (std::size_t a = 0; a < depth; ++a)
                factors[a][c] = static_cast<float>(solution[a]);
        }
        return factors;
    }

    /// The step `age` + 1 before history_[newest_], which is being made.
    [[nodiscard]] const Step& step_before(std::size_t age) const {
        return history_[(newest_ + history_.size() - 1 - age) % history_.size()];
    }

    void publish() {
        for_rows([&](std::size_t begin, std::size_t end) {
            for (std::size_t place = begin; place < end; ++place) {
                const PaddedRgb& value = indirect_[place];
                // Corrections may go too far by the tolerance.
                published_[transfer_.order[place]] = {std::max(value.rgb[0], 0.0f),
                                                      std::max(value.rgb[1], 0.0f),
                                                      std::max(value.rgb[2], 0.0f)};
            }
        });
    }

    /// Keeps the estimate of the error finite.
    static constexpr double MaxContraction = 0.999;

    const prt::BounceMatrix& matrix_;
    const prt::Transfer& transfer_;
    std::size_t size_;
    /// Upper bound of the factor from one bounce to the next.
    double contraction_ = 0.0;
    CoarseBounces coarse_;
    /// [num_groups]
    std::vector<PaddedRgb> coarse_sent_;
    /// All by place.
    std::vector<PaddedRgb> albedo_;
    std::vector<PaddedRgb> direct_;
    std::vector<PaddedRgb> sent_;
    std::vector<PaddedRgb> gathered_;
    std::vector<PaddedRgb> indirect_;
    std::vector<PaddedRgb> next_;
    std::array<Step, AndersonDepth + 1> history_;
    std::size_t newest_ = 0;
    std::size_t history_size_ = 0;
    /// Relative to all light; of this iteration.
    double last_step_ = 0.0;
    double largest_ratio_ = 0.0;
    /// [num_receivers] in the receivers' order.
    std::vector<glm::vec3> published_;
};

BounceLight::BounceLight(const prt::BounceMatrix& matrix, const prt::Transfer& transfer)
    : impl_(std::make_unique<Impl>(matrix, transfer)) {}
BounceLight::~BounceLight() = default;
BounceLight::BounceLight(BounceLight&&) noexcept = default;
BounceLight& BounceLight::operator=(BounceLight&&) noexcept = default;

void BounceLight::set_albedo(std::span<const glm::vec3> albedo) {
    impl_->set_albedo(albedo);
}
BounceReport BounceLight::solve(std::span<const glm::vec3> direct, const BounceLimits& limits) {
    return impl_->solve(direct, limits);
}
BounceReport BounceLight::step(std::span<const glm::vec3> direct) {
    return impl_->step(direct);
}
std::span<const glm::vec3> BounceLight::indirect() const {
    return impl_->indirect();
}

} // namespace relumine::relight
