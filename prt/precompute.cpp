#include "prt/precompute.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "files/seconds.h"
#include "prt/clusters/clustering.h"
#include "prt/precompute_context.h"
#include "prt/receivers/receiver_order.h"
#include "prt/receivers/receiver_sample.h"
#include "prt/tolerance.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

void check(const Receivers& receivers, const PrecomputeOptions& options) {
    const auto require = [](bool condition, const std::string& message) {
        if (!condition)
            throw std::invalid_argument(message);
    };
    require(receivers.size() > 0, "expected at least one receiver");
    require(receivers.normals.size() == receivers.size(),
            fmt::format("expected one normal for each of {} receivers, got {}", receivers.size(),
                        receivers.normals.size()));
    require(receivers.size() < (std::size_t{1} << 32), "expected fewer than 2^32 receivers");
    require(std::isfinite(options.tolerance) && options.tolerance >= 0.0f,
            fmt::format("expected a tolerance >= 0, got {}", options.tolerance));
    require(!options.epsilon || (std::isfinite(*options.epsilon) && *options.epsilon >= 0.0f),
            fmt::format("expected an epsilon >= 0, got {}", options.epsilon.value_or(0.0f)));
    require(options.face_resolution >= 1 && options.face_resolution <= (1u << MaxLevel),
            fmt::format("expected a face resolution from 1 to {}, got {}", 1u << MaxLevel,
                        options.face_resolution));
    require(
        options.min_level <= MaxLevel,
        fmt::format("expected a minimum depth from 0 to {}, got {}", MaxLevel, options.min_level));
    require(std::isfinite(options.bias) && options.bias >= 0.0f,
            fmt::format("expected a bias >= 0, got {}", options.bias));
    float farthest = 0.0f;
    for (const glm::vec3& position : receivers.positions)
        for (int axis = 0; axis < 3; ++axis)
            farthest = std::max(farthest, std::abs(position[axis]));
    require(farthest + options.bias < LargestCoordinate,
            fmt::format("expected receivers and bias within {} of the origin, got {} and {}",
                        LargestCoordinate, farthest, options.bias));
}

} // namespace

namespace {

/// Where light passes surfaces by chance, cells have at least this level: so many samples see about
/// the right part of the light, within 0.01.
constexpr std::uint32_t MinLevelOfChance = 3;

/// Chooses clusters from a sample of the receivers: with the tolerance, or the least larger one
/// that makes no more than are wanted. Returns order and quadtree.
Transfer chosen(const Receivers& receivers, const Blockers& blockers,
                const PrecomputeOptions& of_all, const Work& work, const PrecomputeContext& context,
                PrecomputeStatistics& statistics) {
    constexpr float Growth = 1.25f;
    Transfer result;
    result.order = context.given != nullptr ? context.given->order : spatial_order(receivers);
    const Receivers sample = sample_of(receivers, result.order);
    PrecomputeOptions options = for_sample(of_all, receivers.size());
    while (true)
        try {
            result.quadtree =
                Clustering(sample, blockers, options, work, {}).run(statistics).quadtree;
            return result;
        } catch (const TooManyClusters&) {
            options.tolerance = std::max(options.tolerance, 1e-6f) * Growth;
            statistics.grown_tolerance = options.tolerance;
        }
}

/// Where light passes surfaces by chance, clusters are chosen as if it did not, and then counted:
/// no cell could ever have nine transfers that agree.
Transfer found(const Receivers& receivers, const Blockers& blockers,
               const PrecomputeOptions& options, const Work& work, const PrecomputeContext& context,
               PrecomputeStatistics& statistics) {
    const Blockers* settled = blockers.settled();
    if (context.has_clusters || (settled == nullptr && !options.most_clusters))
        return Clustering(receivers, blockers, options, work, context).run(statistics);
    PrecomputeOptions of_choice = options;
    if (settled != nullptr)
        of_choice.min_level = std::max(options.min_level, MinLevelOfChance);
    if (of_choice.most_clusters) // no tolerance makes fewer
        of_choice.most_clusters =
            std::max(*of_choice.most_clusters, std::uint32_t{6} << (2 * of_choice.min_level));
    const Transfer plan = chosen(receivers, settled != nullptr ? *settled : blockers, of_choice,
                                 {.team = work.team, .stop = work.stop}, context, statistics);
    PrecomputeOptions of_counts = options;
    of_counts.most_clusters = {};
    return Clustering(receivers, blockers, of_counts, work,
                      {.column_scale = context.column_scale, .given = &plan, .has_clusters = true})
        .run(statistics);
}

} // namespace

Transfer precompute(const Receivers& receivers, const Blockers& blockers,
                    const PrecomputeOptions& options, const Work& work,
                    const PrecomputeContext& context, PrecomputeStatistics* statistics) {
    check(receivers, options);
    const auto start = std::chrono::steady_clock::now();
    PrecomputeStatistics local;
    Transfer transfer = found(receivers, blockers, options, work, context, local);
    local.num_clusters = transfer.num_clusters();
    local.num_samples = local.num_directions * receivers.size();
    local.seconds = files::seconds_since(start);
    if (statistics != nullptr)
        *statistics = local;
    return transfer;
}

Transfer precompute(const Receivers& receivers, const Blockers& blockers,
                    const PrecomputeOptions& options, const Work& work,
                    PrecomputeStatistics* statistics) {
    return precompute(receivers, blockers, options, work, PrecomputeContext(), statistics);
}

} // namespace relumine::prt
