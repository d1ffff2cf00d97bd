#include "relight/bounces/bounce_light.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <fmt/format.h>
#include <glm/common.hpp>

#include "relight/bounces/bounce_product.h"
#include "relight/bounces/coarse_bounces.h"

namespace relumine::relight {

namespace {

/// Differences of earlier iterates that an accelerated step combines.
constexpr std::size_t AndersonDepth = 2;

/// More products than any scene needs whose light does not grow for ever.
constexpr std::uint32_t MaxBounces = 1000;

/// Steps are assumed to shrink by no more than this, whatever the last ones did; where light stays
/// long, by no more than the second.
constexpr double LeastRatio = 0.5, LeastRatioOfRooms = 0.75;

/// The error of receivers with less direct light than this part of the mean counts a third: light
/// in gaps that are nearly closed is found late.
constexpr double LeastDirect = 1e-3, WeightWithout = 1.0 / 3.0;

using AndersonMatrix = Eigen::Matrix<double, AndersonDepth, AndersonDepth>;
using AndersonVector = Eigen::Matrix<double, AndersonDepth, 1>;

/// Solves normal equations. An unknown whose column depends on those before is 0.
AndersonVector least_squares(AndersonMatrix matrix, AndersonVector right) {
    static_assert(AndersonDepth == 2);
    constexpr double SmallestPivot = 1e-12;
    const auto leave_out = [&](Eigen::Index i) {
        matrix.row(i).setZero();
        matrix.col(i).setZero();
        matrix(i, i) = 1.0;
        right[i] = 0.0;
    };
    if (!(matrix(0, 0) > 0.0))
        leave_out(0);
    const double pivot = matrix(1, 1) - matrix(1, 0) * matrix(1, 0) / matrix(0, 0);
    if (!(pivot > SmallestPivot * matrix(1, 1)))
        leave_out(1);
    return matrix.llt().solve(right);
}

} // namespace

class BounceLight::Impl {
public:
    Impl(const prt::BounceMatrix& matrix, const prt::Transfer& transfer, const SharedRows& shared)
        : matrix_(matrix), transfer_(transfer), size_(transfer.num_receivers()),
          product_(matrix, size_, shared), first_(product_.first()), albedo_(size_), direct_(size_),
          sent_(size_), indirect_(size_), next_(size_), published_(size_, glm::vec3(0.0f)) {}

    void set_albedo(std::span<const glm::vec3> albedo) {
        if (albedo.size() != size_)
            throw std::invalid_argument(
                fmt::format("expected the albedo of {} receivers, got {}", size_, albedo.size()));
        float largest = 0.0f;
        for (std::size_t place = 0; place < size_; ++place) {
            const glm::vec3& value = albedo[transfer_.order[place]];
            for (int channel = 0; channel < 3; ++channel) {
                if (!(value[channel] >= 0.0f && std::isfinite(value[channel])))
                    throw std::invalid_argument(
                        fmt::format("expected an albedo >= 0, got {}", value[channel]));
                if (place >= first_)
                    largest = std::max(largest, value[channel]);
            }
        }
        const float safe = largest_safe_albedo(matrix_);
        if (largest > safe && largest > 1.0f)
            throw std::invalid_argument(
                fmt::format("expected an albedo up to {:.4g}, beyond which bounces grow for ever, "
                            "got {}",
                            safe, largest));
        largest = std::min(largest, safe);
        contraction_ = static_cast<double>(largest) * static_cast<double>(matrix_.spectral_radius);
        sends_ = largest > 0.0f && product_.has_emitters();
        for (std::size_t place = 0; place < size_; ++place)
            albedo_[place] = padded(glm::min(albedo[transfer_.order[place]], glm::vec3(safe)));
        coarse_.reset();
    }

