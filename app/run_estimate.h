// How long a run of several stages takes: an estimate from what each stage takes of other runs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace relumine::app {

/// Estimates the seconds that are left of stages that follow each other.
///
/// A stage that is done counts what it took; the present one goes on as fast as it did, but for its
/// beginning, of which little is known; later ones take their share at the pace of those before.
class RunEstimate {
public:
    struct Stage {
        std::string name;
        /// How much of a run it takes, in any unit that all stages share
        double share = 0.0;
    };

    explicit RunEstimate(std::vector<Stage> stages) : stages_(std::move(stages)) {}

    /// The number of a stage; none of another name.
    [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const {
        for (std::size_t i = 0; i < stages_.size(); ++i)
            if (stages_[i].name == name)
                return i;
        return std::nullopt;
    }

    /// Says how much of a stage is done, `seconds` after the run began. Stages before it are done;
    /// those that said nothing were not needed. What is told of a stage before the present one is
    /// left out.
    void tell(std::size_t stage, double fraction, double seconds) {
        if (stage < present_)
            return;
        if (!is_told_ || stage != present_) {
            if (is_told_)
                share_done_ += stages_[present_].share;
            is_told_ = true;
            present_ = stage;
            begin_ = last_;
            part_ = 0.0;
        }
        part_ = std::clamp(fraction, part_, 1.0);
        last_ = seconds;
    }

    /// Returns the seconds that are left; none before anything is known.
    [[nodiscard]] std::optional<double> seconds_left(double seconds) const {
        if (!is_told_)
            return std::nullopt;
        const double share = stages_[present_].share, own = seconds - begin_;
        const double known = share_done_ + part_ * share;
        if (!(known > 0.0))
            return std::nullopt;
        const double pace = seconds / known;
        double later = 0.0;
        for (std::size_t i = present_ + 1; i < stages_.size(); ++i)
            later += stages_[i].share;
        return (1.0 - part_) * (own + (1.0 - part_) * pace * share) + pace * later;
    }

    /// Returns the part of the run that is done. It never falls.
    [[nodiscard]] double fraction(double seconds) {
        if (const std::optional<double> left = seconds_left(seconds); left && seconds > 0.0)
            largest_ = std::max(largest_, seconds / (seconds + *left));
        return largest_;
    }

    /// The name of the present stage; empty before the first.
    [[nodiscard]] std::string present() const {
        return is_told_ ? stages_[present_].name : std::string();
    }

private:
    std::vector<Stage> stages_;
    std::size_t present_ = 0;
    bool is_told_ = false;
    /// The shares of the stages before the present one that were told of, summed
    double share_done_ = 0.0;
    /// When the present stage began: with the last word of the one before.
    double begin_ = 0.0, last_ = 0.0;
    double part_ = 0.0;
    double largest_ = 0.0;
};

} // namespace relumine::app
