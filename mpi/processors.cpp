#include "mpi/processors.h"

#include <array>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

namespace relumine::mpi {

Processors processors() {
    Processors own;
    std::array<char, 256> name{};
    if (gethostname(name.data(), name.size() - 1) == 0)
        own.host = name.data();
    cpu_set_t set;
    CPU_ZERO(&set);
    // Hosts with more than 1,024 processors do not fit, and are not warned of.
    if (sched_getaffinity(0, sizeof set, &set) == 0)
        for (std::uint32_t i = 0; i < CPU_SETSIZE; ++i)
            if (CPU_ISSET(i, &set))
                own.allowed.push_back(i);
    if (const long online = sysconf(_SC_NPROCESSORS_ONLN); online > 0)
        own.num_online = static_cast<std::uint32_t>(online);
    return own;
}

std::vector<std::byte> packed(const Processors& processors) {
    std::string text = fmt::format("{}\n{}", processors.host, processors.num_online);
    for (const std::uint32_t i : processors.allowed)
        text += fmt::format(" {}", i);
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

Processors unpacked_processors(std::span<const std::byte> bytes) {
    std::string text;
    for (const std::byte byte : bytes)
        text += static_cast<char>(byte);
    const std::size_t end = text.find('\n');
    Processors result{.host = text.substr(0, end)};
    if (end == std::string::npos)
        return result;
    std::istringstream numbers(text.substr(end));
    numbers >> result.num_online;
    for (std::uint32_t i = 0; numbers >> i;)
        result.allowed.push_back(i);
    return result;
}

std::string idle_processors(std::span<const Processors> of_processes) {
    for (const Processors& first : of_processes) {
        std::set<std::uint32_t> used;
        for (const Processors& process : of_processes)
            if (process.host == first.host)
                used.insert(process.allowed.begin(), process.allowed.end());
        if (!used.empty() && used.size() < first.num_online)
            return fmt::format("{}: the processes may use {} of {} processors; mpirun takes "
                               "--map-by ppr:1:node --bind-to none for all of them, srun "
                               "--cpus-per-task={}",
                               first.host, used.size(), first.num_online, first.num_online);
    }
    return "";
}

} // namespace relumine::mpi
