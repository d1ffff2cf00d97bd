// Based on the precompute of Johan and Nishita [JN, Section 4], for a part of its pairs.
#include "prt/moves/recount.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <unordered_map>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "files/parallel.h"
#include "files/seconds.h"
#include "prt/clusters/cluster_kernels.h"
#include "prt/clusters/horizon.h"
#include "prt/clusters/lattice.h"
#include "prt/clusters/visibility_planes.h"
#include "prt/moves/met_boxes.h"
#include "prt/steps.h"
#include "prt/visibility/bit_matrix.h"
#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

namespace {

constexpr std::size_t BlocksPerGroup = ReceiverGroup::MaxSize / BlockSize;
constexpr std::size_t WordsPerGroup = ReceiverGroup::MaxSize / WordSize;

/// The rectangle that directions fill on a plane before them.
class PatchExtent {
public:
    explicit PatchExtent(const glm::vec3& first) {
        const glm::vec3 size = glm::abs(first);
        axis_ = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        sign_ = first[axis_] > 0.0f ? 1.0f : -1.0f;
    }

    /// Adds a direction whose neighbours are so far away, unless the rectangle becomes wider than
    /// beams take, or than twice as many directions would fill.
    bool include(const glm::vec3& direction, float spacing) {
        constexpr float LeastAlong = 0.45f, Widest = 1.0f; // narrower than PatchPlane::narrow
        const float along = sign_ * direction[axis_];
        if (along < LeastAlong)
            return false;
        const glm::vec2 place =
            glm::vec2(direction[(axis_ + 1) % 3], direction[(axis_ + 2) % 3]) / along;
        const glm::vec2 low = glm::min(low_, place), high = glm::max(high_, place);
        const float most = std::min(
            Widest, spacing * (3.0f + 1.5f * std::sqrt(static_cast<float>(num_directions_))));
        if (num_directions_ != 0 && std::max(high.x - low.x, high.y - low.y) > most)
            return false;
        low_ = low;
        high_ = high;
        ++num_directions_;
        return true;
    }

private:
    int axis_ = 0;
    float sign_ = 1.0f;
    std::size_t num_directions_ = 0;
    glm::vec2 low_{std::numeric_limits<float>::infinity()};
    glm::vec2 high_{-std::numeric_limits<float>::infinity()};
};

/// The directions in which the clusters are sampled. Neighbours in the quadtree stand side by side.
struct Samples {
    std::vector<LatticePoint> points;
    std::vector<glm::vec3> directions;
    InverseDirections inverses;
    /// Distances to neighbours on the cube [-1, 1]^3
    std::vector<float> spacings;
    /// [clusters] indices of the nine points; those of a cell that is_single() are all its centre
    std::vector<std::array<std::uint32_t, SamplesPerCell>> of_cluster;
    /// The clusters of each point: those of point i are [begin[i], begin[i + 1]).
    std::vector<std::uint32_t> begin, clusters;

    Samples(const Quadtree& quadtree, const RecountOptions& options) {
        const std::uint32_t max_level = texel_level(options.face_resolution);
        std::unordered_map<LatticePoint, std::uint32_t> indices;
        for (const Cell& cell : quadtree.leaves()) {
            const bool takes_centre =
                cell.level == max_level ||
                (!options.coarse.empty() && options.coarse[of_cluster.size()]);
            const std::array<LatticePoint, SamplesPerCell> own = lattice_points(cell);
            auto& of_cell = of_cluster.emplace_back();
            for (std::size_t l = 0; l < SamplesPerCell; ++l) {
                const LatticePoint point = own[takes_centre ? CentreSample : l];
                const auto [entry, is_new] =
                    indices.try_emplace(point, static_cast<std::uint32_t>(points.size()));
                of_cell[l] = entry->second;
                if (!is_new)
                    continue;
                points.push_back(point);
                directions.push_back(direction(point));
                inverses.add(directions.back());
                spacings.push_back(static_cast<float>(cell.size()));
            }
        }
        begin.assign(points.size() + 1, 0);
        for_pairs([this](std::uint32_t point, std::uint32_t) { ++begin[point + 1]; });
        for (std::size_t i = 0; i < points.size(); ++i)
            begin[i + 1] += begin[i];
        clusters.resize(begin.back());
        std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
        for_pairs(
            [&](std::uint32_t point, std::uint32_t cluster) { clusters[next[point]++] = cluster; });
    }

