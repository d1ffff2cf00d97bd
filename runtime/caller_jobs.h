// Loops on the threads of the program that embeds the runtime.
#pragma once

#include "runtime/relumine_runtime.h"

namespace relumine::runtime {

using CallerJobs = RelumineJobs;

/// While it lives, loops of this thread run by `jobs`; without a function they run on this thread
/// alone, as those within a piece of a loop do.
class WithJobs {
public:
    explicit WithJobs(const CallerJobs& jobs);
    ~WithJobs();
    WithJobs(const WithJobs&) = delete;
    WithJobs& operator=(const WithJobs&) = delete;
};

} // namespace relumine::runtime
