// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN], Section 4.
#include "prt/precompute.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "prt/cluster_kernels.h"
#include "prt/lattice.h"
#include "prt/receiver_order.h"
#include "prt/visibility_planes.h"

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
    require(options.min_level <= MaxLevel,
            fmt::format("expected a minimum depth from 0 to {}, got {}", MaxLevel, options.min_level));
    require(std::isfinite(options.bias) && options.bias >= 0.0f,
            fmt::format("expected a bias >= 0, got {}", options.bias));
}

/// The largest ||T_C - T_l||^2, T times pi, that a cluster may have [JN, Eq. 11].
double allowed_squared_distance(const PrecomputeOptions& options, std::size_t num_receivers) {
    const auto n = static_cast<double>(num_receivers);
    const double distance = options.epsilon ? static_cast<double>(*options.epsilon) * n
                                            : static_cast<double>(options.tolerance) * std::sqrt(n);
    const double times_pi = distance * std::numbers::pi;
    return times_pi * times_pi;
}

/// Says how far the work is. Most of the time goes into the deepest levels, so a level's share of the scale is the part of the
/// sphere that it settles; within a level the rays traced so far move the bar.
class Progress {
public:
    explicit Progress(const PrecomputeOptions& options) : options_(options) {}

    void start_level(double begin, double end) {
        begin_ = begin;
        end_ = end;
    }
    /// `part` of the level is traced. Called by the working threads; ends the work by an exception when asked to.
    void report(double part) {
        poll();
        if (!options_.on_progress)
            return;
        const std::scoped_lock lock(mutex_);
        const double fraction = begin_ + (end_ - begin_) * part;
        if (fraction > last_)
            options_.on_progress(last_ = fraction);
    }
    void poll() const {
        if (options_.stop.stop_requested())
            throw Cancelled();
    }

private:
    const PrecomputeOptions& options_;
    double begin_ = 0.0;
    double end_ = 0.0;
    double last_ = 0.0;
    std::mutex mutex_;
};

/// Breadth first: all cells of one level, on all faces, at a time.
class Clustering {
public:
    Clustering(const Receivers& receivers, const Blockers& blockers, const PrecomputeOptions& options)
        : options_(options), order_(spatial_order(receivers)), progress_(options),
          max_level_(static_cast<std::uint32_t>(std::bit_width(options.face_resolution - 1))),
          allowed_(allowed_squared_distance(options, receivers.size())) {
        for (const std::uint32_t receiver : order_) {
            const glm::vec3& normal = receivers.normals[receiver];
            ordered_normals_.push_back(normal);
            origins_.push_back(ray_origin(receivers.positions[receiver], normal, options.bias));
        }
        normals_ = NormalArrays(ordered_normals_);
        planes_.emplace(origins_, normals_, blockers);
    }

    Transfer run(PrecomputeStatistics& statistics);

private:
    /// A cell that became a cluster, or (column empty) one that was split.
    struct Decision {
        Cell cell;
        std::optional<LeafColumn> column;
    };

    std::vector<Cell> first_cells() const;
    std::vector<LatticePoint> needed_points(const std::vector<Cell>& cells) const;
    Decision decide(const Cell& cell) const;
    [[nodiscard]] bool is_single_texel(const Cell& cell) const { return cell.level == max_level_; }

    const PrecomputeOptions& options_;
    std::vector<std::uint32_t> order_;
    std::vector<glm::vec3> ordered_normals_;
    std::vector<glm::vec3> origins_;
    NormalArrays normals_;
    std::optional<VisibilityPlanes> planes_;
    Progress progress_;
    std::uint32_t max_level_; ///< where a cell is one texel of a 6 x R x R environment
    double allowed_;
};

std::vector<Cell> Clustering::first_cells() const {
    std::vector<Cell> cells;
    cells.reserve(cubemap::NumFaces);
    for (const cubemap::Face face : cubemap::AllFaces)
        cells.push_back({.face = face});
    for (std::uint32_t level = 0; level < std::min(options_.min_level, max_level_); ++level) {
        std::vector<Cell> children;
        for (const Cell& cell : cells)
            for (std::uint32_t i = 0; i < 4; ++i)
                children.push_back(cell.child(i));
        cells = std::move(children);
    }
    return cells;
}