    [[nodiscard]] bool is_single(std::uint32_t cluster) const {
        return of_cluster[cluster][0] == of_cluster[cluster][1];
    }

private:
    template<typename Visit>
    void for_pairs(const Visit& visit) const {
        for (std::uint32_t cluster = 0; cluster < of_cluster.size(); ++cluster) {
            for (std::size_t l = 0; l < (is_single(cluster) ? 1 : SamplesPerCell); ++l)
                visit(of_cluster[cluster][l], cluster);
        }
    }
};

/// What a group of receivers finds, before it is known which words it shares with others.
struct Found {
    CountsPatch patch;
    std::uint64_t num_pairs = 0, num_rays = 0;
};

class Recount {
public:
    Recount(const Receivers& receivers, const Blockers& blockers, const Transfer& transfer,
            const SceneDifference& difference, const RecountOptions& options)
        : receivers_(receivers), blockers_(blockers), transfer_(transfer), difference_(difference),
          bias_(options.bias), blocks_(options.blocks), samples_(transfer.quadtree, options) {}

    [[nodiscard]] std::size_t num_groups() const {
        return (transfer_.counts.num_blocks() + BlocksPerGroup - 1) / BlocksPerGroup;
    }

    /// Counts the blocks of a group anew where they may differ.
    [[nodiscard]] Found group(std::size_t index) const {
        thread_local Scratch scratch;
        Group group = group_at(index);
        scratch.begin(samples_);
        find_clusters(group, scratch);
        Found found;
        if (scratch.clusters.empty())
            return found;
        trace(group, scratch, found);
        count(group, scratch, found);
        scratch.end();
        return found;
    }

private:
    struct Group {
        std::size_t first_block = 0, num_blocks = 0;
        std::vector<glm::vec3> origins, normals;
        NormalArrays arrays;
        /// Boxes around origins and normals of the blocks
        std::array<mesh::Bounds, BlocksPerGroup> places, facing;
        /// A bit for each block with a receiver that differs
        std::uint8_t whole = 0;
    };

    /// What is found of a group. A bit stands for a block.
    struct Scratch {
        /// [clusters], [points] to be counted, to be traced
        std::vector<std::uint8_t> of_cluster, of_point;
        /// [points] index among `traced`
        std::vector<std::uint32_t> index;
        /// Ascending
        std::vector<std::uint32_t> clusters, traced;
        std::vector<std::array<std::uint64_t, WordsPerGroup>> planes;

        void begin(const Samples& samples) {
            of_cluster.resize(samples.of_cluster.size());
            of_point.resize(samples.points.size());
            index.resize(samples.points.size());
        }
        void add(std::uint32_t cluster, std::uint8_t blocks) {
            if (of_cluster[cluster] == 0)
                clusters.push_back(cluster);
            of_cluster[cluster] |= blocks;
        }
        void end() {
            for (const std::uint32_t cluster : clusters)
                of_cluster[cluster] = 0;
            for (const std::uint32_t point : traced)
                of_point[point] = 0;
            clusters.clear();
            traced.clear();
        }
    };

    [[nodiscard]] Group group_at(std::size_t index) const {
        Group group;
        group.first_block = index * BlocksPerGroup;
        const std::size_t first = group.first_block * BlockSize;
        const std::size_t size =
            std::min(transfer_.num_receivers() - first, ReceiverGroup::MaxSize);
        group.num_blocks = (size + BlockSize - 1) / BlockSize;
        group.places.fill(no_box());
        group.facing.fill(no_box());
        for (std::size_t i = 0; i < size; ++i) {
            const std::uint32_t receiver = transfer_.order[first + i];
            const glm::vec3& normal = receivers_.normals[receiver];
            group.normals.push_back(normal);
            group.origins.push_back(ray_origin(receivers_.positions[receiver], normal, bias_));
            include(group.places[i / BlockSize], group.origins.back());
            include(group.facing[i / BlockSize], normal);
            if (difference_.receivers[receiver])
                group.whole |= static_cast<std::uint8_t>(1u << (i / BlockSize));
        }
        const std::size_t num_points =
            std::min(std::max(transfer_.num_points, first) - first, size);
        group.arrays = NormalArrays(group.normals, num_points);
        return group;
    }

