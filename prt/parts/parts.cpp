#include "prt/parts/parts.h"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <unordered_set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "prt/clusters/cluster_kernels.h"
#include "prt/clusters/lattice.h"
#include "prt/clusters/visibility_planes.h"
#include "prt/progress.h"
#include "prt/receivers/receiver_order.h"
#include "prt/tolerance.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

constexpr std::size_t MostBlocksForOne = 16;
constexpr std::size_t LeastSampledBlocks = 1024;

/// Takes every n-th block of neighbours.
Receivers sample_of(const Receivers& receivers, std::span<const std::uint32_t> order) {
    const std::size_t num_blocks = (order.size() + BlockSize - 1) / BlockSize;
    const std::size_t step =
        std::clamp<std::size_t>(num_blocks / LeastSampledBlocks, 1, MostBlocksForOne);
    Receivers sample;
    for (std::size_t block = step / 2; block < num_blocks; block += step) {
        const std::size_t end = std::min((block + 1) * BlockSize, order.size());
        for (std::size_t place = block * BlockSize; place < end; ++place) {
            sample.positions.push_back(receivers.positions[order[place]]);
            sample.normals.push_back(receivers.normals[order[place]]);
        }
    }
    return sample;
}

/// Returns the tiles of a part, ascending.
std::vector<std::size_t> tiles_of(const Part& part, std::size_t num_tiles) {
    std::vector<std::size_t> tiles;
    for (std::size_t tile = part.index; tile < num_tiles; tile += part.count)
        tiles.push_back(tile);
    return tiles;
}

/// Counts for given clusters, batch by batch as Clustering does. A batch holds clusters of one
/// level. Its size follows from the number of all receivers: which directions are traced together
/// must not depend on the part.
class PartCounts {
public:
    PartCounts(const Receivers& receivers, const Transfer& plan, const Blockers& blockers,
               const PrecomputeOptions& options, std::span<const std::size_t> tiles)
        : options_(options), leaves_(plan.quadtree.leaves()),
          texel_level_(texel_level(options.face_resolution)),
          progress_(options.stop, options.on_progress) {
        const VisibleCounts whole{.num_receivers = plan.num_receivers()};
        for (const std::size_t tile : tiles) {
            const std::size_t end =
                std::min(whole.tile_begin(tile + 1) * BlockSize, plan.num_receivers());
            for (std::size_t p = whole.tile_begin(tile) * BlockSize; p < end; ++p) {
                normals_of_places_.push_back(plan.normals[p]);
                origins_.push_back(
                    ray_origin(receivers.positions[plan.order[p]], plan.normals[p], options.bias));
            }
        }
        normals_ = NormalArrays(normals_of_places_);
        const std::size_t words_of_all = (plan.num_receivers() + WordSize - 1) / WordSize;
        max_planes_ = std::max<std::size_t>(256, options.plane_bytes /
                                                     (words_of_all * sizeof(std::uint64_t)));
        planes_.emplace(origins_, normals_, blockers);
    }

    VisibleCounts run(PrecomputeStatistics& statistics) {
        std::vector<std::uint32_t> by_level(leaves_.size());
        std::iota(by_level.begin(), by_level.end(), 0u);
        std::stable_sort(by_level.begin(), by_level.end(), [&](std::uint32_t a, std::uint32_t b) {
            return leaves_[a].level < leaves_[b].level;
        });
        columns_.resize(leaves_.size());
        for (std::size_t begin = 0; begin < by_level.size();) {
            const std::size_t end = end_of_batch(by_level, begin);
            work_on(std::span(by_level).subspan(begin, end - begin),
                    static_cast<double>(begin) / static_cast<double>(by_level.size()),
                    static_cast<double>(end) / static_cast<double>(by_level.size()));
            begin = end;
        }
        statistics.num_directions = planes_->num_directions();
        statistics.num_rays = planes_->num_rays();
        statistics.column_bytes = column_bytes_;
        planes_.reset();
        return counts_from_columns(std::move(columns_), origins_.size());
    }

private:
    [[nodiscard]] bool is_texel(const Cell& cell) const { return cell.level == texel_level_; }

    [[nodiscard]] std::size_t end_of_batch(std::span<const std::uint32_t> leaves,
                                           std::size_t begin) const {
        std::unordered_set<LatticePoint> points;
        std::size_t end = begin;
        for (; end < leaves.size(); ++end) {
            const Cell& cell = leaves_[leaves[end]];
            if (cell.level != leaves_[leaves[begin]].level)
                break;
            for (const LatticePoint point : needed_points(cell, is_texel(cell)))
                points.insert(point);
            if (points.size() > max_planes_ && end > begin)
                break;
        }
        return end;
    }

