#include "prt/clusters/coarsening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>
#include <unordered_set>
#include <vector>

#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "prt/clusters/cluster_kernels.h"
#include "prt/clusters/column_store.h"
#include "prt/clusters/horizon.h"
#include "prt/clusters/lattice.h"
#include "prt/clusters/shadow_edges.h"
#include "prt/steps.h"
#include "prt/transfer/cell_index.h"

namespace relumine::prt {

namespace {

/// Clusters that become one, [first, last).
struct LeafRange {
    std::uint32_t first = 0;
    std::uint32_t last = 0;
};

/// What the test of a cell looks at.
struct CellTest {
    std::array<glm::vec3, SamplesPerCell> directions{};
    /// [child][corner of the child] the cluster that touches the sample there
    std::array<std::array<std::uint32_t, 4>, 4> leaves{};
    /// Whether the child is one cluster.
    std::array<bool, 4> is_leaf{};
};

/// Blocks of a float sum, which then becomes a whole number: 1,024 receivers, as in
/// squared_distances().
constexpr std::size_t BlocksPerSum = VisibleCounts::TileBlocks;

/// Columns in memory beside the store.
constexpr std::size_t ColumnsAtOnce = 64;

/// Returns a point of the cell, (x, y) in 0..1 of its sides.
cubemap::FacePoint point_in(const Cell& cell, double x, double y) {
    return {cell.face, (cell.x + x) * cell.size(), (cell.y + y) * cell.size()};
}

/// How far from a sample its clusters are looked up: less than the finest cell.
double nudge(const Cell& cell) {
    return 0x1p-16 / cell.size();
}

LeafRange leaves_of(const Quadtree& tree, const Cell& cell) {
    const double near = nudge(cell);
    return {tree.leaf_at(point_in(cell, near, near)),
            tree.leaf_at(point_in(cell, 1.0 - near, 1.0 - near)) + 1};
}

std::array<glm::vec3, SamplesPerCell> sample_directions(const Cell& cell, bool is_texel) {
    std::array<glm::vec3, SamplesPerCell> directions;
    const std::array<LatticePoint, SamplesPerCell> points = lattice_points(cell);
    for (std::size_t l = 0; l < SamplesPerCell; ++l)
        directions[l] = direction(points[is_texel ? CentreSample : l]);
    return directions;
}

/// Returns the solid angle of a cell, by its middle; cells of a joined cluster are compared alone.
float solid_angle(const Cell& cell) {
    const glm::dvec3 middle = place_on_cube(lattice_points(cell)[CentreSample]);
    const double distance = glm::length(middle);
    return static_cast<float>(cell.size() * cell.size() / (distance * distance * distance));
}

CellTest test_of(const Quadtree& tree, const Cell& cell) {
    CellTest test{.directions = sample_directions(cell, false)};
    for (std::uint32_t child = 0; child < 4; ++child) {
        const Cell of_child = cell.child(child);
        const double near = nudge(of_child);
        for (std::uint32_t corner = 0; corner < 4; ++corner)
            test.leaves[child][corner] = tree.leaf_at(point_in(
                of_child, (corner & 1u) != 0 ? 1.0 - near : near, corner >= 2 ? 1.0 - near : near));
        test.is_leaf[child] = tree.leaves()[test.leaves[child][0]] == of_child;
    }
    return test;
}

/// Counts of a receiver where a cell's children have their corners, [child][corner].
using CornerCounts = std::array<std::array<std::uint8_t, 4>, 4>;

/// Returns the chance that a sample of a cell is lit, by what each child at the sample says of its
/// own corner there: the product of their chances.
float chance_of_sample(const ShadowEdges& edges, const CornerCounts& counts, std::size_t sample) {
    float lit = 1.0f, dark = 1.0f, sum = 0.0f, num = 0.0f;
    for (std::size_t child = 0; child < 4; ++child) {
        // Where the sample is in the child, in units of its side.
        const std::size_t x = sample % 3 - child % 2, y = sample / 3 - child / 2;
        if (x > 1 || y > 1)
            continue;
        const float chance = edges.corner(counts[child][2 * y + x]);
        lit *= chance;
        dark *= 1.0f - chance;
        sum += chance;
        num += 1.0f;
    }
    return lit + dark > 0.0f ? lit / (lit + dark) : sum / num;
}

class Coarsening {
public:
    Coarsening(const Transfer& transfer, const CoarsenOptions& options)
        : transfer_(transfer), counts_(transfer.counts), options_(options),
          normals_(transfer.normals, transfer.num_points),
          texel_level_(prt::texel_level(options.face_resolution)) {
        const double distance = static_cast<double>(options.tolerance) * std::numbers::pi;
        allowed_ = distance * distance * static_cast<double>(transfer.num_receivers());
        weights_.reserve(transfer.num_clusters());
        for (const Cell& cell : transfer.quadtree.leaves())
            weights_.push_back(solid_angle(cell));
    }

