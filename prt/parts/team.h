// Processes that share one precompute and can send each other bytes.
#pragma once

#include <cstddef>
#include <vector>

#include "prt/reduction.h"

namespace relumine::prt {

/// A Reduction whose first process (part 0) hands out the work and takes in the results. The rules
/// of Reduction hold for these calls, too.
class Team : public Reduction {
public:
    /// Returns the first process's bytes in each process; what the others give does not count.
    [[nodiscard]] virtual std::vector<std::byte> broadcast(std::vector<std::byte> bytes) = 0;
    /// Returns the bytes of all processes in the first one, by their index, and none in the others.
    [[nodiscard]] virtual std::vector<std::vector<std::byte>>
    gather(std::vector<std::byte> bytes) = 0;
    /// Returns in process i what the first process has at i; what the others give does not count.
    [[nodiscard]] virtual std::vector<std::byte>
    scatter(std::vector<std::vector<std::byte>> bytes) = 0;

    /// Seconds that this process has spent on waiting for the others and on sending.
    [[nodiscard]] virtual double seconds_waiting() const = 0;
};

} // namespace relumine::prt
