#include "relight/bounces/bounce_light.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <fmt/format.h>

#include "files/parallel.h"
#include "relight/bounces/bounce_kernel.h"
#include "relight/bounces/coarse_bounces.h"

namespace relumine::relight {

namespace {

/// Differences of earlier iterates that an accelerated step combines.
constexpr std::size_t AndersonDepth = 2;

/// More products than any scene needs whose light does not grow for ever.
constexpr std::uint32_t MaxBounces = 1000;

/// Rows that one task handles; sums over them are added in order, so that threads do not matter.
constexpr std::size_t RowsPerTask = prt::RowsPerRun;

/// Steps are assumed to shrink by no more than this, whatever the last ones did: light in narrow
/// gaps is found late. The light that is left is then at least as large as the last step.
constexpr double LeastRatio = 0.5;

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
        : matrix_(matrix), transfer_(transfer), shared_(shared), size_(transfer.num_receivers()),
          first_(checked(matrix, shared, size_)), coarse_(matrix, first_, shared),
          coarse_sent_(coarse_.num_groups()), albedo_(size_), direct_(size_), sent_(size_),
          gathered_(size_), indirect_(size_), next_(size_), published_(size_, glm::vec3(0.0f)) {}

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
        const float safe = largest_safe_albedo();
        if (largest > safe)
            throw std::invalid_argument(
                fmt::format("expected an albedo up to {:.4g}, beyond which bounces grow for ever, "
                            "got {}",
                            safe, largest));
        contraction_ = static_cast<double>(largest) * static_cast<double>(matrix_.spectral_radius);
        sends_ = largest > 0.0f && has_emitters();
        for (std::size_t place = 0; place < size_; ++place)
            albedo_[place] = padded(albedo[transfer_.order[place]]);
        coarse_.set_albedo(std::span(albedo_).subspan(first_));
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
            start_from_groups();
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

    [[nodiscard]] bool has_emitters() const {
        if (shared_.team == nullptr)
            return !matrix_.emitters.places.empty();
        return std::any_of(shared_.num_emitters.begin(), shared_.num_emitters.end(),
                           [](std::uint32_t number) { return number != 0; });
    }

    static std::size_t checked(const prt::BounceMatrix& matrix, const SharedRows& shared,
                               std::size_t size) {
        if (matrix.num_rows() != size)
            throw std::invalid_argument(
                fmt::format("expected bounces of {} receivers, got {}", size, matrix.num_rows()));
        return shared.team != nullptr ? shared.first : prt::first_emitter(matrix);
    }

