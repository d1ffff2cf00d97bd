#include "prt/clusters/clustering.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include "files/parallel.h"
#include "files/seconds.h"
#include "prt/clusters/dealt_tiles.h"
#include "prt/clusters/lattice.h"
#include "prt/free_memory.h"
#include "prt/receivers/receiver_order.h"
#include "prt/tolerance.h"
#include "prt/transfer/cell_index.h"

namespace relumine::prt {

namespace {

/// Name of this part in a checkpoint.
constexpr const char* CheckpointPart = "clusters";

/// Points that a batch may always add, with or without room: the points of a few splits.
constexpr std::size_t MinBatchPoints = 128;

/// Work between two looks at the checkpoint: 64 tasks of the tracer for every thread, less than a
/// second.
constexpr std::uint64_t SamplesPerThreadAndStep = std::uint64_t{1} << 26;

/// Work between two looks at the checkpoint where processes share it and wait for each other at the
/// end of a step. A patch costs one process more than another; over many patches the differences
/// even out.
constexpr std::uint64_t SharedSamplesPerThreadAndStep = std::uint64_t{1} << 28;

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

std::ptrdiff_t index_of(std::size_t i) {
    return static_cast<std::ptrdiff_t>(i);
}

std::uint64_t bytes_of(const LeafColumn& column, double scale) {
    const std::size_t bytes = column.counts.size() +
                              sizeof(std::uint64_t) * (column.visible.size() + column.mixed.size());
    return OverheadOfCluster + static_cast<std::uint64_t>(scale * static_cast<double>(bytes));
}

} // namespace

Clustering::Clustering(const Receivers& receivers, const Blockers& blockers,
                       const PrecomputeOptions& options, const Work& work,
                       const PrecomputeContext& context)
    : options_(options), context_(context), work_(work), num_points_(receivers.num_points()),
      order_(context.given != nullptr ? context.given->order : spatial_order(receivers)),
      progress_(work), steps_(
                           work, CheckpointPart, [this] { return content(); },
                           [this] { num_saved_ = clusters_.size(); }),
      max_level_(texel_level(options.face_resolution)),
      allowed_(allowed_squared_distance(options, receivers.size())),
      estimate_(max_level_, rms_tolerance(options.tolerance, options.epsilon, receivers.size())) {
    ordered_normals_.reserve(order_.size());
    for (const std::uint32_t receiver : order_)
        ordered_normals_.push_back(receivers.normals[receiver]);
    const std::vector<std::uint32_t> places = places_of(work.team.part(), order_.size());
    std::vector<glm::vec3> normals;
    normals.reserve(places.size());
    origins_.reserve(places.size());
    for (const std::uint32_t place : places) {
        normals.push_back(ordered_normals_[place]);
        origins_.push_back(
            ray_origin(receivers.positions[order_[place]], normals.back(), options.bias));
    }
    normals_ = NormalArrays(normals, places_of(work.team.part(), num_points_).size());
    const std::size_t num_words = (order_.size() + WordSize - 1) / WordSize;
    max_planes_ =
        static_cast<std::size_t>(options.plane_bytes / (num_words * sizeof(std::uint64_t)));
    planes_.emplace(origins_, normals_, blockers);
    columns_.emplace(origins_.size());
}

/// Pushes the cells to begin with, depth first, so that siblings follow each other.
void Clustering::start() {
    const std::uint32_t level = std::min(options_.min_level, max_level_);
    const Quadtree first = context_.has_clusters
                               ? context_.given->quadtree
                               : Quadtree::of([=](const Cell& cell) { return cell.level < level; });
    for (const Cell& cell : first.leaves())
        pending_.push(cell);
}

void Clustering::resume(const Checkpoint::Saved& saved) {
    for (const std::vector<std::byte>& record : saved.records) {
        std::vector<Cluster> clusters;
        read_clusters(record, clusters);
        for (const Cluster& cluster : clusters) {
            if (cluster.column.visible.size() != columns_->num_tiles())
                throw std::runtime_error("checkpoint: expected the clusters of all tiles");
            add_cluster(cluster);
        }
    }
    read_work(saved.state, batch_, pending_, *planes_);
    // The cells must cover the sphere, each place once.
    std::vector<Cell> cells = pending_.cells();
    cells.insert(cells.end(), batch_.begin(), batch_.end());
    cells.insert(cells.end(), clusters_.begin(), clusters_.end());
    std::sort(cells.begin(), cells.end(),
              [](const Cell& a, const Cell& b) { return z_curve_key(a) < z_curve_key(b); });
    std::uint64_t next_key = 0;
    for (const Cell& cell : cells) {
        if (cell.level > max_level_ || z_curve_key(cell) != next_key)
            throw std::runtime_error("checkpoint: expected cells that cover the sphere");
        next_key += std::uint64_t{1} << (2 * (MaxLevel - cell.level));
    }
    if (next_key != cubemap::NumFaces * (std::uint64_t{1} << (2 * MaxLevel)))
        throw std::runtime_error("checkpoint: expected cells that cover the sphere");
    num_saved_ = clusters_.size();
}

void Clustering::add_cluster(const Cluster& cluster) {
    column_bytes_ += bytes_of(cluster.column, context_.column_scale);
    deepest_ = std::max<std::uint32_t>(deepest_, cluster.cell.level);
    clusters_.push_back(cluster.cell);
    columns_->add(cluster.column);
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

/// Returns the patches of a step on this process's receivers.
std::uint64_t Clustering::patches_per_step() const {
    if (work_.step_size)
        return *work_.step_size / (order_.size() * DirectionPatch::Size);
    const std::size_t num_receivers =
        std::max<std::size_t>(order_.size() / work_.team.part().count, 1);
    return (work_.team.has_others() ? SharedSamplesPerThreadAndStep : SamplesPerThreadAndStep) *
           files::num_threads() / (num_receivers * DirectionPatch::Size);
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
    if (work_.has_steps())
        steps = {.patches_per_step = patches_per_step_, .between = [this] {
                     steps_.look_up();
                 }};
    // A patch is at most four cells wide: the new points of four splits of siblings reach as far.
    const double patch_width = 4 * 2.0 * batch_.front().size();
    planes_->trace(
        needed_points(batch_), patch_width, [this](double part) { progress_.report(part); }, steps);
    most_planes_ = std::max(most_planes_, planes_->num_planes());
}

/// Returns for each cell how many levels of cells are expected below it: none if it is a cluster;
/// the others are to be split.
std::vector<std::uint8_t> Clustering::levels_below(std::span<const Cell> cells) {
    std::vector<std::uint8_t> levels(cells.size());
    if (context_.has_clusters)
        return levels;
    std::vector<std::int64_t> sums(cells.size() * SamplesPerCell);
    files::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
        progress_.poll();
        if (is_single_texel(cells[i]))
            return; // nothing to compare
        const auto of_cell = squared_distances(normals_, planes_->samples_of(cells[i], false));
        std::copy(of_cell.begin(), of_cell.end(), sums.begin() + index_of(i * SamplesPerCell));
    });
    work_.team.sum(sums);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (is_single_texel(cells[i]))
            continue;
        const auto of_cell = std::span(sums).subspan(i * SamplesPerCell, SamplesPerCell);
        const double most = static_cast<double>(*std::max_element(of_cell.begin(), of_cell.end()));
        if (!(most * SquaredDistanceUnit < allowed_))
            levels[i] = std::max<std::uint8_t>(
                1, WorkEstimate::expected_depth(most * SquaredDistanceUnit / allowed_));
    }
    return levels;
}

