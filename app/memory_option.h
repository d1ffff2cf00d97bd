// --max-memory of `relumine precompute`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/session.h"
#include "prt/memory_estimate.h"

namespace relumine::app {

class MemoryOption {
public:
    void add_to(Command& command);

    /// Without the option nothing happens. With it: refuses the work when the scene alone is too
    /// large; `mesh` is for messages, as in all of these.
    void check_scene(const prt::SceneSizes& sizes, const std::string& mesh) const;

    /// Bounds what the precompute may use, and refuses the work when the estimate is above the
    /// limit. Throws std::runtime_error with both figures.
    void check_estimate(const prt::SceneSizes& sizes, const prt::Receivers& receivers,
                        const prt::Blockers& blockers, const std::string& mesh,
                        prt::PrecomputeOptions& precompute, const Session& session,
                        Report& report) const;

    /// What the highlights' part may take after clusters whose columns took `column_bytes`; none
    /// without the option.
    [[nodiscard]] std::optional<std::uint64_t> max_glossy_bytes(const prt::SceneSizes& sizes,
                                                                std::uint64_t column_bytes) const;

    /// The message for a run that found more clusters than estimated.
    [[nodiscard]] std::string stopped(const prt::TooManyClusters& error,
                                      const std::string& mesh) const;

private:
    std::optional<std::uint64_t> max_bytes_;
};

/// "12 MB": powers of 1024, rounded up; "12 bytes" below one.
[[nodiscard]] std::string megabytes(std::uint64_t bytes);

/// "500M", "4G", "1.5G", "100000": powers of 1024. None for anything else.
[[nodiscard]] std::optional<std::uint64_t> parse_size(const std::string& text);

} // namespace relumine::app
