// How far long work is, and whether it is to stop.
#pragma once

#include <functional>
#include <mutex>
#include <stop_token>
#include <utility>

namespace relumine::prt {

/// Turns parts of stages into one fraction that never falls. All calls but start_stage() may come
/// from any thread.
class Progress {
public:
    /// Either argument may be empty.
    Progress(std::stop_token stop, std::function<void(double)> on_progress)
        : stop_(std::move(stop)), on_progress_(std::move(on_progress)) {}

    /// The next stage takes the scale from `begin` to `end`.
    void start_stage(double begin, double end) {
        begin_ = begin;
        end_ = end;
    }
    /// `part` of the stage is done. Ends the work by an exception when asked to.
    void report(double part);
    /// Throws Cancelled when the work is to stop.
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
