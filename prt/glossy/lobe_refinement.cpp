#include "prt/glossy/lobe_refinement.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

#include "prt/clusters/lattice.h"
#include "prt/transfer/cell_index.h"

namespace relumine::prt {

namespace {

using Floats = BlockSurfaces::Floats;

/// Level of the first cells: nine samples see nothing between them, and visibility is known at a
/// finer level.
constexpr std::uint32_t FirstLevel = 2;

/// A guard against lobes of pure noise; no block needs so many cells.
constexpr std::size_t MaxCells = 16384;

constexpr std::uint32_t NoLeaf = std::numeric_limits<std::uint32_t>::max();

// A split looks at 5 x 5 points: the cell's own nine (even rows and columns) and sixteen new ones.
constexpr std::size_t GridWidth = 5;
constexpr std::size_t GridSize = GridWidth * GridWidth;
static_assert(GridSize - SamplesPerCell == PacketSize);

/// Returns the place of sample l of child i in a split's grid.
constexpr std::size_t grid_place(std::uint32_t child, std::size_t l) {
    const std::size_t right = child & 1u;
    const std::size_t below = child >> 1u;
    return (2 * below + l / 3) * GridWidth + 2 * right + l % 3;
}

constexpr bool is_new(std::size_t place) {
    return place / GridWidth % 2 == 1 || place % GridWidth % 2 == 1;
}

/// Column and row of a sample in a grid of samples, stored row by row.
double column(std::size_t sample, std::size_t width = 3) {
    return static_cast<double>(sample % width);
}
double row(std::size_t sample, std::size_t width = 3) {
    const std::size_t whole = sample / width;
    return static_cast<double>(whole);
}

/// A bit for each receiver.
using Lanes = std::uint16_t;

/// For each sample of a cell, the receivers that see the light there.
using SampleLanes = std::array<Lanes, SamplesPerCell>;

struct Node {
    Cell cell;
    /// The transfer's cluster that holds the whole cell, or NoLeaf.
    std::uint32_t leaf = NoLeaf;
    /// Receivers that see all of that cluster.
    Lanes full = 0;
    /// Receivers that see some of that cluster.
    Lanes partial = 0;
    /// For the partial receivers, where there is a leaf.
    SampleLanes lit{};
    /// dw mean (T - T_C)^2, summed over receivers.
    double error = 0.0;
    /// dw mean of the lobe's square, nothing blocked, summed over receivers.
    double power = 0.0;
    Floats mean{};
};

class LobeRefiner {
public:
    LobeRefiner(const BlockToRefine& block, GlossyLobe lobe, const Transfer& transfer,
                const Blockers& blockers, const RefinementLimits& limits)
        : block_(block), lobe_(lobe), mirrors_(block.mirrors(lobe)), transfer_(transfer),
          blockers_(blockers), limits_(limits) {}

    LobeCut run();

private:
    using GridValues = std::array<Floats, GridSize>;

    void add_first_cells();
    void split(const Node& parent);
    std::array<Lanes, GridSize> lit_grid(const Node& parent,
                                         const std::array<glm::vec3, GridSize>& directions,
                                         const GridValues& values);
    void add(Node node, const std::array<const Floats*, SamplesPerCell>& values);
    void find_leaf(Node& node) const;
    void weigh(Node& node, const std::array<const Floats*, SamplesPerCell>& values) const;
    std::array<Floats, SamplesPerCell> seen_parts(const Node& node) const;
    bool is_too_coarse(const Cell& cell) const;
    void trace(std::span<const glm::vec3> directions, std::span<const Floats* const> values,
               Lanes receivers, std::span<Lanes> lit);
    double budget() const;