    void forget_steps() {
        num_before_ = 0;
        last_step_ = 0.0;
        largest_ratio_ = 0.0;
        for (Step& step : history_) {
            step.change.resize(size_);
            step.result.resize(size_);
        }
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
        for_rows(0, size_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t place = begin; place < end; ++place)
                direct_[place] = padded(direct[transfer_.order[place]]);
        });
    }

    /// Tasks begin at whole groups.
    template<typename Function>
    static void for_rows(std::size_t first, std::size_t last, const Function& function) {
        files::parallel_for(std::size_t{0}, (last - first + RowsPerTask - 1) / RowsPerTask,
                            [&](std::size_t task) {
                                const std::size_t begin = first + task * RowsPerTask;
                                function(begin, std::min(last, begin + RowsPerTask));
                            });
    }

    /// Calls function(row, group) for the rows begin .. end - 1.
    template<typename Function>
    void for_rows_in_groups(std::size_t begin, std::size_t end, const Function& function) const {
        const std::size_t group_size = coarse_.group_size();
        for (std::size_t group = (begin - first_) / group_size; begin < end; ++group) {
            const std::size_t end_of_group = std::min(end, first_ + (group + 1) * group_size);
            for (; begin < end_of_group; ++begin)
                function(begin, group);
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
        for_rows(first, last, [&](std::size_t begin, std::size_t end) {
            if (is_own(begin))
                sum_lists(matrix_.emitters, sent_, begin, end, gathered_);
        });
        share_gathered(first, last);
        for_rows(first, last, [&](std::size_t begin, std::size_t end) {
            sum_lists(matrix_.averaged, gathered_, begin, end, next_);
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c)
                    next_[i].rgb[c] *= matrix_.weights[i];
        });
    }

    /// Whether this process has the run of rows that begins there.
    [[nodiscard]] bool is_own(std::size_t begin) const {
        return shared_.team == nullptr || prt::has_row(shared_.team->part(), begin, first_);
    }

    /// Gives all processes what each has gathered for its rows.
    void share_gathered(std::size_t first, std::size_t last) {
        if (shared_.team == nullptr)
            return;
        const prt::Part part = shared_.team->part();
        const auto for_runs = [&](std::uint32_t process, const auto& visit) {
            for (std::size_t begin = first; begin < last; begin += RowsPerTask)
                if (prt::has_row({process, part.count}, begin, first_))
                    visit(std::span(gathered_).subspan(begin, std::min(RowsPerTask, last - begin)));
        };
        std::vector<PaddedRgb> own;
        for_runs(part.index, [&](std::span<const PaddedRgb> run) {
            own.insert(own.end(), run.begin(), run.end());
        });
        const auto bytes = std::as_bytes(std::span(own));
        const auto of_all = shared_.team->all_gather({bytes.begin(), bytes.end()});
        for (std::uint32_t process = 0; process < of_all.size(); ++process) {
            std::size_t at = 0;
            for_runs(process, [&](std::span<PaddedRgb> run) {
                if (of_all[process].size() < at + run.size_bytes())
                    throw std::runtime_error("expected the bounces of all processes");
                std::memcpy(run.data(), of_all[process].data() + at, run.size_bytes());
                at += run.size_bytes();
            });
        }
    }

    /// Returns all bounces of what sent_by(row) gives for each row, as groups of receivers tell.
    template<typename SentBy>
    std::span<const PaddedRgb> bounces_of_groups(const SentBy& sent_by) {
        for_rows(first_, size_, [&](std::size_t begin, std::size_t end) {
            const std::size_t group_size = coarse_.group_size();
            for (std::size_t i = begin; i < end;) {
                const std::size_t group = (i - first_) / group_size;
                const std::size_t end_of_group = std::min(end, i + group_size);
                const auto size = static_cast<float>(end_of_group - i);
                PaddedRgb sum;
                for (; i < end_of_group; ++i) {
                    const PaddedRgb sent = sent_by(i);
                    for (std::size_t c = 0; c < 4; ++c)
                        sum.rgb[c] += sent.rgb[c];
                }
                for (std::size_t c = 0; c < 4; ++c)
                    coarse_sent_[group].rgb[c] = sum.rgb[c] / size;
            }
        });
        return coarse_.sum_of_bounces(coarse_sent_);
    }

    /// The first guess: the bounces between the groups of receivers.
    void start_from_groups() {
        send();
        const std::span<const PaddedRgb> all =
            bounces_of_groups([this](std::size_t i) { return sent_[i]; });
        for_rows(first_, size_, [&](std::size_t begin, std::size_t end) {
            for_rows_in_groups(begin, end, [&](std::size_t i, std::size_t group) {
                for (std::size_t c = 0; c < 4; ++c) {
                    indirect_[i].rgb[c] = matrix_.weights[i] > 0.0f ? all[group].rgb[c] : 0.0f;
                    sent_[i].rgb[c] = albedo_[i].rgb[c] * (direct_[i].rgb[c] + indirect_[i].rgb[c]);
                }
            });
        });
    }

    /// Makes a step of next_: adds what the change next_ - indirect_ becomes in all further
    /// bounces, as the groups of receivers tell. Places without any light stay black, whatever
    /// group they are in. Returns the size of the step, relative to all light.
    double correct() {
        newest_ = (newest_ + 1) % history_.size();
        const std::span<const PaddedRgb> more = bounces_of_groups([this](std::size_t i) {
            PaddedRgb sent;
            for (std::size_t c = 0; c < 4; ++c)
                sent.rgb[c] = albedo_[i].rgb[c] * (next_[i].rgb[c] - indirect_[i].rgb[c]);
            return sent;
        });
        Step& now = newest();
        // Of each colour: products of the change with itself and with those before; all light.
        constexpr std::size_t NumSums = AndersonDepth + 2;
        std::vector<std::array<ColorSums, NumSums>> parts((size_ - first_ + RowsPerTask - 1) /
                                                          RowsPerTask);
        for_rows(first_, size_, [&](std::size_t begin, std::size_t end) {
            std::array<PaddedRgb, NumSums> sums{};
            for_rows_in_groups(begin, end, [&](std::size_t i, std::size_t group) {
                for (std::size_t c = 0; c < 4; ++c) {
                    const float plain = next_[i].rgb[c];
                    const float result = plain + (plain > 0.0f ? more[group].rgb[c] : 0.0f);
                    const float change = result - indirect_[i].rgb[c];
                    const float light = result + direct_[i].rgb[c];
                    now.result[i].rgb[c] = result;
                    now.change[i].rgb[c] = change;
                    sums[AndersonDepth + 1].rgb[c] += light * light;
                    sums[0].rgb[c] += change * change;
                }
                for (std::size_t age = 1; age <= num_before_; ++age)
                    for (std::size_t c = 0; c < 4; ++c)
                        sums[age].rgb[c] += now.change[i].rgb[c] * before(age).change[i].rgb[c];
            });
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
        const double light = sum_of(all[AndersonDepth + 1]);
        return light > 0.0 ? std::sqrt(sum_of(all[0]) / light) : 0.0;
    }

    /// Estimates the error after a step: steps become smaller by the largest ratio that was seen.
    /// After the first one the factor of the matrix itself is all that is known; light that never
    /// comes back has none.
    double error_after(double step) {
        double ratio = std::max(contraction_, LeastRatio);
        if (last_step_ > 0.0) {
            largest_ratio_ = std::max({largest_ratio_, step / last_step_, LeastRatio});
            ratio = largest_ratio_;
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
    SharedRows shared_;
    std::size_t size_;
    /// Receivers before this place send nothing to others.
    std::size_t first_;
    /// Whether any receiver sends light to another.
    bool sends_ = false;
    /// Upper bound of the factor from one bounce to the next, after many.
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
    /// Of the changes of two steps in history_.
    std::array<std::array<ColorSums, AndersonDepth + 1>, AndersonDepth + 1> products_{};
    std::size_t newest_ = 0;
    /// Steps before the newest that count.
    std::size_t num_before_ = 0;
    /// Relative to all light; of this iteration.
    double last_step_ = 0.0;
    double largest_ratio_ = 0.0;
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
