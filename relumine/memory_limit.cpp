#include "relumine/memory_limit.h"

#include <fmt/format.h>

namespace relumine {

std::string megabytes(std::uint64_t bytes) {
    constexpr std::uint64_t Megabyte = 1u << 20u;
    return bytes < Megabyte ? fmt::format("{} bytes", bytes)
                            : fmt::format("{} MB", (bytes + Megabyte - 1) / Megabyte);
}

void MemoryLimit::check_scene(const prt::SceneSizes& sizes) const {
    if (max_bytes_ && prt::scene_bytes(sizes) > *max_bytes_)
        throw MemoryLimitExceeded(
            MemoryLimitExceeded::Part::Scene,
            fmt::format("{}expected work within {}, got a scene that takes {} of memory alone",
                        prefix_, megabytes(*max_bytes_), megabytes(prt::scene_bytes(sizes))));
}

std::optional<prt::MemoryEstimate>
MemoryLimit::check_estimate(const prt::SceneSizes& sizes, const prt::Receivers& receivers,
                            const prt::Blockers& blockers,
                            prt::PrecomputeOptions& precompute) const {
    if (!max_bytes_)
        return {};
    check_scene(sizes); // now with the receivers
    precompute.plane_bytes = prt::plane_bytes_within(sizes, *max_bytes_);
    const prt::MemoryEstimate estimate =
        prt::estimate_memory(sizes, receivers, blockers, precompute, *max_bytes_);
    if (estimate.is_at_least || estimate.peak_bytes > *max_bytes_)
        throw MemoryLimitExceeded(
            MemoryLimitExceeded::Part::Clusters,
            fmt::format("{}expected work within {}, got an estimate of {} {} of memory for {}{} "
                        "clusters",
                        prefix_, megabytes(*max_bytes_),
                        estimate.is_at_least ? "more than" : "about",
                        megabytes(estimate.peak_bytes), estimate.is_at_least ? "more than " : "",
                        estimate.num_clusters));
    precompute.max_column_bytes = prt::max_column_bytes(sizes, precompute.plane_bytes, *max_bytes_);
    return estimate;
}

std::optional<std::uint64_t> MemoryLimit::max_glossy_bytes(const prt::SceneSizes& sizes,
                                                           std::uint64_t column_bytes) const {
    if (!max_bytes_)
        return {};
    return prt::max_glossy_bytes(sizes, column_bytes, *max_bytes_);
}

std::optional<std::uint64_t> MemoryLimit::max_bounce_bytes(const prt::SceneSizes& sizes,
                                                           std::uint64_t column_bytes) const {
    if (!max_bytes_)
        return {};
    return prt::max_bounce_bytes(sizes, column_bytes, *max_bytes_);
}

MemoryLimitExceeded MemoryLimit::stopped(const prt::TooManyClusters& error) const {
    return {MemoryLimitExceeded::Part::ClustersFound,
            fmt::format("{}expected work within {}, got at least {} clusters, which take more; "
                        "stopped",
                        prefix_, megabytes(max_bytes_.value_or(0)), error.num_clusters)};
}

MemoryLimitExceeded MemoryLimit::too_many_highlights(std::uint64_t max_bytes, std::string_view kind,
                                                     std::uint64_t num_entries) const {
    return {MemoryLimitExceeded::Part::Highlights,
            fmt::format("{}expected highlights within {} of memory, got {} {}", prefix_,
                        megabytes(max_bytes), kind, megabytes(num_entries * prt::BytesPerEntry))};
}

MemoryLimitExceeded MemoryLimit::too_many_hits(std::uint64_t max_bytes,
                                               std::uint64_t num_hits) const {
    return {MemoryLimitExceeded::Part::Bounces,
            fmt::format("{}expected bounces within {} of memory, got {}", prefix_,
                        megabytes(max_bytes), megabytes(num_hits * prt::BytesPerHit))};
}

} // namespace relumine
