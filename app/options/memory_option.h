// --max-memory of `relumine precompute`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/session.h"

namespace relumine::app {

class MemoryOption {
public:
    void add_to(Command& command);

    /// None without the option.
    [[nodiscard]] std::optional<std::uint64_t> max_bytes() const { return max_bytes_; }

private:
    std::optional<std::uint64_t> max_bytes_;
};

/// "500M", "4G", "1.5G", "100000": powers of 1024. None for anything else.
[[nodiscard]] std::optional<std::uint64_t> parse_size(const std::string& text);

} // namespace relumine::app
