// What the process has used so far.
#pragma once

#include <sys/resource.h>

namespace relumine::bench {

/// User time, all threads: less moved by others on the machine than the clock on the wall.
inline double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

inline double peak_megabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) * 1024e-6;
}

} // namespace relumine::bench