    /// Finds which blocks count which clusters anew, and which samples they need.
    void find_clusters(const Group& group, Scratch& scratch) const {
        const bool are_differing = blocks_ == Recounted::All || blocks_ == Recounted::Differing;
        if (group.whole != 0 && are_differing)
            for (std::uint32_t cluster = 0; cluster < samples_.of_cluster.size(); ++cluster)
                scratch.add(cluster, group.whole);
        if (blocks_ != Recounted::Differing)
            find_met(group, scratch);
        std::sort(scratch.clusters.begin(), scratch.clusters.end());
        for (const std::uint32_t cluster : scratch.clusters)
            for (const std::uint32_t point : samples_.of_cluster[cluster]) {
                if (scratch.of_point[point] == 0)
                    scratch.traced.push_back(point);
                scratch.of_point[point] |= scratch.of_cluster[cluster];
            }
        std::sort(scratch.traced.begin(), scratch.traced.end());
    }

    /// Finds the clusters with a sample whose rays may meet the boxes.
    void find_met(const Group& group, Scratch& scratch) const {
        mesh::Bounds place = no_box();
        std::vector<MetBoxes> boxes;
        for (std::size_t block = 0; block < group.num_blocks; ++block) {
            include(place, group.places[block]);
            boxes.emplace_back(difference_.boxes, group.places[block]);
        }
        const MetBoxes from_group(difference_.boxes, place);
        const std::span<const InverseDirections::Word> words = samples_.inverses.words();
        for (std::size_t word = 0; word < words.size(); ++word) {
            const std::uint64_t met = from_group.meeting(words[word], samples_.inverses.bits(word));
            if (met == 0)
                continue;
            for (std::size_t block = 0; block < group.num_blocks; ++block)
                if ((group.whole >> block & 1u) == 0)
                    add_met(word * InverseDirections::WordSize,
                            boxes[block].meeting(words[word], met), group, block, scratch);
        }
    }

    /// Adds the clusters of samples, a bit each from the first on, for a block that may see them.
    void add_met(std::size_t first, std::uint64_t met, const Group& group, std::size_t block,
                 Scratch& scratch) const {
        for (; met != 0; met &= met - 1) {
            const std::size_t point = first + static_cast<std::size_t>(std::countr_zero(met));
            if (!may_be_above(group.facing[block], samples_.directions[point]))
                continue;
            for (std::uint32_t i = samples_.begin[point]; i < samples_.begin[point + 1]; ++i)
                if (blocks_ != Recounted::Covered ||
                    !is_hidden(group.first_block + block, samples_.clusters[i]))
                    scratch.add(samples_.clusters[i], static_cast<std::uint8_t>(1u << block));
        }
    }

    /// Whether a direction may be above the horizon of one of the normals in a box. Points without
    /// a surface have a normal of 0.
    static bool may_be_above(const mesh::Bounds& normals, const glm::vec3& direction) {
        constexpr float Slack = 1e-5f;
        const glm::vec3 most = glm::max(normals.min * direction, normals.max * direction);
        return most.x + most.y + most.z > -Slack;
    }

    /// Patches are narrow, as beams want them, and not much wider than their directions ask for.
    void trace(const Group& group, Scratch& scratch, Found& found) const {
        scratch.planes.resize(scratch.traced.size());
        for (std::size_t first = 0; first < scratch.traced.size();) {
            DirectionPatch patch;
            PatchExtent extent(samples_.directions[scratch.traced[first]]);
            std::size_t end = first;
            for (; end < scratch.traced.size() && !patch.full(); ++end) {
                const std::uint32_t point = scratch.traced[end];
                if (!extent.include(samples_.directions[point], samples_.spacings[point]))
                    break;
                patch.add(samples_.directions[point]);
                scratch.index[point] = static_cast<std::uint32_t>(end);
            }
            trace(group, patch, first, scratch, found);
            first = end;
        }
    }

