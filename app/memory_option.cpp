#include "app/memory_option.h"

#include <cctype>
#include <cstdlib>
#include <stdexcept>

#include <fmt/format.h>

namespace relumine::app {

std::string megabytes(std::uint64_t bytes) {
    constexpr std::uint64_t Megabyte = 1u << 20u;
    return bytes < Megabyte ? fmt::format("{} bytes", bytes)
                            : fmt::format("{} MB", (bytes + Megabyte - 1) / Megabyte);
}

std::optional<std::uint64_t> parse_size(const std::string& text) {
    if (text.empty() || std::isdigit(static_cast<unsigned char>(text.front())) == 0)
        return {};
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    const std::string unit = end;
    double factor = 1.0;
    if (!unit.empty()) {
        const std::string units = "KMGT";
        const auto at =
            units.find(static_cast<char>(std::toupper(static_cast<unsigned char>(unit.front()))));
        const bool is_known = at != std::string::npos &&
                              (unit.size() == 1 || unit.substr(1) == "B" || unit.substr(1) == "iB");
        if (!is_known)
            return {};
        factor = static_cast<double>(std::uint64_t{1} << (10 * (at + 1)));
    }
    const double bytes = number * factor;
    if (!(bytes >= 1.0 && bytes < 1e18))
        return {};
    return static_cast<std::uint64_t>(bytes);
}

void MemoryOption::add_to(Command& command) {
    command
        .add_option(
            "--max-memory",
            [this](const std::string& text) {
                max_bytes_ = parse_size(text);
                if (!max_bytes_)
                    throw UsageError(
                        "--max-memory",
                        fmt::format("expected a size like 500M or 4G, got '{}'", text));
            },
            "refuse the work when it would take more memory, stop when it does: 500M, 4G")
        .type_name("SIZE");
}

void MemoryOption::check_scene(const prt::SceneSizes& sizes, const std::string& mesh) const {
    if (max_bytes_ && prt::scene_bytes(sizes) > *max_bytes_)
        throw std::runtime_error(
            fmt::format("{}: expected work within {}, got a scene that takes {} of memory alone",
                        mesh, megabytes(*max_bytes_), megabytes(prt::scene_bytes(sizes))));
}

void MemoryOption::check_estimate(const prt::SceneSizes& sizes, const prt::Receivers& receivers,
                                  const prt::Blockers& blockers, const std::string& mesh,
                                  prt::PrecomputeOptions& precompute, const Session& session,
                                  Report& report) const {
    if (!max_bytes_)
        return;
    check_scene(sizes, mesh); // now with the receivers
    precompute.plane_bytes = prt::plane_bytes_within(sizes, *max_bytes_);
    const prt::MemoryEstimate estimate =
        prt::estimate_memory(sizes, receivers, blockers, precompute, *max_bytes_);
    session.detail(fmt::format("memory: about {} for about {} clusters",
                               megabytes(estimate.peak_bytes), estimate.num_clusters));
    if (estimate.is_at_least || estimate.peak_bytes > *max_bytes_)
        throw std::runtime_error(
            fmt::format("{}: expected work within {}, got an estimate of {} {} of memory for {}{} "
                        "clusters; a larger "
                        "--tolerance takes less",
                        mesh, megabytes(*max_bytes_), estimate.is_at_least ? "more than" : "about",
                        megabytes(estimate.peak_bytes), estimate.is_at_least ? "more than " : "",
                        estimate.num_clusters));
    precompute.max_column_bytes = prt::max_column_bytes(sizes, precompute.plane_bytes, *max_bytes_);
    report.set("memory_estimate", estimate.peak_bytes);
    report.set("clusters_estimate", estimate.num_clusters);
}

std::optional<std::uint64_t> MemoryOption::max_glossy_bytes(const prt::SceneSizes& sizes,
                                                            std::uint64_t column_bytes) const {
    if (!max_bytes_)
        return {};
    return prt::max_glossy_bytes(sizes, column_bytes, *max_bytes_);
}

std::string MemoryOption::stopped(const prt::TooManyClusters& error,
                                  const std::string& mesh) const {
    return fmt::format(
        "{}: expected work within {}, got at least {} clusters, which take more; stopped", mesh,
        megabytes(max_bytes_.value_or(0)), error.num_clusters);
}

} // namespace relumine::app
