#include "run.h"

#include <chrono>
#include <thread>

namespace relumine::python {

namespace {

/// Threads that have not ended.
struct Running {
    std::mutex mutex;
    std::condition_variable changed;
    int count = 0;

    void add(int difference) {
        const std::lock_guard lock(mutex);
        count += difference;
        changed.notify_all();
    }
};

Running& running() {
    static Running jobs;
    return jobs;
}

} // namespace

bool Job::wait_for(std::unique_lock<std::mutex>& lock, int milliseconds) {
    return changed_.wait_for(lock, std::chrono::milliseconds(milliseconds),
                             [this] { return is_done_; });
}

void Job::run(const std::shared_ptr<Job>& job, const py::object& progress) {
    constexpr int PollMilliseconds = 25;
    constexpr int StopMilliseconds = 50;
    running().add(1);
    try {
        std::thread([held = job]() mutable {
            std::exception_ptr error;
            try {
                Job& own = *held;
                own.work({.stop = own.stop_.get_token(), .on_progress = [&own](double fraction) {
                              own.fraction_ = fraction;
                          }});
            } catch (...) {
                error = std::current_exception();
            }
            {
                const std::lock_guard lock(held->mutex_);
                held->error_ = std::move(error);
                held->is_done_ = true;
                held->changed_.notify_all();
            }
            held.reset();
            running().add(-1);
        }).detach();
    } catch (...) {
        running().add(-1);
        throw;
    }

    double told = 0.0;
    for (bool is_done = false; !is_done;) {
        {
            const Release release;
            std::unique_lock lock(job->mutex_);
            is_done = job->wait_for(lock, PollMilliseconds);
        }
        try {
            if (PyErr_CheckSignals() != 0)
                throw py::error_already_set();
            const double fraction = job->fraction_;
            if (!is_done && !progress.is_none() && fraction > told)
                progress(told = fraction);
        } catch (py::error_already_set&) {
            job->stop_.request_stop();
            const Release release;
            std::unique_lock lock(job->mutex_);
            (void)job->wait_for(lock, StopMilliseconds);
            throw;
        }
    }
    if (job->error_)
        std::rethrow_exception(job->error_);
    if (!progress.is_none())
        progress(1.0);
}

void bind_run(py::module_& module) {
    module.def("wait_for_jobs", [] {
        const Release release;
        std::unique_lock lock(running().mutex);
        running().changed.wait(lock, [] { return running().count == 0; });
    });
}

} // namespace relumine::python
