#include "prt/memory_estimate.h"

#include <algorithm>
#include <vector>

#include "prt/precompute_context.h"
#include "prt/receivers/receiver_order.h"
#include "prt/tolerance.h"

namespace relumine::prt {

namespace {

constexpr std::uint64_t MiB = std::uint64_t{1} << 20;

// Measured (docs/measurements.md, "Memory"). Per triangle: Embree's tree, the tree of beams and the
// mesh's indices. Per vertex: positions, normals and the remains of loading. Per receiver: two
// copies of positions and normals, one in each order, and the order itself.
constexpr std::uint64_t ProgramBytes = 40 * MiB;
constexpr std::uint64_t BytesPerTriangle = 150;
constexpr std::uint64_t BeamBytesPerTriangle = 260;
constexpr std::uint64_t BytesPerVertex = 48;
constexpr std::uint64_t BytesPerReceiver = 80;

/// The joined counts have a third word for every two words of the columns. While they are joined, a
/// run of receivers has both.
constexpr double JoinedPerColumn = 1.3;
constexpr double ReceiversPerRun = 16384.0;

/// A file is packed and written in batches of 32 MiB, which may be made for it.
constexpr double MostSavedBytes = 64.0 * MiB;

/// Highlights: surfaces and directions to the eye, twice. Blocks are in memory beside the lobe that
/// they are joined to. A save takes less.
constexpr std::uint64_t GlossyBytesPerReceiver = 120;
constexpr double JoinedPerGlossyByte = 2.2;

/// Bounces: samples, lists of similar receivers and probe lights.
constexpr std::uint64_t BounceBytesPerReceiver = 450;

/// The largest level needs this part of all directions; the planes of all levels are never needed
/// together.
constexpr double DirectionsPerCluster = 4.1;
constexpr double LargestLevel = 0.55;

/// Receivers of the trial: blocks of neighbours, whose counts are stored together. Samples are many
/// small groups: neighbouring receivers have similar errors, so a few large groups would say
/// little.
constexpr std::size_t MaxTrialBlocks = 256;

/// A trial finds more clusters than the whole: an RMS over few receivers scatters, and a cell is
/// split when one of nine is too large. The measured scenes had 1.6 to 1.8 times as many.
constexpr double TrialExcess = 1.65;

/// Takes every n-th group of neighbours.
Receivers trial_receivers(const Receivers& receivers) {
    const std::vector<std::uint32_t> order = spatial_order(receivers);
    const std::size_t num_blocks = (order.size() + BlockSize - 1) / BlockSize;
    // At most an eighth of the work.
    const std::size_t num_wanted = std::clamp<std::size_t>(num_blocks / 8, 1, MaxTrialBlocks);
    std::vector<std::uint32_t> chosen;
    for (std::size_t i = 0; i < num_wanted; ++i) {
        const std::size_t begin = (2 * i + 1) * num_blocks / (2 * num_wanted) * BlockSize;
        const std::size_t end = std::min(begin + BlockSize, order.size());
        chosen.insert(chosen.end(), order.begin() + static_cast<std::ptrdiff_t>(begin),
                      order.begin() + static_cast<std::ptrdiff_t>(end));
    }
    return sampled(receivers, chosen);
}

/// What later stages may take, once the beams are gone and the columns are joined.
double left_after_clusters(const SceneSizes& sizes, std::uint64_t bytes_per_receiver,
                           std::uint64_t column_bytes, std::uint64_t max_bytes) {
    SceneSizes without_beams = sizes;
    without_beams.has_beams = false;
    const double used = static_cast<double>(scene_bytes(without_beams)) +
                        static_cast<double>(sizes.num_receivers * bytes_per_receiver) +
                        JoinedPerColumn * static_cast<double>(column_bytes);
    return std::max(0.0, static_cast<double>(max_bytes) - used);
}

} // namespace

std::uint64_t scene_bytes(const SceneSizes& sizes) {
    const std::uint64_t per_triangle =
        BytesPerTriangle + (sizes.has_beams ? BeamBytesPerTriangle : 0);
    return ProgramBytes + sizes.num_vertices * BytesPerVertex + sizes.num_triangles * per_triangle +
           sizes.num_receivers * BytesPerReceiver;
}

std::uint64_t peak_bytes(const SceneSizes& sizes, std::uint64_t plane_bytes,
                         std::uint64_t column_bytes) {
    const auto columns = static_cast<double>(column_bytes);
    const std::uint64_t scene = scene_bytes(sizes);
    const std::uint64_t tracing = scene + plane_bytes + column_bytes;
    const double run = std::min(
        1.0, ReceiversPerRun / static_cast<double>(std::max<std::size_t>(sizes.num_receivers, 1)));
    const std::uint64_t joining =
        scene + static_cast<std::uint64_t>((JoinedPerColumn + run) * columns);
    const double counts = JoinedPerColumn * columns;
    const std::uint64_t saving =
        scene_bytes({.num_vertices = sizes.num_vertices,
                     .num_triangles = 0,
                     .num_receivers = sizes.num_receivers}) +
        static_cast<std::uint64_t>(counts + std::min(counts, MostSavedBytes));
    return std::max({tracing, joining, saving});
}

std::uint64_t max_column_bytes(const SceneSizes& sizes, std::uint64_t plane_bytes,
                               std::uint64_t max_bytes) {
    std::uint64_t low = 0;
    std::uint64_t high = max_bytes;
    while (low < high) {
        const std::uint64_t middle = low + (high - low + 1) / 2;
        if (peak_bytes(sizes, plane_bytes, middle) <= max_bytes)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

std::uint64_t max_glossy_bytes(const SceneSizes& sizes, std::uint64_t column_bytes,
                               std::uint64_t max_bytes) {
    const double left = left_after_clusters(sizes, GlossyBytesPerReceiver, column_bytes, max_bytes);
    return static_cast<std::uint64_t>(left / JoinedPerGlossyByte);
}

std::uint64_t max_bounce_bytes(const SceneSizes& sizes, std::uint64_t column_bytes,
                               std::uint64_t max_bytes) {
    return static_cast<std::uint64_t>(
        left_after_clusters(sizes, BounceBytesPerReceiver, column_bytes, max_bytes));
}

std::uint64_t plane_bytes_within(const SceneSizes& sizes, std::uint64_t max_bytes) {
    const std::uint64_t scene = scene_bytes(sizes);
    const std::uint64_t left = max_bytes > scene ? max_bytes - scene : 0;
    return std::clamp(left / 4, 16 * MiB, PrecomputeOptions{}.plane_bytes);
}

MemoryEstimate estimate_memory(const SceneSizes& sizes, const Receivers& receivers,
                               const Blockers& blockers, const PrecomputeOptions& options,
                               std::uint64_t max_bytes, const std::stop_token& stop) {
    const Receivers trial = trial_receivers(receivers);
    PrecomputeOptions trial_options = for_sample(options, receivers.size());
    const PrecomputeContext context{.column_scale = static_cast<double>(receivers.size()) /
                                                    static_cast<double>(trial.size())};
    // No limit is the largest number, which must not overflow when scaled.
    const double most =
        static_cast<double>(max_column_bytes(sizes, options.plane_bytes, max_bytes));
    trial_options.max_column_bytes = static_cast<std::uint64_t>(std::min(TrialExcess * most, 1e18));
    PrecomputeStatistics statistics;
    MemoryEstimate estimate;
    try {
        static_cast<void>(
            precompute(trial, blockers, trial_options, {.stop = stop}, context, &statistics));
    } catch (const TooLarge& error) {
        estimate.is_at_least = true;
        statistics.num_clusters = error.count;
        statistics.column_bytes = error.bytes;
    }
    estimate.num_clusters =
        static_cast<std::uint64_t>(static_cast<double>(statistics.num_clusters) / TrialExcess);
    estimate.column_bytes =
        static_cast<std::uint64_t>(static_cast<double>(statistics.column_bytes) / TrialExcess);
    const double largest_level = DirectionsPerCluster * LargestLevel *
                                 static_cast<double>(estimate.num_clusters) *
                                 static_cast<double>(receivers.size()) / 8.0;
    estimate.plane_bytes =
        !estimate.is_at_least && largest_level < static_cast<double>(options.plane_bytes)
            ? static_cast<std::uint64_t>(largest_level)
            : options.plane_bytes;
    estimate.peak_bytes = peak_bytes(sizes, estimate.plane_bytes, estimate.column_bytes);
    return estimate;
}

} // namespace relumine::prt
