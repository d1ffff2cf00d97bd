#include "files/free_memory.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>

#include <sys/resource.h>
#include <unistd.h>

namespace relumine::files {

namespace {

/// Returns MemAvailable of /proc/meminfo. Reads by C's functions: streams of C++ are a fourth of
/// the runtime's library.
std::optional<std::uint64_t> available_kilobytes() {
    constexpr std::string_view Name = "MemAvailable:";
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen("/proc/meminfo", "r"),
                                                               &std::fclose);
    if (!file)
        return std::nullopt;
    std::array<char, 128> text{};
    while (std::fgets(text.data(), text.size(), file.get()) != nullptr) {
        std::string_view line(text.data());
        if (!line.starts_with(Name))
            continue;
        line.remove_prefix(std::min(line.find_first_not_of(' ', Name.size()), line.size()));
        std::uint64_t kilobytes = 0;
        if (std::from_chars(line.data(), line.data() + line.size(), kilobytes).ec == std::errc())
            return kilobytes;
    }
    return std::nullopt;
}

} // namespace

std::uint64_t free_memory() {
    // All of the memory, if the system does not say what is free.
    std::uint64_t bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                          static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    if (const std::optional<std::uint64_t> kilobytes = available_kilobytes())
        bytes = 1024 * *kilobytes;
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        bytes = std::min<std::uint64_t>(bytes, limit.rlim_cur);
    return bytes;
}

} // namespace relumine::files
