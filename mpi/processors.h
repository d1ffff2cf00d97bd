// Which processors the processes may use: starters bind them to few unless told otherwise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relumine::mpi {

struct Processors {
    std::string host = {};
    /// Those that this process may run on, ascending, as the system numbers them.
    std::vector<std::uint32_t> allowed = {};
    /// All of the host.
    std::uint32_t num_online = 1;
};

/// Returns the processors of this process.
[[nodiscard]] Processors processors();

[[nodiscard]] std::vector<std::byte> packed(const Processors& processors);
[[nodiscard]] Processors unpacked_processors(std::span<const std::byte> bytes);

/// Returns a line on the first host where some processors are left to no process, or nothing.
[[nodiscard]] std::string idle_processors(std::span<const Processors> of_processes);

} // namespace relumine::mpi