    const BlockToRefine& block_;
    GlossyLobe lobe_;
    Mirrors mirrors_;
    const Transfer& transfer_;
    const Blockers& blockers_;
    const RefinementLimits& limits_;
    /// A heap of cells that may be split, largest error first: nodes are too large to be moved.
    struct Waiting {
        double error = 0.0;
        std::uint32_t node = 0;
    };
    static bool smaller_error(const Waiting& a, const Waiting& b) { return a.error < b.error; }
    std::vector<Waiting> heap_;
    /// All cells, also those that were split.
    std::vector<Node> nodes_;
    /// Cells that are single texels, in nodes_.
    std::vector<std::uint32_t> done_;
    /// Sums over all cells.
    double error_ = 0.0;
    double power_ = 0.0;
    std::uint64_t num_rays_ = 0;
};

LobeCut LobeRefiner::run() {
    add_first_cells();
    while (!heap_.empty() && heap_.front().error > 0.0 && error_ > budget() &&
           heap_.size() + done_.size() < MaxCells) {
        std::pop_heap(heap_.begin(), heap_.end(), smaller_error);
        const Node node = nodes_[heap_.back().node];
        heap_.pop_back();
        error_ -= node.error;
        power_ -= node.power;
        split(node);
    }
    using Key = std::pair<decltype(z_curve_key(Cell{})), std::uint32_t>;
    std::vector<Key> cut_cells;
    const auto keep = [&](std::uint32_t index) {
        const Floats& mean = nodes_[index].mean;
        if (*std::max_element(mean.begin(), mean.end()) > 0.0f)
            cut_cells.emplace_back(z_curve_key(nodes_[index].cell), index);
    };
    for (const Waiting& waiting : heap_)
        keep(waiting.node);
    for (const std::uint32_t index : done_)
        keep(index);
    std::sort(cut_cells.begin(), cut_cells.end());
    LobeCut cut{.cells = {}, .power = power_, .num_rays = num_rays_};
    for (const Key& key : cut_cells)
        cut.cells.push_back({nodes_[key.second].cell, nodes_[key.second].mean});
    return cut;
}

double LobeRefiner::budget() const {
    const double power =
        limits_.reference_power > 0.0 ? limits_.reference_power : power_ + limits_.added_power;
    return static_cast<double>(limits_.tolerance) * static_cast<double>(limits_.tolerance) * power;
}

void LobeRefiner::add_first_cells() {
    const std::uint32_t level = std::min(FirstLevel, limits_.max_level);
    const std::uint32_t width = 1u << level;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < width; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                Node node{.cell = {face, static_cast<std::uint8_t>(level), x, y}};
                std::array<glm::vec3, SamplesPerCell> directions;
                for (std::size_t l = 0; l < SamplesPerCell; ++l)
                    directions[l] = cubemap::direction(face, (x + 0.5 * column(l)) / width,
                                                       (y + 0.5 * row(l)) / width);
                std::array<Floats, SamplesPerCell> values;
                evaluate_lobe(block_.surfaces, lobe_, directions, values);
                std::array<const Floats*, SamplesPerCell> pointers;
                for (std::size_t l = 0; l < SamplesPerCell; ++l)
                    pointers[l] = &values[l];
                find_leaf(node);
                if (node.partial != 0)
                    trace(directions, pointers, node.partial, node.lit);
                add(node, pointers);
            }
}

/// Returns the receivers that the light at each point of a split's grid reaches. The cell's own
/// samples are known; the others are traced.
std::array<Lanes, GridSize> LobeRefiner::lit_grid(const Node& parent,
                                                  const std::array<glm::vec3, GridSize>& directions,
                                                  const GridValues& values) {
    std::array<Lanes, GridSize> lit{};
    std::array<glm::vec3, PacketSize> new_directions;
    std::array<const Floats*, PacketSize> new_values;
    std::array<std::size_t, PacketSize> places{};
    std::size_t num_new = 0;
    std::size_t num_old = 0;
    for (std::size_t i = 0; i < GridSize; ++i) {
        if (!is_new(i)) {
            lit[i] = parent.lit[num_old++];
            continue;
        }
        places[num_new] = i;
        new_directions[num_new] = directions[i];
        new_values[num_new++] = &values[i];
    }
    std::array<Lanes, PacketSize> new_lit{};
    trace(new_directions, new_values, parent.partial, new_lit);
    for (std::size_t i = 0; i < PacketSize; ++i)
        lit[places[i]] = new_lit[i];
    return lit;
}

void LobeRefiner::split(const Node& parent) {
    const double size = 0.25 * parent.cell.size();
    std::array<glm::vec3, GridSize> directions;
    for (std::size_t i = 0; i < GridSize; ++i)
        directions[i] =
            cubemap::direction(parent.cell.face, (4 * parent.cell.x + column(i, GridWidth)) * size,
                               (4 * parent.cell.y + row(i, GridWidth)) * size);
    GridValues values;
    evaluate_lobe(block_.surfaces, lobe_, directions, values);

    const std::array<Lanes, GridSize> lit = parent.leaf != NoLeaf && parent.partial != 0
                                                ? lit_grid(parent, directions, values)
                                                : std::array<Lanes, GridSize>{};
    for (std::uint32_t i = 0; i < 4; ++i) {
        Node child{.cell = parent.cell.child(i),
                   .leaf = parent.leaf,
                   .full = parent.full,
                   .partial = parent.partial};
        std::array<const Floats*, SamplesPerCell> of_child;
        for (std::size_t l = 0; l < SamplesPerCell; ++l) {
            of_child[l] = &values[grid_place(i, l)];
            child.lit[l] = lit[grid_place(i, l)];
        }
        if (parent.leaf == NoLeaf) {
            find_leaf(child);
            if (child.partial != 0) {
                std::array<glm::vec3, SamplesPerCell> of_samples;
                for (std::size_t l = 0; l < SamplesPerCell; ++l)
                    of_samples[l] = directions[grid_place(i, l)];
                trace(of_samples, of_child, child.partial, child.lit);
            }
        }
        add(child, of_child);
    }
}

void LobeRefiner::add(Node node, const std::array<const Floats*, SamplesPerCell>& values) {
    weigh(node, values);
    if (node.cell.level < limits_.max_level && is_too_coarse(node.cell) && node.power > 0.0) {
        split(node);
        return;
    }
    error_ += node.error;
    power_ += node.power;
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(node);
    if (node.cell.level == limits_.max_level) {
        done_.push_back(index);
        return;
    }
    heap_.push_back({node.error, index});
    std::push_heap(heap_.begin(), heap_.end(), smaller_error);
}

/// Whether a highlight may hide between the samples: the cell is wider than the highlight and wider
/// than its distance from the highlight.
bool LobeRefiner::is_too_coarse(const Cell& cell) const {
    const auto radius = static_cast<float>(1.42 * cell.size()); // half the longest diagonal
    const glm::vec3 centre =
        cubemap::direction(cell.face, (cell.x + 0.5) * cell.size(), (cell.y + 0.5) * cell.size());
    for (std::size_t i = 0; i < block_.origins.size(); ++i)
        if (mirrors_.narrowness[i] > 0.0f && radius > mirrors_.narrowness[i] &&
            radius > 0.7f * glm::distance(centre, mirrors_.mirror[i]))
            return true;
    return false;
}

/// Finds the cluster that holds the whole cell, and which receivers see all or some of it. Leaves
/// the node without a leaf where several clusters share the cell.
void LobeRefiner::find_leaf(Node& node) const {
    const double size = node.cell.size();
    const std::uint32_t leaf = transfer_.quadtree.leaf_at(
        {.face = node.cell.face, .s = (node.cell.x + 0.5) * size, .t = (node.cell.y + 0.5) * size});
    if (transfer_.quadtree.leaves()[leaf].level > node.cell.level)
        return;
    node.leaf = leaf;
    for (std::size_t i = 0; i < block_.origins.size(); ++i) {
        const int count = transfer_.counts.count(block_.block * BlockSize + i, leaf);
        const auto bit = static_cast<Lanes>(1u << i);
        if (count == FullCount)
            node.full = static_cast<Lanes>(node.full | bit);
        else if (count > 0)
            node.partial = static_cast<Lanes>(node.partial | bit);
    }
}

/// Returns the part of the light at each sample that reaches each receiver. Inside a cluster it is
/// 0 or 1. In a cell of several clusters it is the part of the sample's cluster that the receiver
/// sees.
std::array<Floats, SamplesPerCell> LobeRefiner::seen_parts(const Node& node) const {
    std::array<Floats, SamplesPerCell> parts{};
    for (std::size_t l = 0; l < SamplesPerCell; ++l) {
        if (node.leaf != NoLeaf) {
            const std::uint32_t seen = node.full | node.lit[l];
            for (std::size_t i = 0; i < BlockSize; ++i)
                parts[l][i] = static_cast<float>(seen >> i & 1u);
            continue;
        }
        // Samples lie on borders of cells, so move them a hair inside.
        constexpr double Inside = 1e-6;
        const double size = node.cell.size();
        const double s = (node.cell.x + 0.5 + (0.5 - Inside) * (column(l) - 1.0)) * size;
        const double t = (node.cell.y + 0.5 + (0.5 - Inside) * (row(l) - 1.0)) * size;
        const std::uint32_t leaf =
            transfer_.quadtree.leaf_at({.face = node.cell.face, .s = s, .t = t});
        for (std::size_t i = 0; i < block_.origins.size(); ++i)
            parts[l][i] =
                static_cast<float>(transfer_.counts.count(block_.block * BlockSize + i, leaf)) *
                (1.0f / FullCount);
    }
    return parts;
}

/// Sets the cell's mean, error and power from the lobe at its samples.
void LobeRefiner::weigh(Node& node, const std::array<const Floats*, SamplesPerCell>& values) const {
    const double size = node.cell.size();
    const double solid_angle = cubemap::solid_angle(
        node.cell.x * size, node.cell.y * size, (node.cell.x + 1) * size, (node.cell.y + 1) * size);
    std::array<Floats, SamplesPerCell> transfer = seen_parts(node);
    float power = 0.0f;
    for (std::size_t l = 0; l < SamplesPerCell; ++l) {
        float square = 0.0f;
        for (std::size_t i = 0; i < BlockSize; ++i) {
            const float value = (*values[l])[i];
            square += value * value;
            transfer[l][i] *= value;
        }
        power += square * (static_cast<float>(SampleWeights[l]) / FullCount);
    }
    node.power = solid_angle * static_cast<double>(power);
    // A domain of one light has that light's transfer [JN, Section 4.1].
    if (node.cell.level == limits_.max_level) {
        node.mean = transfer[CentreSample];
        return;
    }
    for (std::size_t l = 0; l < SamplesPerCell; ++l)
        for (std::size_t i = 0; i < BlockSize; ++i)
            node.mean[i] += transfer[l][i] * (static_cast<float>(SampleWeights[l]) / FullCount);
    float error = 0.0f;
    for (std::size_t l = 0; l < SamplesPerCell; ++l) {
        float square = 0.0f;
        for (std::size_t i = 0; i < BlockSize; ++i) {
            const float difference = transfer[l][i] - node.mean[i];
            square += difference * difference;
        }
        error += square * (static_cast<float>(SampleWeights[l]) / FullCount);
    }
    node.error = solid_angle * static_cast<double>(error);
}

/// For each direction, sets the bits of the `receivers` that its light reaches. Casts no ray where
/// the lobe is zero.
void LobeRefiner::trace(std::span<const glm::vec3> directions,
                        std::span<const Floats* const> values, Lanes receivers,
                        std::span<Lanes> lit) {
    DirectionPacket packet;
    packet.num_directions = static_cast<std::uint32_t>(directions.size());
    for (std::size_t i = 0; i < PacketSize; ++i)
        packet.set(i, directions[i < directions.size() ? i : 0]);
    for (std::uint32_t bits = receivers; bits != 0; bits &= bits - 1) {
        const auto receiver = static_cast<std::size_t>(std::countr_zero(bits));
        std::uint32_t active = 0;
        for (std::size_t i = 0; i < directions.size(); ++i)
            active |= static_cast<std::uint32_t>((*values[i])[receiver] > 0.0f) << i;
        if (active == 0)
            continue;
        num_rays_ += static_cast<std::uint64_t>(std::popcount(active));
        const std::uint32_t visible =
            active & ~blockers_.occluded(block_.origins[receiver], packet, active);
        for (std::uint32_t seen = visible; seen != 0; seen &= seen - 1) {
            Lanes& lanes = lit[static_cast<std::size_t>(std::countr_zero(seen))];
            lanes = static_cast<Lanes>(lanes | 1u << receiver);
        }
    }
}

} // namespace

LobeCut refine_lobe(const BlockToRefine& block, GlossyLobe lobe, const Transfer& transfer,
                    const Blockers& blockers, const RefinementLimits& limits) {
    return LobeRefiner(block, lobe, transfer, blockers, limits).run();
}

} // namespace relumine::prt
