// Calls that take time, without Python's lock.
//
// Work of milliseconds runs in the calling thread (Release). Longer work runs in a thread of its
// own, while the calling thread looks for signals and tells the progress: so Python code is called
// only where it called, and Ctrl-C is answered within a tenth of a second whatever the work does.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <type_traits>
#include <utility>

#include <pybind11/pybind11.h>

#include "relumine/in/precompute_options.h"

namespace relumine::python {

namespace py = pybind11;
using Release = py::gil_scoped_release;

/// What work polls and tells.
using Reins = prt::Work;

/// Work in a thread of its own.
class Job {
public:
    Job() = default;
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;
    virtual ~Job() = default;

    /// Runs a job and waits for its end. `progress` is None, or is called with a fraction in [0, 1]
    /// that never falls, and with 1 at the end.
    ///
    /// Throws:  what the work throws; KeyboardInterrupt, or what `progress` raises. The work is
    ///          then asked to stop. Where it does not at once, it ends in the background, and its
    ///          result is dropped.
    static void run(const std::shared_ptr<Job>& job, const py::object& progress);

private:
    virtual void work(const Reins& reins) = 0;
    bool wait_for(std::unique_lock<std::mutex>& lock, int milliseconds);

    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_done_ = false;
    std::exception_ptr error_;
    std::atomic<double> fraction_ = 0.0;
    std::stop_source stop_;
};

/// Returns `work(reins)`, run as a Job. The work must own all that it uses, and no Python objects.
template<typename Work>
auto in_background(const py::object& progress, Work work) {
    using Result = std::invoke_result_t<Work&, const Reins&>;
    struct Typed final : Job {
        explicit Typed(Work&& given) : work_of(std::move(given)) {}
        void work(const Reins& reins) override { result.emplace(work_of(reins)); }
        Work work_of;
        std::optional<Result> result;
    };
    auto job = std::make_shared<Typed>(std::move(work));
    Job::run(job, progress);
    return std::move(*job->result);
}

/// Waits for jobs that were left behind, before the process ends.
void bind_run(py::module_& module);

} // namespace relumine::python