    /// Call it once.
    [[nodiscard]] Transfer run(const Work& work) const;

private:
    [[nodiscard]] bool holds(const Cell& cell) const;
    [[nodiscard]] ShadowEdges::Chances chances(const CellTest& test,
                                               const CornerCounts& counts) const;
    bool load_corners(std::size_t block, const CellTest& test,
                      std::span<CornerCounts, BlockSize> counts) const;
    void add_distances(std::size_t block, const CellTest& test,
                       std::span<float, SamplesPerCell> sums) const;
    [[nodiscard]] Quadtree tree(Progress& progress) const;
    [[nodiscard]] LeafColumn column(const Cell& cell) const;
    [[nodiscard]] LeafColumn stored_column(std::uint32_t leaf) const;
    void add_block(const LeafRange& leaves, std::size_t block, LeafColumn& column) const;
    void load_counts(std::size_t block, std::uint32_t leaf,
                     std::span<std::uint8_t, BlockSize> counts) const;

    const Transfer& transfer_;
    const VisibleCounts& counts_;
    const CoarsenOptions& options_;
    NormalArrays normals_;
    std::uint32_t texel_level_;
    /// The limit on ||T_C - T_l||^2 for a cluster, T times pi, as in Clustering.
    double allowed_ = 0.0;
    ShadowEdges edges_;
    /// [num_clusters]
    std::vector<float> weights_;
};

void Coarsening::load_counts(std::size_t block, std::uint32_t leaf,
                             std::span<std::uint8_t, BlockSize> counts) const {
    const std::size_t word = counts_.word(block, leaf / 64);
    const std::uint64_t bit = std::uint64_t{1} << leaf % 64;
    if ((counts_.mixed[word] & bit) != 0)
        std::copy_n(counts_.mixed_counts(word, leaf % 64), BlockSize, counts.begin());
    else
        std::fill(counts.begin(), counts.end(),
                  static_cast<std::uint8_t>((counts_.visible[word] & bit) != 0 ? FullCount : 0));
}

/// Returns the chances that the nine samples are lit for one receiver.
ShadowEdges::Chances Coarsening::chances(const CellTest& test, const CornerCounts& counts) const {
    std::array<std::uint8_t, 4> children;
    for (std::size_t child = 0; child < 4; ++child) {
        const std::array<std::uint8_t, 4>& of_child = counts[child];
        children[child] = static_cast<std::uint8_t>(
            (of_child[0] + of_child[1] + of_child[2] + of_child[3] + 2) / 4);
    }
    const ShadowEdges::Chances* const known = edges_.samples(children);
    const bool are_leaves = std::all_of(test.is_leaf.begin(), test.is_leaf.end(), std::identity());
    if (known != nullptr && are_leaves)
        return *known;
    ShadowEdges::Chances result;
    for (std::size_t l = 0; l < SamplesPerCell; ++l) {
        const std::size_t corner = 2 * (l / 6) + l % 3 / 2;
        const bool is_corner = l % 2 == 0 && l != CentreSample;
        result[l] = known != nullptr && is_corner && test.is_leaf[corner]
                        ? (*known)[l]
                        : chance_of_sample(edges_, counts, l);
    }
    return result;
}

/// Loads what a block of receivers sees where the children have their corners. Returns whether any
/// receiver sees anything.
bool Coarsening::load_corners(std::size_t block, const CellTest& test,
                              std::span<CornerCounts, BlockSize> counts) const {
    std::array<std::uint8_t, BlockSize> of_leaf{};
    std::uint8_t any = 0;
    for (std::size_t child = 0; child < 4; ++child)
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if (corner == 0 || !test.is_leaf[child])
                load_counts(block, test.leaves[child][corner], of_leaf);
            for (std::size_t i = 0; i < BlockSize; ++i) {
                counts[i][child][corner] = of_leaf[i];
                any |= of_leaf[i];
            }
        }
    return any != 0;
}

/// Adds what a block of receivers contributes to the mean of ||T_C - T_l||^2. Where a sample is lit
/// with the chance p, (T_C - T_l)^2 has the variance p (1 - p) of its visibility beside the square
/// of the means.
void Coarsening::add_distances(std::size_t block, const CellTest& test,
                               std::span<float, SamplesPerCell> sums) const {
    std::array<CornerCounts, BlockSize> counts;
    if (!load_corners(block, test, counts))
        return;
    std::array<ShadowEdges::Chances, BlockSize> lit;
    for (std::size_t i = 0; i < BlockSize; ++i)
        lit[i] = i != 0 && counts[i] == counts[i - 1] ? lit[i - 1] : chances(test, counts[i]);

    std::array<std::array<float, BlockSize>, SamplesPerCell> transfer{}, variance{};
    std::array<float, BlockSize> mean{};
    const std::size_t first = block * BlockSize;
    for (std::size_t l = 0; l < SamplesPerCell; ++l) {
        const glm::vec3& w = test.directions[l];
        const float weight = static_cast<float>(SampleWeights[l]) / FullCount;
        for (std::size_t i = 0; i < BlockSize; ++i) {
            const float cosine =
                std::max(normals_.x[first + i] * w.x + normals_.y[first + i] * w.y +
                             normals_.z[first + i] * w.z + normals_.w[first + i],
                         0.0f);
            transfer[l][i] = lit[i][l] * cosine;
            variance[l][i] = lit[i][l] * (1.0f - lit[i][l]) * cosine * cosine;
            mean[i] += weight * transfer[l][i];
        }
    }
    for (std::size_t l = 0; l < SamplesPerCell; ++l)
        for (std::size_t i = 0; i < BlockSize; ++i) {
            const float difference = transfer[l][i] - mean[i];
            sums[l] += difference * difference + variance[l][i];
        }
}

/// Returns whether a cell may be one cluster: the precompute's test of its nine samples.
bool Coarsening::holds(const Cell& cell) const {
    const CellTest test = test_of(transfer_.quadtree, cell);
    const double most_allowed = allowed_ / SquaredDistanceUnit;
    std::array<std::int64_t, SamplesPerCell> all{};
    for (std::size_t begin = 0; begin < counts_.num_blocks(); begin += BlocksPerSum) {
        std::array<float, SamplesPerCell> sums{};
        const std::size_t end = std::min(begin + BlocksPerSum, counts_.num_blocks());
        for (std::size_t block = begin; block < end; ++block)
            add_distances(block, test, sums);
        for (std::size_t l = 0; l < SamplesPerCell; ++l) {
            all[l] += std::llrint(double{sums[l]} / SquaredDistanceUnit);
            // Sums only grow.
            if (!(static_cast<double>(all[l]) < most_allowed))
                return false;
        }
    }
    return true;
}

/// Returns the tree: from the top, the first cells that pass, and what was not split before.
Quadtree Coarsening::tree(Progress& progress) const {
    std::unordered_set<std::uint32_t> split;
    std::vector<Cell> level;
    level.reserve(cubemap::NumFaces);
    for (const cubemap::Face face : cubemap::AllFaces)
        level.push_back({.face = face});
    for (double depth = 1.0; !level.empty(); ++depth) {
        std::vector<std::uint8_t> is_split(level.size());
        files::parallel_for(std::size_t{0}, level.size(), [&](std::size_t i) {
            progress.poll();
            const LeafRange leaves = leaves_of(transfer_.quadtree, level[i]);
            is_split[i] = leaves.last - leaves.first > 1 &&
                          (level[i].level < options_.min_level || !holds(level[i]));
        });
        std::vector<Cell> next;
        for (std::size_t i = 0; i < level.size(); ++i) {
            if (is_split[i] == 0)
                continue;
            split.insert(cell_index(level[i]));
            for (std::uint32_t child = 0; child < 4; ++child)
                next.push_back(level[i].child(child));
        }
        level = std::move(next);
        progress.report(depth / (MaxLevel + 1));
    }
    return Quadtree::of([&](const Cell& cell) { return split.contains(cell_index(cell)); });
}

LeafColumn Coarsening::stored_column(std::uint32_t leaf) const {
    LeafColumn column;
    column.visible.resize(counts_.num_tiles());
    column.mixed.resize(counts_.num_tiles());
    for (std::size_t block = 0; block < counts_.num_blocks(); ++block) {
        const std::size_t word = counts_.word(block, leaf / 64);
        const std::uint64_t of_block = std::uint64_t{1} << block % 64;
        if ((counts_.visible[word] >> leaf % 64 & 1u) != 0)
            column.visible[block / 64] |= of_block;
        if ((counts_.mixed[word] >> leaf % 64 & 1u) == 0)
            continue;
        column.mixed[block / 64] |= of_block;
        const std::uint8_t* const counts = counts_.mixed_counts(word, leaf % 64);
        column.counts.insert(column.counts.end(), counts, counts + BlockSize);
    }
    return column;
}

/// Adds the counts of a block: the mean of the clusters, each by what is above the horizon.
void Coarsening::add_block(const LeafRange& leaves, std::size_t block, LeafColumn& column) const {
    const std::span<const Cell> cells = transfer_.quadtree.leaves();
    std::array<float, BlockSize> seen{}, above{};
    for (std::uint32_t leaf = leaves.first; leaf < leaves.last; ++leaf) {
        std::array<std::uint8_t, BlockSize> counts;
        load_counts(block, leaf, counts);
        const bool is_texel = cells[leaf].level == texel_level_;
        const std::array<std::uint8_t, BlockSize> of_leaf =
            weights_of(samples_above_horizon(normals_, block * BlockSize,
                                             sample_directions(cells[leaf], is_texel)),
                       is_texel ? CentreWeights : SampleWeights);
        for (std::size_t i = 0; i < BlockSize; ++i) {
            const float weight = weights_[leaf] * static_cast<float>(of_leaf[i]);
            above[i] += weight;
            seen[i] += weight * static_cast<float>(counts[i]);
        }
    }
    std::array<std::uint8_t, BlockSize> result{};
    bool all = true, any = false;
    for (std::size_t i = 0; i < BlockSize; ++i) {
        if (above[i] > 0.0f)
            result[i] = static_cast<std::uint8_t>(
                std::min(std::lround(seen[i] / above[i]), long{FullCount}));
        any = any || result[i] != 0;
        all = all && (above[i] <= 0.0f || result[i] == FullCount);
    }
    const std::uint64_t of_block = std::uint64_t{1} << block % 64;
    if (any && all) {
        column.visible[block / 64] |= of_block;
    } else if (any) {
        column.mixed[block / 64] |= of_block;
        column.counts.insert(column.counts.end(), result.begin(), result.end());
    }
}

LeafColumn Coarsening::column(const Cell& cell) const {
    const LeafRange leaves = leaves_of(transfer_.quadtree, cell);
    if (leaves.last - leaves.first == 1)
        return stored_column(leaves.first);
    LeafColumn column;
    column.visible.resize(counts_.num_tiles());
    column.mixed.resize(counts_.num_tiles());
    for (std::size_t block = 0; block < counts_.num_blocks(); ++block) {
        std::uint32_t num_visible = 0, num_mixed = 0;
        for (std::uint32_t leaf = leaves.first; leaf < leaves.last; ++leaf) {
            const std::size_t word = counts_.word(block, leaf / 64);
            num_visible += static_cast<std::uint32_t>(counts_.visible[word] >> leaf % 64 & 1u);
            num_mixed += static_cast<std::uint32_t>(counts_.mixed[word] >> leaf % 64 & 1u);
        }
        if (num_visible == leaves.last - leaves.first)
            column.visible[block / 64] |= std::uint64_t{1} << block % 64;
        else if (num_visible + num_mixed != 0)
            add_block(leaves, block, column);
    }
    return column;
}

Transfer Coarsening::run(const Work& work) const {
    Progress progress(work);
    progress.start_stage(0.0, 0.5);
    Transfer result{.quadtree = tree(progress),
                    .order = transfer_.order,
                    .normals = transfer_.normals,
                    .counts = {},
                    .surfaces = transfer_.surfaces,
                    .glossy = transfer_.glossy,
                    .num_points = transfer_.num_points};
    progress.start_stage(0.5, 1.0);
    const std::span<const Cell> cells = result.quadtree.leaves();
    ColumnStore store(transfer_.num_receivers());
    for (std::size_t begin = 0; begin < cells.size(); begin += ColumnsAtOnce) {
        std::vector<LeafColumn> columns(std::min(ColumnsAtOnce, cells.size() - begin));
        files::parallel_for(std::size_t{0}, columns.size(), [&](std::size_t i) {
            progress.poll();
            columns[i] = column(cells[begin + i]);
        });
        for (const LeafColumn& column : columns)
            store.add(column);
        progress.report(static_cast<double>(begin + columns.size()) /
                        static_cast<double>(cells.size()));
    }
    std::vector<std::uint32_t> order(cells.size());
    std::iota(order.begin(), order.end(), 0u);
    result.counts = store.take(order);
    return result;
}

} // namespace

Transfer coarsened(const Transfer& transfer, const CoarsenOptions& options, const Work& work) {
    if (!(options.tolerance > 0.0f) || !std::isfinite(options.tolerance))
        throw std::invalid_argument("coarsen: expected a tolerance above 0");
    return Coarsening(transfer, options).run(work);
}

} // namespace relumine::prt