    BounceReport solve(std::span<const glm::vec3> direct, const BounceLimits& limits) {
        const auto start = std::chrono::steady_clock::now();
        set_direct(direct);
        std::fill(indirect_.begin(), indirect_.end(), PaddedRgb{});
        BounceReport report;
        if (sends_ && limits.num_bounces) {
            for (; report.num_bounces < *limits.num_bounces; ++report.num_bounces) {
                send();
                bounce(first_, size_);
                indirect_.swap(next_);
            }
            if (report.num_bounces > 0)
                light_the_rest();
        } else if (sends_) {
            forget_steps();
            send();
            for (;;) {
                bounce(first_, size_);
                ++report.num_bounces;
                report.error = error_after(correct());
                if (report.error <= limits.tolerance || report.num_bounces == MaxBounces)
                    break;
                accelerate();
            }
            take_result();
        }
        publish();
        report.seconds = seconds_since(start);
        return report;
    }

    BounceReport step(std::span<const glm::vec3> direct) {
        const auto start = std::chrono::steady_clock::now();
        set_direct(direct);
        BounceReport report;
        if (sends_) {
            forget_steps();
            send();
            bounce(first_, size_);
            report.error = correct();
            report.num_bounces = 1;
            take_result();
        } else {
            std::fill(indirect_.begin(), indirect_.end(), PaddedRgb{});
        }
        publish();
        report.seconds = seconds_since(start);
        return report;
    }

    [[nodiscard]] std::span<const glm::vec3> indirect() const { return published_; }

private:
    struct Step {
        std::vector<PaddedRgb> change;
        std::vector<PaddedRgb> result;
    };
    /// Sums for each colour.
    using ColorSums = std::array<double, 3>;

    void forget_steps() {
        num_before_ = 0;
        last_step_ = 0.0;
        last_ratio_ = 0.0;
        for (Step& step : history_) {
            step.change.resize(size_);
            step.result.resize(size_);
        }
    }