    /// Traces the directions from `first` on.
    void trace(const Group& group, const DirectionPatch& patch, std::size_t first, Scratch& scratch,
               Found& found) const {
        const std::size_t size = group.origins.size();
        std::array<std::uint64_t, ReceiverGroup::MaxSize> rays{}; // [receiver], a bit per direction
        const std::span<std::uint64_t> of_group(rays.data(), size);
        directions_above_horizon(group.arrays, 0, patch, of_group);
        std::array<std::uint64_t, BlocksPerGroup> asked{};
        for (std::size_t j = 0; j < patch.num_directions; ++j)
            for (std::size_t block = 0; block < BlocksPerGroup; ++block)
                asked[block] |=
                    std::uint64_t{scratch.of_point[scratch.traced[first + j]] >> block & 1u} << j;
        glm::vec3 mean_normal(0.0f);
        std::uint64_t num_rays = 0;
        for (std::size_t i = 0; i < size; ++i) {
            rays[i] &= asked[i / BlockSize];
            if (rays[i] == 0)
                continue;
            num_rays += static_cast<std::uint64_t>(std::popcount(rays[i]));
            mean_normal += group.normals[i];
        }
        if (num_rays != 0)
            blockers_.clear_blocked({group.origins, mean_normal}, patch, of_group);
        found.num_rays += num_rays;
        for (std::size_t word = 0; word < WordsPerGroup; ++word) {
            const std::span<std::uint64_t, WordSize> square(rays.data() + word * WordSize,
                                                            WordSize);
            transpose(square); // now [direction], a bit per receiver
            for (std::size_t j = 0; j < patch.num_directions; ++j)
                scratch.planes[first + j][word] = square[j];
        }
    }

    /// Makes the counts of the clusters, and keeps those that are others than the transfer's.
    void count(const Group& group, const Scratch& scratch, Found& found) const {
        std::array<CountsPatch::Word, BlocksPerGroup> words{};
        std::array<std::vector<std::uint8_t>, BlocksPerGroup> counts;
        const auto flush = [&] {
            for (std::size_t block = 0; block < group.num_blocks; ++block) {
                if (words[block].clusters == 0)
                    continue;
                words[block].first = found.patch.counts.size() / BlockSize;
                found.patch.words.push_back(words[block]);
                found.patch.counts.insert(found.patch.counts.end(), counts[block].begin(),
                                          counts[block].end());
                words[block] = {};
                counts[block].clear();
            }
        };
        std::uint32_t last = 0;
        for (const std::uint32_t cluster : scratch.clusters) {
            if (cluster / 64 != last / 64)
                flush();
            last = cluster;
            CellSamples samples;
            for (std::size_t l = 0; l < SamplesPerCell; ++l) {
                const std::uint32_t point = samples_.of_cluster[cluster][l];
                samples.directions[l] = samples_.directions[point];
                samples.lit[l] = scratch.planes[scratch.index[point]].data();
            }
            const LeafColumn column = leaf_column(
                group.arrays, samples, samples_.is_single(cluster) ? CentreWeights : SampleWeights,
                group.origins.size());
            const std::uint8_t* next = column.counts.data();
            for (std::size_t block = 0; block < group.num_blocks; ++block) {
                const bool are_counts = (column.mixed[0] >> block & 1u) != 0;
                std::span<const std::uint8_t> own(next, are_counts ? BlockSize : 0);
                next += own.size();
                if ((scratch.of_cluster[cluster] >> block & 1u) == 0)
                    continue;
                ++found.num_pairs;
                const bool is_visible = (column.visible[0] >> block & 1u) != 0;
                const std::size_t word =
                    transfer_.counts.word(group.first_block + block, cluster / 64);
                std::array<std::uint8_t, BlockSize> products{};
                if (blocks_ == Recounted::Covered) {
                    if (is_visible)
                        continue;
                    own = covered(word, cluster % 64, own, products);
                }
                if (is_known(word, cluster % 64, is_visible, own))
                    continue;
                const std::uint64_t bit = std::uint64_t{1} << cluster % 64;
                words[block].word = word;
                words[block].clusters |= bit;
                words[block].visible |= is_visible ? bit : 0;
                words[block].mixed |= own.empty() ? 0 : bit;
                counts[block].insert(counts[block].end(), own.begin(), own.end());
            }
        }
        flush();
    }

