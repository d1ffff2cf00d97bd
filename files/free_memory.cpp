#include "files/free_memory.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

namespace relumine::files {

std::uint64_t free_memory() {
    // All of the memory, if the system does not say what is free.
    std::uint64_t bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                          static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    std::ifstream lines("/proc/meminfo");
    std::string name, unit;
    for (std::uint64_t kilobytes = 0; lines >> name >> kilobytes && std::getline(lines, unit);)
        if (name == "MemAvailable:")
            bytes = 1024 * kilobytes;
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        bytes = std::min<std::uint64_t>(bytes, limit.rlim_cur);
    return bytes;
}

} // namespace relumine::files
