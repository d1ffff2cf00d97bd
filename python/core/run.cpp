#include "run.h"

#include <chrono>
#include <cstddef>
#include <deque>
#include <thread>

#include <unistd.h>

namespace relumine::python {

namespace {

/// Threads that wait for jobs. They are kept: TBB does not give back all that it has for a thread
/// when the thread ends, some 8 KB.
class Workers {
public:
    /// A forked process has none of its parent's threads. Lives as long as the process, because
    /// threads wait in it.
    static Workers& of_process() {
        static Workers* workers = nullptr;
        static pid_t owner = 0;
        if (workers == nullptr || owner != getpid()) {
            workers = new Workers; // NOLINT(cppcoreguidelines-owning-memory)
            owner = getpid();
        }
        return *workers;
    }

    void start(std::function<void()> job) {
        std::unique_lock lock(mutex_);
        const bool needs_thread = num_waiting_ <= jobs_.size();
        jobs_.push_back(std::move(job));
        ++num_unfinished_;
        if (!needs_thread) {
            changed_.notify_all();
            return;
        }
        try {
            std::thread([this] { work(); }).detach();
        } catch (...) {
            jobs_.pop_back();
            --num_unfinished_;
            throw;
        }
    }

    void wait_for_all() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return num_unfinished_ == 0; });
    }

private:
    [[noreturn]] void work() {
        std::unique_lock lock(mutex_);
        for (;;) {
            ++num_waiting_;
            changed_.wait(lock, [this] { return !jobs_.empty(); });
            --num_waiting_;
            std::function<void()> job = std::move(jobs_.front());
            jobs_.pop_front();
            lock.unlock();
            job();
            job = nullptr;
            lock.lock();
            --num_unfinished_;
            changed_.notify_all();
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::function<void()>> jobs_;
    std::size_t num_waiting_ = 0;
    std::size_t num_unfinished_ = 0;
};

} // namespace

bool Job::wait_for(std::unique_lock<std::mutex>& lock, int milliseconds) {
    return changed_.wait_for(lock, std::chrono::milliseconds(milliseconds),
                             [this] { return is_done_; });
}

void Job::run(const std::shared_ptr<Job>& job, const py::object& progress) {
    constexpr int PollMilliseconds = 25;
    constexpr int StopMilliseconds = 50;
    Workers::of_process().start([job] {
        std::exception_ptr error;
        try {
            job->work(
                {.stop = job->stop_.get_token(), .on_progress = [&own = *job](double fraction) {
                     own.fraction_ = fraction;
                 }});
        } catch (...) {
            error = std::current_exception();
        }
        const std::lock_guard lock(job->mutex_);
        job->error_ = std::move(error);
        job->is_done_ = true;
        job->changed_.notify_all();
    });

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
        Workers::of_process().wait_for_all();
    });
}

} // namespace relumine::python