/// Siblings follow each other in `cells`, so the sixteen new points of a split follow each other here: one packet.
std::vector<LatticePoint> Clustering::needed_points(const std::vector<Cell>& cells) const {
    std::vector<LatticePoint> points;
    for (const Cell& cell : cells) {
        const std::array<LatticePoint, SamplesPerCell> of_cell = lattice_points(cell);
        if (is_single_texel(cell))
            points.push_back(of_cell[CentreSample]);
        else
            points.insert(points.end(), of_cell.begin(), of_cell.end());
    }
    return points;
}

Clustering::Decision Clustering::decide(const Cell& cell) const {
    CellSamples samples;
    const std::array<LatticePoint, SamplesPerCell> points = lattice_points(cell);
    // A domain of one light has that light's transfer [JN, Section 4.1].
    if (is_single_texel(cell)) {
        samples.lit.fill(planes_->plane(points[CentreSample]));
        constexpr std::array<std::uint8_t, SamplesPerCell> CentreOnly = {0, 0, 0, 0, FullCount, 0, 0, 0, 0};
        return {cell, leaf_column(samples, CentreOnly, origins_.size())};
    }
    for (std::size_t l = 0; l < SamplesPerCell; ++l) {
        samples.directions[l] = direction(points[l]);
        samples.lit[l] = planes_->plane(points[l]);
    }
    const std::array<double, SamplesPerCell> distances = squared_distances(normals_, samples);
    const bool similar =
        std::all_of(distances.begin(), distances.end(), [&](double d) { return d < allowed_; });
    if (!similar)
        return {cell, std::nullopt};
    return {cell, leaf_column(samples, SampleWeights, origins_.size())};
}

/// Depth-first order of cells of any level: by face, then along the Z curve.
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

Transfer Clustering::run(PrecomputeStatistics& statistics) {
    std::vector<Decision> clusters;
    std::vector<Cell> cells = first_cells();
    double settled = 0.0; // part of the cube's surface that is clustered
    while (!cells.empty()) {
        // Trace what this level's cells need and forget what they do not.
        const std::vector<LatticePoint> points = needed_points(cells);
        planes_->keep_only(points);
        const double level_area = 1.0 - settled;
        progress_.start_level(settled, settled + 0.5 * level_area);
        // A patch is at most four cells wide, which is as far as the new points of four splits of siblings reach.
        const double patch_width = 4 * 2.0 * cells.front().size();
        planes_->trace(points, patch_width, [this](double part) { progress_.report(part); });

        // Test every cell on its own.
        std::vector<Decision> decisions(cells.size());
        tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
            progress_.poll();
            decisions[i] = decide(cells[i]);
        });

        // Keep the clusters, go on with the children of the rest.
        std::vector<Cell> children;
        for (Decision& decision : decisions) {
            if (decision.column) {
                settled += decision.cell.size() * decision.cell.size() / cubemap::NumFaces;
                statistics.deepest_level =
                    std::max<std::uint32_t>(statistics.deepest_level, decision.cell.level);
                clusters.push_back(std::move(decision));
                continue;
            }
            for (std::uint32_t i = 0; i < 4; ++i)
                children.push_back(decision.cell.child(i));
        }
        cells = std::move(children);
    }
    statistics.num_directions = planes_->num_directions();
    statistics.num_rays = planes_->num_rays();
    planes_.reset();
    // The planes' memory, thousands of blocks of some 10 kB, would stay with the process until its end, unused.
#ifdef __GLIBC__
    malloc_trim(0);
#endif

    std::sort(clusters.begin(), clusters.end(), [](const Decision& a, const Decision& b) {
        return depth_first_key(a.cell) < depth_first_key(b.cell);
    });
    std::vector<Cell> leaves;
    std::vector<LeafColumn> columns;
    for (Decision& cluster : clusters) {
        leaves.push_back(cluster.cell);
        columns.push_back(std::move(*cluster.column));
    }
    const std::size_t num_receivers = order_.size();
    return {.quadtree = quadtree_of(leaves),
            .order = std::move(order_),
            .normals = std::move(ordered_normals_),
            .counts = counts_from_columns(std::move(columns), num_receivers)};
}

} // namespace

Transfer precompute(const Receivers& receivers, const Blockers& blockers, const PrecomputeOptions& options,
                    PrecomputeStatistics* statistics) {
    check(receivers, options);
    const auto start = std::chrono::steady_clock::now();
    PrecomputeStatistics local;
    Transfer transfer = Clustering(receivers, blockers, options).run(local);
    local.num_clusters = transfer.num_clusters();
    local.num_samples = local.num_directions * receivers.size();
    local.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (statistics != nullptr)
        *statistics = local;
    return transfer;
}

} // namespace relumine::prt