LeafColumn Clustering::column(const Cell& cell) const {
    const bool is_texel = is_single_texel(cell);
    return leaf_column(normals_, planes_->samples_of(cell, is_texel),
                       is_texel ? CentreWeights : SampleWeights, origins_.size());
}

/// Refuses more clusters and bytes than there may be, once the cells of the batch's begin are
/// decided.
void Clustering::check_limits(std::span<const std::uint8_t> levels,
                              std::span<const LeafColumn> columns) const {
    const auto num_found =
        static_cast<std::size_t>(std::count(levels.begin(), levels.end(), std::uint8_t{0}));
    // Every waiting cell becomes one cluster at least.
    const std::size_t num_waiting =
        batch_.size() - levels.size() + pending_.size() + 4 * (levels.size() - num_found);
    const std::size_t num_all = clusters_.size() + num_found + num_waiting;
    if (options_.most_clusters && num_all > *options_.most_clusters)
        throw TooManyClusters();
    const std::size_t num_words = (origins_.size() / BlockSize + 63) / 64;
    LeafColumn empty;
    empty.visible.resize(num_words);
    empty.mixed.resize(num_words);
    std::uint64_t num_bytes = column_bytes_ + num_waiting * bytes_of(empty, context_.column_scale);
    for (std::size_t i = 0; i < levels.size(); ++i)
        num_bytes += levels[i] == 0 ? bytes_of(columns[i], context_.column_scale) : 0;
    num_bytes = largest_of_all(work_.team, num_bytes > options_.max_column_bytes ? num_bytes : 0);
    if (num_bytes != 0)
        throw TooLarge("clusters", num_all, num_bytes);
}

