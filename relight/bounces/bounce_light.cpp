#include "relight/bounces/bounce_light.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <Eigen/Core>
#include <Eigen/QR>
#include <fmt/format.h>
#include <glm/common.hpp>

#include "files/seconds.h"
#include "relight/bounces/bounce_product.h"
#include "relight/bounces/coarse_bounces.h"
#include "relight/bounces/point_gather.h"

namespace relumine::relight {

namespace {

/// Earlier steps that an accelerated one is combined with. Most scenes need fewer.
constexpr std::size_t AndersonDepth = 9;

/// More products than any scene needs whose light does not grow for ever.
constexpr std::uint32_t MaxBounces = 1000;

/// Steps are assumed to shrink by no more than this, whatever the last ones did.
constexpr double LeastRatio = 0.5;

/// Returns the weights, with the sum 1, of changes whose sum is smallest, from the products of each
/// with each. Changes that depend on others share their weights.
Eigen::VectorXd weights_of(const Eigen::MatrixXd& products) {
    constexpr double SmallestPivot = 1e-9;
    const Eigen::Index size = products.rows(), last = size - 1;
    // Unknown are the weights of all but the last, of differences to the last.
    Eigen::MatrixXd matrix(last, last);
    Eigen::VectorXd right(last), scale(last);
    for (Eigen::Index a = 0; a < last; ++a) {
        right[a] = products(last, last) - products(last, a);
        for (Eigen::Index b = 0; b < last; ++b)
            matrix(a, b) = right[a] - products(last, b) + products(a, b);
        scale[a] = matrix(a, a) > 0.0 ? 1.0 / std::sqrt(matrix(a, a)) : 0.0;
    }
    if (last == 0)
        return Eigen::VectorXd::Ones(1);
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> equations;
    equations.setThreshold(SmallestPivot);
    equations.compute(scale.asDiagonal() * matrix * scale.asDiagonal());
    Eigen::VectorXd weights(size);
    weights.head(last) = scale.asDiagonal() * equations.solve(scale.asDiagonal() * right);
    weights[last] = 1.0 - weights.head(last).sum();
    return weights;
}

} // namespace

class BounceLight::Impl {
public:
    Impl(const prt::BounceMatrix& matrix, const prt::Transfer& transfer, const SharedRows& shared)
        : matrix_(matrix), transfer_(transfer), size_(transfer.num_receivers()),
          product_(matrix, size_, shared), first_(product_.first()),
          basis_of_points_(matrix.points), albedo_(size_), direct_(size_), sent_(size_),
          indirect_(size_), next_(size_), published_(size_, glm::vec3(0.0f)) {}

    void set_albedo(std::span<const glm::vec3> albedo, std::span<const PassedOn> passed_on) {
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
        for (std::size_t place = 0; place < size_; ++place)
            albedo_[place] = padded(glm::min(albedo[transfer_.order[place]], glm::vec3(safe)));
        passed_on_.clear();
        const std::vector<std::uint32_t> places =
            passed_on.empty() ? std::vector<std::uint32_t>() : places_of(transfer_.order);
        for (const PassedOn& own : passed_on) {
            PaddedRgb& reflected = albedo_[places[own.receiver]];
            Passed passed{places[own.receiver], places[own.other], padded(own.part)};
            for (std::size_t c = 0; c < 3; ++c) {
                const float sum = reflected.rgb[c] + passed.part.rgb[c];
                if (sum > safe) {
                    reflected.rgb[c] *= safe / sum;
                    passed.part.rgb[c] *= safe / sum;
                }
                largest = std::max(largest, std::min(sum, safe));
            }
            passed_on_.push_back(passed);
        }
        contraction_ = static_cast<double>(largest) * static_cast<double>(matrix_.spectral_radius);
        sends_ = largest > 0.0f && product_.has_emitters();
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
            do {
                send();
                bounce(first_, size_);
                ++report.num_bounces;
                correct();
                report.error = error_after(combine());
            } while (report.error > limits.tolerance && report.num_bounces < MaxBounces);
            take_result();
        }
        if (has_points() && !(sends_ && limits.num_bounces))
            send();
        publish(limits.num_bounces != 0u);
        report.seconds = files::seconds_since(start);
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
            correct();
            report.error = combine();
            report.num_bounces = 1;
            take_result();
        } else {
            std::fill(indirect_.begin(), indirect_.end(), PaddedRgb{});
        }
        if (has_points())
            send();
        publish(true);
        report.seconds = files::seconds_since(start);
        return report;
    }

    [[nodiscard]] std::span<const glm::vec3> indirect() const { return published_; }

    [[nodiscard]] std::vector<glm::vec3> point_harmonics(std::uint32_t order) const {
        if (!reaches_points_)
            return std::vector<glm::vec3>(matrix_.points.num_points() * num_harmonics(order));
        return basis_of_points_.gathered(sent_, order);
    }

