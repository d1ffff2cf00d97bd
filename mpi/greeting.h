// What processes must have in common before they share work.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace relumine::mpi {

struct Greeting {
    std::string version;
    /// prt::arithmetic()
    std::string instruction_set;
    std::vector<std::string> arguments;
};

/// Returns the greeting of this process.
[[nodiscard]] Greeting greeting(const std::vector<std::string>& arguments);

[[nodiscard]] std::vector<std::byte> packed(const Greeting& greeting);
[[nodiscard]] Greeting unpacked(std::span<const std::byte> bytes);

/// Returns "expected the arguments ... of the first process, got ...", or nothing where they agree.
[[nodiscard]] std::string difference(const Greeting& first, const Greeting& own);

} // namespace relumine::mpi