    /// Whether the transfer has these counts of a block and a cluster.
    [[nodiscard]] bool is_known(std::size_t word, std::uint32_t bit, bool is_visible,
                                std::span<const std::uint8_t> own) const {
        const VisibleCounts& counts = transfer_.counts;
        const bool was_mixed = (counts.mixed[word] >> bit & 1u) != 0;
        return is_visible == ((counts.visible[word] >> bit & 1u) != 0) &&
               was_mixed != own.empty() &&
               (!was_mixed || std::equal(own.begin(), own.end(), counts.mixed_counts(word, bit)));
    }

    /// Whether no receiver of a block sees anything of a cluster.
    [[nodiscard]] bool is_hidden(std::size_t block, std::uint32_t cluster) const {
        const std::size_t word = transfer_.counts.word(block, cluster / 64);
        return ((transfer_.counts.visible[word] | transfer_.counts.mixed[word]) >> cluster % 64 &
                1u) == 0;
    }

    /// Multiplies the transfer's counts of a block that is not hidden with what `passes`. Returns
    /// nothing where nothing is left.
    [[nodiscard]] std::span<const std::uint8_t>
    covered(std::size_t word, std::uint32_t bit, std::span<const std::uint8_t> passes,
            std::array<std::uint8_t, BlockSize>& products) const {
        const VisibleCounts& counts = transfer_.counts;
        const bool is_mixed = (counts.mixed[word] >> bit & 1u) != 0;
        bool is_any = false;
        for (std::size_t i = 0; i < passes.size(); ++i) {
            const unsigned before = is_mixed ? counts.mixed_counts(word, bit)[i] : 16u;
            products[i] = static_cast<std::uint8_t>((before * passes[i] + 8u) / 16u);
            is_any = is_any || products[i] != 0;
        }
        return std::span<const std::uint8_t>(products).first(is_any ? BlockSize : 0);
    }

    const Receivers& receivers_;
    const Blockers& blockers_;
    const Transfer& transfer_;
    const SceneDifference& difference_;
    float bias_;
    Recounted blocks_;
    Samples samples_;
};

} // namespace

std::vector<mesh::Bounds> boxes_around(const mesh::TriangleMesh& mesh) {
    const TriangleTree tree = triangle_tree(mesh.positions, mesh.triangles);
    std::vector<mesh::Bounds> boxes;
    if (tree.nodes.empty())
        return boxes;
    const TriangleTree::Node& root = tree.nodes.front();
    // What the tree rounds, and the sum with its centre.
    const glm::vec3 margin(0x1p-22f * (tree.extent + reach({tree.centre, tree.centre})));
    for (std::size_t lane = 0; lane < TriangleTree::Width; ++lane) {
        mesh::Bounds box;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.min[static_cast<int>(axis)] = root.bounds[axis][lane];
            box.max[static_cast<int>(axis)] = root.bounds[axis + 3][lane];
        }
        if (box.min.x <= box.max.x)
            boxes.push_back({box.min + tree.centre - margin, box.max + tree.centre + margin});
    }
    return boxes;
}

CountsPatch recounted(const Receivers& receivers, const Blockers& blockers,
                      const Transfer& transfer, const SceneDifference& difference,
                      const RecountOptions& options, const Work& work,
                      RecountStatistics* statistics) {
    const auto start = std::chrono::steady_clock::now();
    const Recount recount(receivers, blockers, transfer, difference, options);
    std::vector<Found> found(recount.num_groups());
    Progress progress(work);
    progress.start_stage(0.0, 1.0);
    std::atomic<std::size_t> num_done = 0;
    files::parallel_for(std::size_t{0}, found.size(), [&](std::size_t group) {
        progress.poll();
        found[group] = recount.group(group);
        progress.report(static_cast<double>(++num_done) / static_cast<double>(found.size()));
    });
    CountsPatch patch;
    RecountStatistics sums;
    for (Found& own : found) {
        patch.append(own.patch);
        sums.num_pairs += own.num_pairs;
        sums.num_rays += own.num_rays;
        own = {};
    }
    patch.sort();
    sums.num_changed = patch.num_pairs();
    sums.seconds = files::seconds_since(start);
    if (statistics != nullptr)
        *statistics = sums;
    return patch;
}

} // namespace relumine::prt