/// Keeps the clusters, goes on with the children of the other cells, and forgets the planes that
/// nothing needs any more [JN, Section 4]. Decided cells leave the batch in slices, of which a
/// column takes at most a byte per receiver. So memory can be watched, and checkpoints can be saved
/// between slices.
void Clustering::decide_batch() {
    const std::size_t max_slice = std::max<std::size_t>(64, BytesPerSlice / order_.size());
    while (!batch_.empty()) {
        const std::span<const Cell> slice =
            std::span<const Cell>(batch_).first(std::min(max_slice, batch_.size()));
        const std::vector<std::uint8_t> levels = levels_below(slice);
        std::vector<LeafColumn> columns(slice.size());
        files::parallel_for(std::size_t{0}, slice.size(), [&](std::size_t i) {
            progress_.poll();
            if (levels[i] == 0)
                columns[i] = column(slice[i]);
        });
        check_limits(levels, columns);
        for (std::size_t i = 0; i < slice.size(); ++i) {
            ++depths_[levels[i]];
            if (levels[i] == 0)
                add_cluster({slice[i], std::exchange(columns[i], {})});
            else
                for (std::uint32_t child = 0; child < 4; ++child)
                    pending_.push(slice[i].child(child));
        }
        batch_.erase(batch_.begin(), batch_.begin() + index_of(slice.size()));
        if (!batch_.empty())
            steps_.look_up();
    }
    planes_->keep_only(needed_points(pending_.cells()));
}

Steps::Content Clustering::content() const {
    return {.record = num_saved_ == clusters_.size()
                          ? std::vector<std::byte>()
                          : clusters_record(clusters_, *columns_, num_saved_),
            .state = work_state(batch_, pending_, *planes_)};
}

void Clustering::work() {
    while (!batch_.empty() || !pending_.empty()) {
        if (batch_.empty())
            take_batch();
        const auto start = std::chrono::steady_clock::now();
        const std::uint32_t level = batch_.front().level;
        depths_.fill(0);
        trace_batch();
        decide_batch();
        estimate_.add(level, depths_, files::seconds_since(start));
        steps_.look_up();
    }
}

Transfer Clustering::run(PrecomputeStatistics& statistics) {
    Checkpoint::Saved saved = steps_.load(true);
    if (saved.state.empty())
        start();
    else
        resume(saved);
    saved = {};
    patches_per_step_ = largest_of_all(work_.team, patches_per_step());
    steps_.run([this] { work(); });
    std::array<std::int64_t, 1> num_rays = {static_cast<std::int64_t>(planes_->num_rays())};
    work_.team.sum(num_rays);
    statistics.num_directions = planes_->num_directions();
    statistics.num_rays = static_cast<std::uint64_t>(num_rays[0]);
    statistics.num_own_rays = planes_->num_rays();
    statistics.column_bytes = column_bytes_;
    statistics.plane_bytes = most_planes_ * planes_->num_words() * sizeof(std::uint64_t);
    statistics.deepest_level = deepest_;
    statistics.seconds_checkpoints = steps_.seconds_saving();
    return result();
}

Transfer Clustering::result() {
    planes_.reset();
    return_free_memory();
    std::vector<std::uint32_t> order(clusters_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
        return z_curve_key(clusters_[a]) < z_curve_key(clusters_[b]);
    });
    std::vector<Cell> leaves(order.size());
    std::transform(order.begin(), order.end(), leaves.begin(),
                   [this](std::uint32_t cluster) { return clusters_[cluster]; });
    auto next = leaves.begin();
    const auto is_split = [&](const Cell& cell) {
        return *next == cell ? (++next, false) : true;
    };
    return {.quadtree = Quadtree::of(is_split),
            .order = std::move(order_),
            .normals = std::move(ordered_normals_),
            .counts = columns_->take(order),
            .num_points = num_points_};
}

} // namespace relumine::prt
