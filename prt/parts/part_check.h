// What is missing before parts can be joined.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace relumine::prt {

struct PartCheck {
    /// Parts of the whole that the first sound file belongs to; 0 where no file is sound.
    std::size_t num_parts = 0;
    /// Indices, from 0 on.
    std::vector<std::uint32_t> missing = {};
    /// A line for each file that cannot be joined: "path: expected X, got Y".
    std::vector<std::string> faults = {};

    [[nodiscard]] bool is_whole() const {
        return num_parts > 0 && missing.empty() && faults.empty();
    }
};

/// Looks whether files are all parts of a planned precompute or of light, each whole and there
/// once.
///
/// Memory:  the largest file.
/// Cost:    reads each file once.
[[nodiscard]] PartCheck check_parts(std::span<const std::filesystem::path> paths);

} // namespace relumine::prt
