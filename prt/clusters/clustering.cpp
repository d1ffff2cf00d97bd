#include "prt/clusters/clustering.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "prt/clusters/lattice.h"
#include "prt/free_memory.h"
#include "prt/receivers/receiver_order.h"

namespace relumine::prt {

namespace {

/// Name of this part in a checkpoint.
constexpr const char* Part = "clusters";

/// Points that a batch may always add, with or without room: the points of a few splits.
constexpr std::size_t MinBatchPoints = 128;

/// Work between two looks at the checkpoint: 64 tasks of the tracer for every thread, less than a
/// second.
constexpr std::uint64_t SamplesPerThreadAndStep = std::uint64_t{1} << 26;

/// Returns the limit on ||T_C - T_l||^2 for a cluster, T times pi [JN, Eq. 11].
double allowed_squared_distance(const PrecomputeOptions& options, std::size_t num_receivers) {
    const auto n = static_cast<double>(num_receivers);
    const double distance = options.epsilon ? static_cast<double>(*options.epsilon) * n
                                            : static_cast<double>(options.tolerance) * std::sqrt(n);
    const double times_pi = distance * std::numbers::pi;
    return times_pi * times_pi;
}

/// Allocations and links beside the bytes themselves. They matter when receivers are few.
constexpr std::uint64_t OverheadOfPlane = 112;
constexpr std::uint64_t OverheadOfCluster = 256;

constexpr std::size_t BytesPerSlice = std::size_t{64} << 20;

std::uint64_t bytes_of(const LeafColumn& column, double scale) {
    const std::size_t bytes = column.counts.size() +
                              sizeof(std::uint64_t) * (column.visible.size() + column.mixed.size());
    return OverheadOfCluster + static_cast<std::uint64_t>(scale * static_cast<double>(bytes));
}

/// Returns a key for the depth-first order of cells of any level: by face, then along the Z curve.
std::uint64_t depth_first_key(const Cell& cell) {
    std::uint64_t key = static_cast<std::uint64_t>(cell.face);
    for (std::uint32_t level = 0; level < MaxLevel; ++level) {
        std::uint64_t child = 0;
        if (level < cell.level) {
            const std::uint32_t shift = cell.level - 1u - level;
            child = (cell.x >> shift & 1u) | (cell.y >> shift & 1u) << 1u;
        }
        key = key << 2u | child;
    }
    return key;
}

Quadtree quadtree_of(const std::vector<Cell>& leaves) {
    std::vector<bool> flags;
    std::size_t next = 0;
    const auto visit = [&](const auto& self, const Cell& cell) -> void {
        const bool is_leaf = leaves[next] == cell;
        flags.push_back(!is_leaf);
        if (is_leaf)
            ++next;
        else
            for (std::uint32_t i = 0; i < 4; ++i)
                self(self, cell.child(i));
    };
    for (const cubemap::Face face : cubemap::AllFaces)
        visit(visit, Cell{.face = face});
    return Quadtree(flags);
}

} // namespace

Clustering::Clustering(const Receivers& receivers, const Blockers& blockers,
                       const PrecomputeOptions& options, const PrecomputeContext& context)
    : options_(options), context_(context), order_(spatial_order(receivers)),
      progress_(options.stop, options.on_progress),
      max_level_(texel_level(options.face_resolution)),
      allowed_(allowed_squared_distance(options, receivers.size())), estimate_(max_level_) {
    ordered_normals_.reserve(order_.size());
    origins_.reserve(order_.size());
    for (const std::uint32_t receiver : order_) {
        const glm::vec3& normal = receivers.normals[receiver];
        ordered_normals_.push_back(normal);
        origins_.push_back(ray_origin(receivers.positions[receiver], normal, options.bias));
    }
    normals_ = NormalArrays(ordered_normals_);
    max_planes_ = static_cast<std::size_t>(options.plane_bytes /
                                           (normals_.num_words() * sizeof(std::uint64_t)));
    planes_.emplace(origins_, normals_, blockers);
}

/// Pushes all cells of the first level to be tested, depth first, so that siblings follow each
/// other.
void Clustering::start() {
    const std::uint32_t first_level = std::min(options_.min_level, max_level_);
    const auto push = [&](const auto& self, const Cell& cell) -> void {
        if (cell.level == first_level)
            return pending_.push(cell);
        for (std::uint32_t i = 0; i < 4; ++i)
            self(self, cell.child(i));
    };
    for (const cubemap::Face face : cubemap::AllFaces)
        push(push, Cell{.face = face});
}

void Clustering::resume(const Checkpoint::Saved& saved) {
    std::vector<Cluster> clusters;
    for (const std::vector<std::byte>& record : saved.records)
        read_clusters(record, order_.size(), clusters);
    read_work(saved.state, batch_, pending_, *planes_);
    // The cells must cover the sphere, each place once.
    std::vector<Cell> cells = pending_.cells();
    cells.insert(cells.end(), batch_.begin(), batch_.end());
    for (const Cluster& cluster : clusters)
        cells.push_back(cluster.cell);
    std::sort(cells.begin(), cells.end(),
              [](const Cell& a, const Cell& b) { return depth_first_key(a) < depth_first_key(b); });
    std::uint64_t next_key = 0;
    for (const Cell& cell : cells) {
        if (cell.level > max_level_ || depth_first_key(cell) != next_key)
            throw std::runtime_error("checkpoint: expected cells that cover the sphere");
        next_key += std::uint64_t{1} << (2 * (MaxLevel - cell.level));
    }
    if (next_key != cubemap::NumFaces * (std::uint64_t{1} << (2 * MaxLevel)))
        throw std::runtime_error("checkpoint: expected cells that cover the sphere");
    for (Cluster& cluster : clusters)
        add_cluster(std::move(cluster));
    num_saved_ = clusters_.size();
}

void Clustering::add_cluster(Cluster&& cluster) {
    column_bytes_ += bytes_of(cluster.column, context_.column_scale);
    deepest_ = std::max<std::uint32_t>(deepest_, cluster.cell.level);
    clusters_.push_back(std::move(cluster));
}

/// Siblings follow each other in `cells`. So the sixteen new points of a split follow each other in
/// the result and make one packet.
std::vector<LatticePoint> Clustering::needed_points(const std::vector<Cell>& cells) const {
    std::vector<LatticePoint> points;
    for (const Cell& cell : cells) {
        const std::vector<LatticePoint> of_cell = prt::needed_points(cell, is_single_texel(cell));
        points.insert(points.end(), of_cell.begin(), of_cell.end());
    }
    return points;
}

/// Takes as many cells as there is room for planes. While half of the room is free, it takes the
/// coarsest level and fills all room. Otherwise it takes the finest level and fills half of the
/// rest, so that the levels below have room.
void Clustering::take_batch() {
    const std::size_t num_planes = planes_->num_planes();
    const bool has_room = num_planes <= max_planes_ / 2;
    const std::size_t free = max_planes_ - std::min(num_planes, max_planes_);
    const std::size_t room = std::max(MinBatchPoints, has_room ? free : free / 2);
    std::unordered_set<LatticePoint> new_points;
    batch_ = pending_.take(
        has_room ? PendingCells::Order::CoarseFirst : PendingCells::Order::FineFirst,
        [&](const Cell& cell) {
            for (const LatticePoint point : prt::needed_points(cell, is_single_texel(cell)))
                if (!planes_->knows(point))
                    new_points.insert(point);
            return new_points.size() <= room;
        });
}

/// Sets the part of the progress that tracing the batch takes: time, not cells.
void Clustering::start_progress() {
    WorkEstimate::Counts cells{};
    for (std::uint32_t level = 0; level <= max_level_; ++level)
        cells[level] = pending_.size(level);
    const std::uint32_t level = batch_.front().level;
    cells[level] += batch_.size();
    const double done = estimate_.seconds();
    const double all = done + estimate_.seconds_of(cells);
    const double batch = static_cast<double>(batch_.size()) * estimate_.seconds_of_cell(level);
    progress_.start_stage(done / all, (done + batch) / all);
}

void Clustering::trace_batch() {
    start_progress();
    TraceSteps steps;
    if (options_.checkpoint != nullptr) {
        steps.samples_per_step =
            SamplesPerThreadAndStep *
            static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
        steps.between = [this] {
            if (options_.checkpoint->is_due())
                save_checkpoint();
        };
    }
    if (context_.samples_per_step)
        steps.samples_per_step = *context_.samples_per_step;
    // A patch is at most four cells wide: the new points of four splits of siblings reach as far.
    const double patch_width = 4 * 2.0 * batch_.front().size();
    planes_->trace(
        needed_points(batch_), patch_width, [this](double part) { progress_.report(part); }, steps);
}

Clustering::Decision Clustering::decide(const Cell& cell) const {
    const bool is_texel = is_single_texel(cell);
    const CellSamples samples = planes_->samples_of(cell, is_texel);
    if (is_texel)
        return {cell, leaf_column(normals_, samples, CentreWeights, origins_.size())};
    const std::array<double, SamplesPerCell> distances = squared_distances(normals_, samples);
    const bool similar =
        std::all_of(distances.begin(), distances.end(), [&](double d) { return d < allowed_; });
    if (!similar)
        return {cell, std::nullopt};
    return {cell, leaf_column(normals_, samples, SampleWeights, origins_.size())};
}

/// Keeps the clusters, goes on with the children of the other cells, and forgets the planes that
/// nothing needs any more. Decided cells leave the batch in slices. So memory can be watched (a
/// column takes at most a byte per receiver), and checkpoints can be saved between slices.
void Clustering::decide_batch() {
    const std::size_t max_slice = std::max<std::size_t>(64, BytesPerSlice / order_.size());
    const std::size_t num_words = (order_.size() / BlockSize + 63) / 64;
    LeafColumn empty;
    empty.visible.resize(num_words);
    empty.mixed.resize(num_words);
    const std::uint64_t min_bytes = bytes_of(empty, context_.column_scale);
    while (!batch_.empty()) {
        std::vector<Decision> slice(std::min(max_slice, batch_.size()));
        tbb::parallel_for(std::size_t{0}, slice.size(), [&](std::size_t i) {
            progress_.poll();
            slice[i] = decide(batch_[i]);
        });
        std::uint64_t num_bytes = column_bytes_;
        std::size_t num_clusters = clusters_.size();
        std::size_t num_split = 0;
        for (const Decision& decision : slice) {
            num_bytes += decision.column ? bytes_of(*decision.column, context_.column_scale) : 0;
            num_clusters += decision.column ? 1 : 0;
            num_split += decision.column ? 0 : 1;
        }
        // Every waiting cell becomes one cluster at least.
        num_clusters += batch_.size() - slice.size() + pending_.size() + 4 * num_split;
        num_bytes += (num_clusters - clusters_.size() - (slice.size() - num_split)) * min_bytes;
        if (num_bytes > options_.max_column_bytes)
            throw TooManyClusters(num_clusters, num_bytes);
        for (Decision& decision : slice) {
            if (decision.column) {
                add_cluster({decision.cell, std::move(*decision.column)});
                continue;
            }
            for (std::uint32_t i = 0; i < 4; ++i)
                pending_.push(decision.cell.child(i));
        }
        batch_.erase(batch_.begin(), batch_.begin() + static_cast<std::ptrdiff_t>(slice.size()));
        if (!batch_.empty() && options_.checkpoint != nullptr && options_.checkpoint->is_due())
            save_checkpoint();
    }
    planes_->keep_only(needed_points(pending_.cells()));
}

void Clustering::save_checkpoint() {
    const auto start = std::chrono::steady_clock::now();
    const std::span<const Cluster> unsaved =
        std::span(std::as_const(clusters_)).subspan(num_saved_);
    const std::vector<std::byte> record =
        unsaved.empty() ? std::vector<std::byte>() : clusters_record(unsaved);
    if (options_.checkpoint->save(Part, record, work_state(batch_, pending_, *planes_)))
        num_saved_ = clusters_.size();
    seconds_saving_ +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Clustering::work() {
    while (!batch_.empty() || !pending_.empty()) {
        if (batch_.empty())
            take_batch();
        const auto start = std::chrono::steady_clock::now();
        const std::uint32_t level = batch_.front().level;
        const std::size_t num_cells = batch_.size();
        const std::size_t num_clusters = clusters_.size();
        trace_batch();
        decide_batch();
        estimate_.add(
            level, num_cells, num_cells - (clusters_.size() - num_clusters),
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        if (options_.checkpoint != nullptr && options_.checkpoint->is_due())
            save_checkpoint();
    }
}

Transfer Clustering::run(PrecomputeStatistics& statistics) {
    Checkpoint* const checkpoint = options_.checkpoint;
    Checkpoint::Saved saved;
    if (checkpoint != nullptr)
        saved = checkpoint->load(Part, true);
    if (saved.state.empty())
        start();
    else
        resume(saved);
    saved = {};
    try {
        work();
    } catch (const TooManyClusters&) {
        if (checkpoint != nullptr)
            save_checkpoint();
        throw;
    } catch (const Cancelled&) {
        if (checkpoint != nullptr && checkpoint->is_worthwhile())
            save_checkpoint();
        throw;
    }
    if (checkpoint != nullptr && context_.more_follows && num_saved_ != clusters_.size() &&
        checkpoint->is_worthwhile())
        save_checkpoint();
    statistics.num_directions = planes_->num_directions();
    statistics.num_rays = planes_->num_rays();
    statistics.column_bytes = column_bytes_;
    statistics.deepest_level = deepest_;
    statistics.seconds_checkpoints = seconds_saving_;
    return result();
}

Transfer Clustering::result() {
    planes_.reset();
    return_free_memory();
    std::sort(clusters_.begin(), clusters_.end(), [](const Cluster& a, const Cluster& b) {
        return depth_first_key(a.cell) < depth_first_key(b.cell);
    });
    std::vector<Cell> leaves;
    std::vector<LeafColumn> columns;
    for (Cluster& cluster : clusters_) {
        leaves.push_back(cluster.cell);
        columns.push_back(std::move(cluster.column));
    }
    clusters_.clear();
    const std::size_t num_receivers = order_.size();
    return {.quadtree = quadtree_of(leaves),
            .order = std::move(order_),
            .normals = std::move(ordered_normals_),
            .counts = counts_from_columns(std::move(columns), num_receivers)};
}

} // namespace relumine::prt