private:
    struct Step {
        std::vector<PaddedRgb> change;
        std::vector<PaddedRgb> result;
    };
    /// PassedOn by places.
    struct Passed {
        std::uint32_t place, other;
        PaddedRgb part;
    };
    /// Sums for each colour.
    using ColorSums = std::array<double, 3>;

    void forget_steps() {
        num_steps_ = 0;
        last_step_ = 0.0;
        last_ratio_ = 0.0;
    }

    void set_direct(std::span<const glm::vec3> direct) {
        if (direct.size() != size_)
            throw std::invalid_argument(fmt::format(
                "expected the direct light of {} receivers, got {}", size_, direct.size()));
        for_rows(0, size_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t place = begin; place < end; ++place)
                direct_[place] = padded(direct[transfer_.order[place]]);
        });
    }

    /// sent_ = rho (B + indirect_), of all that send to others, points included.
    void send() {
        for_rows(std::min(first_, has_points() ? transfer_.num_points : size_), size_,
                 [&](std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; ++i)
                         for (std::size_t c = 0; c < 4; ++c)
                             sent_[i].rgb[c] =
                                 albedo_[i].rgb[c] * (direct_[i].rgb[c] + indirect_[i].rgb[c]);
                 });
        for (const Passed& own : passed_on_)
            for (std::size_t c = 0; c < 4; ++c)
                sent_[own.place].rgb[c] +=
                    own.part.rgb[c] * (direct_[own.other].rgb[c] + indirect_[own.other].rgb[c]);
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
    /// group they are in.
    void correct() {
        const std::span<const PaddedRgb> more = bounces_of_change();
        newest_ = num_steps_++ % (AndersonDepth + 1);
        if (newest_ == steps_.size())
            steps_.push_back({std::vector<PaddedRgb>(size_), std::vector<PaddedRgb>(size_)});
        Step& now = steps_[newest_];
        // Of each colour: products of the change with itself and with those before; all light.
        constexpr std::size_t AllLight = AndersonDepth + 1, NumSums = AndersonDepth + 2;
        std::vector<std::array<ColorSums, NumSums>> parts((size_ - first_ + RowsPerTask - 1) /
                                                          RowsPerTask);
        for_rows(first_, size_, [&](std::size_t begin, std::size_t end) {
            std::array<PaddedRgb, NumSums> sums{};
            for (std::size_t i = begin; i < end; ++i) {
                const PaddedRgb& of_group = more[coarse_->group_of()[i - first_]];
                for (std::size_t c = 0; c < 4; ++c) {
                    const float plain = next_[i].rgb[c];
                    const float result = plain + (plain != 0.0f ? of_group.rgb[c] : 0.0f);
                    const float light = result + direct_[i].rgb[c];
                    now.result[i].rgb[c] = result;
                    now.change[i].rgb[c] = result - indirect_[i].rgb[c];
                    sums[AllLight].rgb[c] += light * light;
                }
                for (std::size_t k = 0; k < num_kept(); ++k)
                    for (std::size_t c = 0; c < 4; ++c)
                        sums[k].rgb[c] += now.change[i].rgb[c] * steps_[k].change[i].rgb[c];
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
        for (std::size_t k = 0; k < num_kept(); ++k)
            products_[newest_][k] = products_[k][newest_] = all[k];
        all_light_ = all[AllLight][0] + all[AllLight][1] + all[AllLight][2];
    }

    /// Sets indirect_ to the sum of the last results whose changes add up to the smallest one
    /// [Anderson 1965], for each channel by itself. Returns the size of that change, relative to
    /// all light.
    double combine() {
        std::array<PaddedRgb, AndersonDepth + 1> factors{};
        double change = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto size = static_cast<Eigen::Index>(num_kept());
            Eigen::MatrixXd products(size, size);
            for (Eigen::Index a = 0; a < size; ++a)
                for (Eigen::Index b = 0; b < size; ++b)
                    products(a, b) = products_[kept(a)][kept(b)][c];
            const Eigen::VectorXd weights = weights_of(products);
            for (Eigen::Index a = 0; a < size; ++a)
                factors[kept(a)].rgb[c] = static_cast<float>(weights[a]);
            change += std::max(weights.dot(products * weights), 0.0);
        }
        for_rows(first_, size_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                indirect_[i] = {};
                for (std::size_t k = 0; k < num_kept(); ++k)
                    for (std::size_t c = 0; c < 4; ++c)
                        indirect_[i].rgb[c] += factors[k].rgb[c] * steps_[k].result[i].rgb[c];
            }
        });
        return all_light_ > 0.0 ? std::sqrt(change / all_light_) : 0.0;
    }

    /// How many of steps_ are of this iteration.
    [[nodiscard]] std::size_t num_kept() const { return std::min(num_steps_, AndersonDepth + 1); }
    /// The index of each, the newest last.
    [[nodiscard]] std::size_t kept(Eigen::Index i) const {
        return (newest_ + 1 + static_cast<std::size_t>(i)) % num_kept();
    }

    /// Estimates the error after a step: steps go on becoming smaller by the larger one of the last
    /// two ratios. After the first one the factor of the matrix itself is all that is known; light
    /// that never comes back has none.
    double error_after(double step) {
        double ratio = std::max(contraction_, LeastRatio);
        if (num_steps_ > 1) {
            const double newest = last_step_ > 0.0 ? step / last_step_ : 0.0;
            ratio = std::max({last_ratio_, newest, LeastRatio});
            last_ratio_ = newest;
        }
        last_step_ = step;
        ratio = std::min(ratio, MaxContraction);
        return step * ratio / (1.0 - ratio);
    }

    /// Ends the iteration.
    void take_result() {
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

    [[nodiscard]] bool has_points() const { return matrix_.points.num_directions != 0; }

    /// Whether any light `reaches_points`, they get what was sent last.
    void publish(bool reaches_points) {
        for_rows(0, size_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t place = begin; place < end; ++place) {
                const PaddedRgb& value = indirect_[place];
                // Corrections may go too far by the tolerance.
                published_[transfer_.order[place]] = {std::max(value.rgb[0], 0.0f),
                                                      std::max(value.rgb[1], 0.0f),
                                                      std::max(value.rgb[2], 0.0f)};
            }
        });
        reaches_points_ = reaches_points;
        if (!has_points())
            return;
        const std::vector<glm::vec3> first = point_harmonics(1);
        for (std::size_t place = 0; place < first.size(); ++place)
            published_[transfer_.order[place]] = mean_radiance(first[place]);
    }

    /// Keeps the estimate of the error finite.
    static constexpr double MaxContraction = 0.999;

    const prt::BounceMatrix& matrix_;
    const prt::Transfer& transfer_;
    std::size_t size_;
    BounceProduct product_;
    /// Receivers before this place send nothing to others.
    std::size_t first_;
    PointBasis basis_of_points_;
    /// Whether any receiver sends light to another.
    bool sends_ = false;
    /// Upper bound of the factor from one bounce to the next, after many.
    double contraction_ = 0.0;
    /// The bounces between groups of receivers for the albedo, once they are needed: a number of
    /// bounces asks for none.
    std::optional<CoarseBounces> coarse_;
    std::vector<PaddedRgb> of_groups_;
    std::vector<Passed> passed_on_;
    /// All by place.
    std::vector<PaddedRgb> albedo_;
    std::vector<PaddedRgb> direct_;
    std::vector<PaddedRgb> sent_;
    std::vector<PaddedRgb> indirect_;
    std::vector<PaddedRgb> next_;
    /// Made as they are needed; those of this iteration come first.
    std::vector<Step> steps_;
    std::size_t newest_ = 0;
    /// Steps of this iteration, also those that are no longer kept.
    std::size_t num_steps_ = 0;
    /// Products of the changes of two steps, by their places in steps_.
    std::array<std::array<ColorSums, AndersonDepth + 1>, AndersonDepth + 1> products_{};
    /// The sum of squares.
    double all_light_ = 0.0;
    /// Relative to all light; of this iteration.
    double last_step_ = 0.0;
    double last_ratio_ = 0.0;
    /// [num_receivers] in the receivers' order.
    std::vector<glm::vec3> published_;
    /// Whether what was sent last, if there are points, reaches them.
    bool reaches_points_ = false;
};

BounceLight::BounceLight(const prt::BounceMatrix& matrix, const prt::Transfer& transfer,
                         const SharedRows& shared)
    : impl_(std::make_unique<Impl>(matrix, transfer, shared)) {}
BounceLight::~BounceLight() = default;
BounceLight::BounceLight(BounceLight&&) noexcept = default;
BounceLight& BounceLight::operator=(BounceLight&&) noexcept = default;

void BounceLight::set_albedo(std::span<const glm::vec3> albedo,
                             std::span<const PassedOn> passed_on) {
    impl_->set_albedo(albedo, passed_on);
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
std::vector<glm::vec3> BounceLight::point_harmonics(std::uint32_t order) const {
    return impl_->point_harmonics(order);
}

} // namespace relumine::relight
