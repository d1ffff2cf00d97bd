// PrecomputeOptions::max_memory: what each part of a precompute may take. Private.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "prt/memory_estimate.h"
#include "relumine/precompute.h"

namespace relumine {

/// "12 MB": powers of 1024, rounded up; "12 bytes" below one.
[[nodiscard]] std::string megabytes(std::uint64_t bytes);

/// Without a limit nothing here happens. `prefix` begins all messages: "bunny.ply: " or nothing.
class MemoryLimit {
public:
    MemoryLimit(std::optional<std::uint64_t> max_bytes, std::string prefix)
        : max_bytes_(max_bytes), prefix_(std::move(prefix)) {}

    /// Throws MemoryLimitExceeded when the scene alone is too large.
    void check_scene(const prt::SceneSizes& sizes) const;

    /// Bounds what the precompute may use and estimates what it will. Throws MemoryLimitExceeded
    /// with both figures. Nothing without a limit.
    [[nodiscard]] std::optional<prt::MemoryEstimate>
    check_estimate(const prt::SceneSizes& sizes, const prt::Receivers& receivers,
                   const prt::Blockers& blockers, prt::PrecomputeOptions& precompute) const;

    /// What highlights may take after clusters whose columns took `column_bytes`; none: no limit.
    [[nodiscard]] std::optional<std::uint64_t> max_glossy_bytes(const prt::SceneSizes& sizes,
                                                                std::uint64_t column_bytes) const;

    /// The same for bounces.
    [[nodiscard]] std::optional<std::uint64_t> max_bounce_bytes(const prt::SceneSizes& sizes,
                                                                std::uint64_t column_bytes) const;

    /// For a run that found more clusters than estimated.
    [[nodiscard]] MemoryLimitExceeded stopped(const prt::TooManyClusters& error) const;

    /// For highlights; `kind`: "an estimate of" or "at least".
    [[nodiscard]] MemoryLimitExceeded too_many_highlights(std::uint64_t max_bytes,
                                                          std::string_view kind,
                                                          std::uint64_t num_entries) const;

    [[nodiscard]] MemoryLimitExceeded too_many_hits(std::uint64_t max_bytes,
                                                    std::uint64_t num_hits) const;

private:
    std::optional<std::uint64_t> max_bytes_;
    std::string prefix_;
};

} // namespace relumine
