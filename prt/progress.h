// How far long work is, and whether it must stop.
#pragma once

#include <functional>
#include <mutex>
#include <stop_token>

#include "prt/work.h"

namespace relumine::prt {

/// Turns the progress of stages into one fraction that never falls.
///
/// Threads: any thread may call any function but start_stage().
class Progress {
public:
    explicit Progress(const Work& work)
        : stop_(work.stop_in_step()), on_progress_(work.on_progress) {}

    /// Begins the next stage, which takes the work from `begin` to `end` by the estimate of now.
    /// Where an earlier stage thought that more was done, what is left of the scale is shared out
    /// over the work that is left: the fraction goes on slowly and does not wait.
    void start_stage(double begin, double end);
    /// Says that the fraction `part` of the stage is done.
    ///
    /// Throws:  Cancelled when the work must stop.
    void report(double part);
    /// Checks the stop token.
    ///
    /// Throws:  Cancelled when the work must stop.
    void poll() const;

private:
    std::stop_token stop_;
    std::function<void(double)> on_progress_;
    double begin_ = 0.0;
    double end_ = 0.0;
    double last_ = 0.0;
    std::mutex mutex_;
};

} // namespace relumine::prt