    void work_on(std::span<const std::uint32_t> leaves, double part_before, double part_after) {
        std::vector<LatticePoint> points;
        for (const std::uint32_t leaf : leaves) {
            const std::vector<LatticePoint> of_cell =
                needed_points(leaves_[leaf], is_texel(leaves_[leaf]));
            points.insert(points.end(), of_cell.begin(), of_cell.end());
        }
        planes_->keep_only(points);
        progress_.start_stage(part_before, part_after);
        const double patch_width = 4 * 2.0 * leaves_[leaves.front()].size();
        planes_->trace(points, patch_width, [this](double part) { progress_.report(part); });
        tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t i) {
            progress_.poll();
            columns_[leaves[i]] = column(leaves_[leaves[i]]);
        });
        for (const std::uint32_t leaf : leaves)
            column_bytes_ += bytes_of(columns_[leaf]);
        if (column_bytes_ > options_.max_column_bytes)
            throw TooManyClusters(leaves_.size(), column_bytes_);
    }

    [[nodiscard]] LeafColumn column(const Cell& cell) const {
        return leaf_column(normals_, planes_->samples_of(cell, is_texel(cell)),
                           is_texel(cell) ? CentreWeights : SampleWeights, origins_.size());
    }

    static std::uint64_t bytes_of(const LeafColumn& column) {
        return column.counts.size() +
               sizeof(std::uint64_t) * (column.visible.size() + column.mixed.size());
    }

    const PrecomputeOptions& options_;
    std::span<const Cell> leaves_;
    std::uint32_t texel_level_;
    Progress progress_;
    std::vector<glm::vec3> normals_of_places_;
    std::vector<glm::vec3> origins_;
    NormalArrays normals_;
    std::size_t max_planes_ = 0;
    std::optional<VisibilityPlanes> planes_;
    std::vector<LeafColumn> columns_;
    std::uint64_t column_bytes_ = 0;
};

} // namespace

Transfer plan_clusters(const Receivers& receivers, const Blockers& blockers,
                       const PrecomputeOptions& options, PrecomputeStatistics* statistics) {
    Transfer plan;
    plan.order = spatial_order(receivers);
    PrecomputeOptions of_sample = options;
    // The same RMS for fewer receivers.
    of_sample.epsilon = {};
    of_sample.tolerance = rms_tolerance(options.tolerance, options.epsilon, receivers.size());
    plan.quadtree =
        precompute(sample_of(receivers, plan.order), blockers, of_sample, statistics).quadtree;
    for (const std::uint32_t receiver : plan.order)
        plan.normals.push_back(receivers.normals[receiver]);
    return plan;
}

VisibleCounts part_counts(const Receivers& receivers, const Transfer& plan,
                          const Blockers& blockers, const PrecomputeOptions& options,
                          const Part& part, PrecomputeStatistics* statistics) {
    if (part.index >= part.count || part.count > MaxParts)
        throw std::invalid_argument(fmt::format("expected a part among {} at most, got {} of {}",
                                                MaxParts, std::uint64_t{part.index} + 1,
                                                part.count));
    const auto start = std::chrono::steady_clock::now();
    const VisibleCounts whole{.num_receivers = plan.num_receivers()};
    const std::vector<std::size_t> tiles = tiles_of(part, whole.num_tiles());
    PrecomputeStatistics local;
    VisibleCounts counts{.num_leaves = plan.num_clusters()};
    if (!tiles.empty())
        counts = PartCounts(receivers, plan, blockers, options, tiles).run(local);
    local.num_clusters = plan.num_clusters();
    local.num_samples = local.num_directions * counts.num_receivers;
    local.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (statistics != nullptr)
        *statistics = local;
    return counts;
}

VisibleCounts joined_counts(const Transfer& plan, std::span<const VisibleCounts> parts) {
    VisibleCounts whole{.num_receivers = plan.num_receivers(), .num_leaves = plan.num_clusters()};
    const std::size_t num_words = whole.num_blocks() * whole.words_per_block();
    whole.visible.reserve(num_words);
    whole.mixed.reserve(num_words);
    for (std::size_t tile = 0; tile < whole.num_tiles(); ++tile) {
        const VisibleCounts& part = parts[tile % parts.size()];
        const std::size_t own_tile = tile / parts.size();
        const std::size_t num_blocks = whole.tile_begin(tile + 1) - whole.tile_begin(tile);
        if (part.num_leaves != whole.num_leaves || own_tile >= part.num_tiles() ||
            part.tile_begin(own_tile + 1) - part.tile_begin(own_tile) != num_blocks)
            throw std::invalid_argument("expected the counts of all tiles");
        const auto begin =
            static_cast<std::ptrdiff_t>(part.tile_begin(own_tile) * part.words_per_block());
        const auto end =
            static_cast<std::ptrdiff_t>(part.tile_begin(own_tile + 1) * part.words_per_block());
        const auto append = [&](auto& to, const auto& from, std::ptrdiff_t first,
                                std::ptrdiff_t last) {
            to.insert(to.end(), from.begin() + first, from.begin() + last);
        };
        append(whole.visible, part.visible, begin, end);
        append(whole.mixed, part.mixed, begin, end);
        const auto pairs_before = [&](std::ptrdiff_t word) {
            const auto at = static_cast<std::size_t>(word);
            return static_cast<std::ptrdiff_t>(BlockSize * (at < part.mixed_before.size()
                                                                ? part.mixed_before[at]
                                                                : part.num_mixed()));
        };
        append(whole.counts, part.counts, pairs_before(begin), pairs_before(end));
    }
    whole.index();
    return whole;
}

} // namespace relumine::prt
