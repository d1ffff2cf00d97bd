// What travels with long work: its processes, its checkpoint, the wish to stop, its progress. And
// how it may end early.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>

#include "prt/checkpoint.h"
#include "prt/team.h"

namespace relumine::prt {

/// Thrown by long work when its stop token asks for the end.
struct Cancelled : std::exception {
    [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }
};

/// Thrown by long work whose result takes more memory than it may, or would in the end. It leaves a
/// checkpoint.
struct TooLarge : std::runtime_error {
    /// `what` are counted: "clusters".
    TooLarge(const std::string& what, std::uint64_t number, std::uint64_t size);
    /// Lower bounds.
    std::uint64_t count;
    std::uint64_t bytes;
};

/// The handle of all long work. Changes nothing in a result.
struct Work {
    /// Processes that share the work: each has its part of the receivers, and what they decide
    /// follows from figures of all. When one is asked to stop, all end.
    Team& team = alone();
    /// Stores the work now and then, and gives back the work of an earlier run; may be null.
    Checkpoint* checkpoint = nullptr;
    /// Other work follows: a last checkpoint is left when this one is done.
    bool more_follows = false;
    /// Polled a few times a second or more often.
    std::stop_token stop = {};
    /// Receives an estimate of the fraction done, in [0, 1], which never falls; one call at a time.
    std::function<void(double)> on_progress = {};
    /// For tests: work between two looks at the checkpoint, in samples of clusters or in blocks of
    /// receivers.
    std::optional<std::uint64_t> step_size = {};

    /// The wish to stop as a process may obey it within a step. One that shares the work goes on to
    /// the end of the step, where the others wait for it.
    [[nodiscard]] std::stop_token stop_in_step() const {
        return team.has_others() ? std::stop_token() : stop;
    }
    /// Throws:  Cancelled when the work must stop.
    void poll() const {
        if (stop.stop_requested())
            throw Cancelled();
    }
    /// Says that a fraction is done.
    void tell(double fraction) const {
        if (on_progress)
            on_progress(fraction);
    }
    /// Returns the handle of a part of this work, for processes that have all of it.
    [[nodiscard]] Work part(double begin, double share) const {
        Work result{.team = team, .stop = stop};
        if (on_progress)
            result.on_progress = [told = on_progress, begin, share](double fraction) {
                told(begin + share * fraction);
            };
        return result;
    }

    /// Whether there is anything to look at between steps.
    [[nodiscard]] bool has_steps() const { return checkpoint != nullptr || team.has_others(); }
};

/// Returns the largest value of all processes.
[[nodiscard]] std::uint64_t largest_of_all(Team& team, std::uint64_t value);

} // namespace relumine::prt