    static double seconds_since(std::chrono::steady_clock::time_point start) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    void set_direct(std::span<const glm::vec3> direct) {
        if (direct.size() != size_)
            throw std::invalid_argument(fmt::format(
                "expected the direct light of {} receivers, got {}", size_, direct.size()));
        std::vector<PaddedRgb> sums((size_ + RowsPerTask - 1) / RowsPerTask);
        for_rows(0, size_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t place = begin; place < end; ++place) {
                direct_[place] = padded(direct[transfer_.order[place]]);
                for (std::size_t c = 0; c < 3; ++c)
                    sums[begin / RowsPerTask].rgb[c] += direct_[place].rgb[c];
            }
        });
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0.0;
            for (const PaddedRgb& part : sums)
                sum += static_cast<double>(part.rgb[c]);
            least_direct_[c] = static_cast<float>(LeastDirect * sum / static_cast<double>(size_));
        }
    }

    /// sent_ = rho (B + indirect_).
    void send() {
        for_rows(first_, size_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c)
                    sent_[i].rgb[c] = albedo_[i].rgb[c] * (direct_[i].rgb[c] + indirect_[i].rgb[c]);
        });
    }

    /// next_ = A sent_ for some rows.
    void bounce(std::size_t first, std::size_t last) {
        product_.multiply(sent_, first, last, next_);
    }

    /// Returns all further bounces of the change next_ - indirect_, as groups of receivers tell.
    std::span<const PaddedRgb> bounces_of_change() {
        if (!coarse_)
            coarse_.emplace(product_, albedo_);
        of_groups_.assign(coarse_->num_groups(), {});
        for_rows(first_, size_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t group = coarse_->group_of()[i - first_];
                for (std::size_t c = 0; c < 4; ++c)
                    of_groups_[group].rgb[c] +=
                        coarse_->shares()[group] * (next_[i].rgb[c] - indirect_[i].rgb[c]);
            }
        });
        return coarse_->sum_of_bounces(of_groups_);
    }

    /// Makes a step of next_: adds what the change next_ - indirect_ becomes in all further
    /// bounces, as the groups of receivers tell. Places without any light stay black, whatever
    /// group they are in. Returns the size of the step, relative to all light.
    double correct() {
        newest_ = (newest_ + 1) % history_.size();
        const std::span<const PaddedRgb> more = bounces_of_change();
        Step& now = newest();
        // Of each colour: products of the change with itself and with those before; what is waited
        // for of the change; all light.
        constexpr std::size_t WaitedFor = AndersonDepth + 1, AllLight = AndersonDepth + 2;
        constexpr std::size_t NumSums = AndersonDepth + 3;
        std::vector<std::array<ColorSums, NumSums>> parts((size_ - first_ + RowsPerTask - 1) /
                                                          RowsPerTask);
        for_rows(first_, size_, [&](std::size_t begin, std::size_t end) {
            std::array<PaddedRgb, NumSums> sums{};
            for (std::size_t i = begin; i < end; ++i) {
                const PaddedRgb& of_group = more[coarse_->group_of()[i - first_]];
                for (std::size_t c = 0; c < 4; ++c) {
                    const float plain = next_[i].rgb[c];
                    const float result = plain + (plain > 0.0f ? of_group.rgb[c] : 0.0f);
                    const float change = result - indirect_[i].rgb[c];
                    const float light = result + direct_[i].rgb[c];
                    now.result[i].rgb[c] = result;
                    now.change[i].rgb[c] = change;
                    sums[0].rgb[c] += change * change;
                    sums[AllLight].rgb[c] += light * light;
                    if (direct_[i].rgb[c] > least_direct_[c])
                        sums[WaitedFor].rgb[c] += change * change;
                }
                for (std::size_t age = 1; age <= num_before_; ++age)
                    for (std::size_t c = 0; c < 4; ++c)
                        sums[age].rgb[c] += now.change[i].rgb[c] * before(age).change[i].rgb[c];
            }
            for (std::size_t k = 0; k < NumSums; ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    parts[(begin - first_) / RowsPerTask][k][c] =
                        static_cast<double>(sums[k].rgb[c]);
        });
        std::array<ColorSums, NumSums> all{};
        for (const std::array<ColorSums, NumSums>& part : parts)
            for (std::size_t k = 0; k < NumSums; ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    all[k][c] += part[k][c];
        for (std::size_t age = 0; age <= num_before_; ++age)
            products_[newest_][index_before(age)] = products_[index_before(age)][newest_] =
                all[age];
        const auto sum_of = [](const ColorSums& sums) {
            return sums[0] + sums[1] + sums[2];
        };
        const double light = sum_of(all[AllLight]);
        const double change =
            std::max(sum_of(all[WaitedFor]), WeightWithout * WeightWithout * sum_of(all[0]));
        return light > 0.0 ? std::sqrt(change / light) : 0.0;
    }

    /// Estimates the error after a step: steps go on becoming smaller by the larger one of the last
    /// two ratios. After the first one the factor of the matrix itself is all that is known; light
    /// that never comes back has none.
    double error_after(double step) {
        double ratio = std::max(contraction_, LeastRatio);
        if (last_step_ > 0.0) {
            const double newest = step / last_step_;
            ratio = std::max(
                {last_ratio_, newest, std::clamp(contraction_, LeastRatio, LeastRatioOfRooms)});
            last_ratio_ = newest;
        }
        last_step_ = step;
        ratio = std::min(ratio, MaxContraction);
        return step * ratio / (1.0 - ratio);
    }

    /// Takes the next iterate: the newest result, corrected by the least squares of the last steps
    /// [Anderson 1965], for each channel by itself. Makes sent_ of it.
    void accelerate() {
        const Step& now = newest();
        std::array<PaddedRgb, AndersonDepth> factors = least_squares_of_changes();
        for_rows(first_, size_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                PaddedRgb value = now.result[i];
                for (std::size_t a = 0; a < num_before_; ++a)
                    for (std::size_t c = 0; c < 4; ++c)
                        value.rgb[c] -= factors[a].rgb[c] *
                                        (now.result[i].rgb[c] - before(a + 1).result[i].rgb[c]);
                indirect_[i] = value;
                for (std::size_t c = 0; c < 4; ++c)
                    sent_[i].rgb[c] = albedo_[i].rgb[c] * (direct_[i].rgb[c] + value.rgb[c]);
            }
        });
        num_before_ = std::min(num_before_ + 1, AndersonDepth);
    }

    /// Returns the factors of the differences to the steps before that make the change smallest.
    [[nodiscard]] std::array<PaddedRgb, AndersonDepth> least_squares_of_changes() const {
        std::array<PaddedRgb, AndersonDepth> factors{};
        for (std::size_t c = 0; c < 3; ++c) {
            // Products of changes, the newest first.
            const auto product = [&](std::size_t a, std::size_t b) {
                return products_[index_before(a)][index_before(b)][c];
            };
            AndersonMatrix matrix = AndersonMatrix::Zero();
            AndersonVector vector = AndersonVector::Zero();
            for (std::size_t a = 0; a < num_before_; ++a) {
                const auto row = static_cast<Eigen::Index>(a);
                vector[row] = product(0, 0) - product(0, a + 1);
                for (std::size_t b = 0; b < num_before_; ++b)
                    matrix(row, static_cast<Eigen::Index>(b)) = product(0, 0) - product(0, a + 1) -
                                                                product(0, b + 1) +
                                                                product(a + 1, b + 1);
            }
            const AndersonVector solution = least_squares(matrix, vector);
            for (std::size_t a = 0; a < num_before_; ++a)
                factors[a].rgb[c] = static_cast<float>(solution[static_cast<Eigen::Index>(a)]);
        }
        return factors;
    }

    [[nodiscard]] Step& newest() { return history_[newest_]; }
    /// The index of the step `age` before the newest.
    [[nodiscard]] std::size_t index_before(std::size_t age) const {
        return (newest_ + history_.size() - age) % history_.size();
    }
    [[nodiscard]] const Step& before(std::size_t age) const { return history_[index_before(age)]; }

    /// Ends the iteration with the newest step.
    void take_result() {
        indirect_.swap(newest().result);
        if (first_ > 0) {
            send();
            light_the_rest();
        }
    }

    /// Receivers that send nothing on get their light once: of the light that was sent last.
    void light_the_rest() {
        bounce(0, first_);
        std::copy_n(next_.begin(), first_, indirect_.begin());
    }

    void publish() {
        for_rows(0, size_, [&](std::size_t begin, std::size_t end) {
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
    BounceProduct product_;
    /// Receivers before this place send nothing to others.
    std::size_t first_;
    /// Whether any receiver sends light to another.
    bool sends_ = false;
    /// Upper bound of the factor from one bounce to the next, after many.
    double contraction_ = 0.0;
    /// Of the albedo, once it is needed: a number of bounces asks for none.
    std::optional<CoarseBounces> coarse_;
    std::vector<PaddedRgb> of_groups_;
    /// Of each colour; receivers with more direct light are waited for.
    std::array<float, 4> least_direct_{};
    /// All by place.
    std::vector<PaddedRgb> albedo_;
    std::vector<PaddedRgb> direct_;
    std::vector<PaddedRgb> sent_;
    std::vector<PaddedRgb> indirect_;
    std::vector<PaddedRgb> next_;
    std::array<Step, AndersonDepth + 1> history_;
    /// Of the changes of two steps in history_.
    std::array<std::array<ColorSums, AndersonDepth + 1>, AndersonDepth + 1> products_{};
    std::size_t newest_ = 0;
    /// Steps before the newest that count.
    std::size_t num_before_ = 0;
    /// Relative to all light; of this iteration.
    double last_step_ = 0.0;
    double last_ratio_ = 0.0;
    /// [num_receivers] in the receivers' order.
    std::vector<glm::vec3> published_;
};

BounceLight::BounceLight(const prt::BounceMatrix& matrix, const prt::Transfer& transfer,
                         const SharedRows& shared)
    : impl_(std::make_unique<Impl>(matrix, transfer, shared)) {}
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
