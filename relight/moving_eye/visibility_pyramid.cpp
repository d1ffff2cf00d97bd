#include "relight/moving_eye/visibility_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "files/parallel.h"

namespace relumine::relight {

/// A cell of the quadtree. The faces come first.
struct VisibilityPyramid::Node {
    /// The first of four consecutive nodes; 0 for a cluster.
    std::uint32_t first_child = 0;
    /// Its clusters are [first_leaf, end_leaf).
    std::uint32_t first_leaf = 0, end_leaf = 0;
    /// Direction and solid angle.
    glm::vec4 cell{0.0f};

    [[nodiscard]] bool is_cluster() const { return first_child == 0; }
    /// Counts follow each other within a word of 64 clusters.
    [[nodiscard]] bool is_quad() const {
        return end_leaf - first_leaf == 4 && first_leaf / 64 == (end_leaf - 1) / 64;
    }
    [[nodiscard]] bool is_branch() const { return !is_cluster() && !is_quad(); }
};

/// What is kept of one block; links count from its own first entries.
struct VisibilityPyramid::BlockEntries {
    std::vector<std::uint8_t> parts, quad_sights;
    std::vector<Links> links;
    std::vector<std::uint32_t> quads;
};

namespace {

using Sums = std::array<float, prt::BlockSize>;

/// What lies below a block's horizon keeps so much of a weight: some of its receivers may look
/// there.
constexpr float LeastCosine = 0.02f;

/// Whether all bits of [first, end) are set, and whether none is.
struct RangeBits {
    bool all = true, none = true;
};
template<typename Word>
RangeBits bits_of(std::uint32_t first, std::uint32_t end, const Word& word) {
    RangeBits result;
    for (std::uint32_t w = first / 64; w * 64 < end && (result.all || result.none); ++w) {
        const std::uint32_t from = std::max(first, w * 64) - w * 64;
        const std::uint32_t to = std::min(end - w * 64, 64u);
        const std::uint64_t mask = (to == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << to) - 1) &
                                   ~((std::uint64_t{1} << from) - 1);
        const std::uint64_t set = word(w) & mask;
        result.all = result.all && set == mask;
        result.none = result.none && set == 0;
    }
    return result;
}

template<typename T>
void append_all(std::vector<T>& to, const std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

} // namespace

/// Finds the entries of one block after another.
class VisibilityPyramid::Builder {
public:
    Builder(const VisibilityPyramid& pyramid, std::span<const Node> nodes)
        : pyramid_(pyramid), nodes_(nodes), means_(nodes.size()), kinds_(nodes.size()) {}

    void run(std::size_t block, const glm::vec3& normal, std::span<Place> faces,
             BlockEntries& entries) {
        block_ = block;
        normal_ = normal;
        for (std::uint32_t face = 0; face < faces.size(); ++face) {
            Sums sums{};
            static_cast<void>(add(face, sums));
            // A branch's number counts branches alone; faces before this one may be none.
            std::uint32_t branch = 0, entry = 0;
            for (std::uint32_t i = 0; i < face; ++i)
                branch += nodes_[i].is_branch() ? 1 : 0;
            if (kinds_[face] == Kind::Cluster)
                entry = pyramid_.entry_of(block, nodes_[face].first_leaf);
            else if (is_inner(kinds_[face]))
                entry = open(face, entries);
            faces[face] = Place(kinds_[face], entry, branch);
        }
        for (std::uint32_t face = 0; face < faces.size(); ++face)
            if (kinds_[face] == Kind::Branch)
                descend(face, faces[face].entry(), entries);
    }

private:
    static bool is_inner(Kind kind) { return kind == Kind::Branch || kind == Kind::Quad; }

    /// Adds the visible parts of a node times its weight, which it returns; finds the kinds of the
    /// node and of what is mixed below it.
    float add(std::uint32_t index, Sums& sums) {
        const Node& node = nodes_[index];
        const prt::VisibleCounts& counts = pyramid_.counts_;
        const auto in_word = [&](const std::vector<std::uint64_t>& bits) {
            return bits_of(node.first_leaf, node.end_leaf,
                           [&](std::uint32_t w) { return bits[counts.word(block_, w)]; });
        };
        const RangeBits visible = in_word(counts.visible);
        const float own =
            node.cell.w * std::max(glm::dot(normal_, glm::vec3(node.cell)), LeastCosine);
        kinds_[index] = Kind::Hidden;
        if (visible.all) {
            kinds_[index] = Kind::Visible;
            for (float& sum : sums)
                sum += own;
            return own;
        }
        if (visible.none && in_word(counts.mixed).none)
            return own;
        if (node.is_cluster()) {
            kinds_[index] = Kind::Cluster;
            const std::uint8_t* seen = counts.mixed_counts(
                counts.word(block_, node.first_leaf / 64), node.first_leaf % 64);
            for (std::size_t i = 0; i < sums.size(); ++i)
                sums[i] += own / 16.0f * seen[i];
            return own;
        }
        kinds_[index] = node.is_quad() ? Kind::Quad : Kind::Branch;
        Sums below{};
        float weights = 0.0f;
        for (std::uint32_t i = 0; i < 4; ++i)
            weights += add(node.first_child + i, below);
        for (std::size_t i = 0; i < sums.size(); ++i)
            sums[i] += below[i];
        for (std::size_t i = 0; i < sums.size(); ++i)
            means_[index][i] =
                static_cast<std::uint8_t>(std::lround(std::min(below[i] / weights, 1.0f) * 255.0f));
        return weights;
    }

    /// Appends the entry of a mixed inner node. Returns its number.
    std::uint32_t open(std::uint32_t index, BlockEntries& entries) const {
        const Node& node = nodes_[index];
        unsigned sights = 0;
        std::uint32_t first_mixed = node.end_leaf;
        for (std::uint32_t i = 4; i-- > 0;) {
            const Kind kind = kinds_[node.first_child + i];
            if (kind == Kind::Visible)
                sights |= 1u << i;
            else if (kind != Kind::Hidden)
                sights |= 16u << i, first_mixed = node.first_leaf + i;
        }
        if (node.is_quad()) {
            entries.quad_sights.push_back(static_cast<std::uint8_t>(sights));
            entries.quads.push_back(
                first_mixed < node.end_leaf ? pyramid_.entry_of(block_, first_mixed) : 0);
            return static_cast<std::uint32_t>(entries.quads.size() - 1);
        }
        entries.parts.insert(entries.parts.end(), means_[index].begin(), means_[index].end());
        entries.links.emplace_back().sights = sights & 0xffu;
        return static_cast<std::uint32_t>(entries.links.size() - 1);
    }

    /// Appends what is mixed below a branch. Sisters come before what is below them, so their
    /// entries follow each other.
    void descend(std::uint32_t index, std::uint32_t entry, BlockEntries& entries) const {
        const std::uint32_t first = nodes_[index].first_child;
        entries.links[entry].to_branch =
            static_cast<std::uint32_t>(entries.links.size() - entry) & 0xffffffu;
        entries.links[entry].first_quad = static_cast<std::uint32_t>(entries.quads.size());
        std::array<std::uint32_t, 4> opened{};
        for (std::uint32_t i = 0; i < 4; ++i)
            if (is_inner(kinds_[first + i]))
                opened[i] = open(first + i, entries);
        for (std::uint32_t i = 0; i < 4; ++i)
            if (kinds_[first + i] == Kind::Branch)
                descend(first + i, opened[i], entries);
    }

    const VisibilityPyramid& pyramid_;
    std::span<const Node> nodes_;
    /// [nodes] of mixed ones, in parts of 255.
    std::vector<std::array<std::uint8_t, prt::BlockSize>> means_;
    /// [nodes] those below a hidden or visible one are of another block.
    std::vector<Kind> kinds_;
    std::size_t block_ = 0;
    glm::vec3 normal_{0.0f};
};

namespace {

/// Adds the nodes below one, in the order of prt::Quadtree::split_flags().
template<typename Node>
class NodeList {
public:
    explicit NodeList(const prt::Quadtree& quadtree)
        : flags_(quadtree.split_flags()), nodes_(cubemap::NumFaces) {
        for (const cubemap::Face face : cubemap::AllFaces)
            add(static_cast<std::uint32_t>(face), prt::Cell{.face = face});
    }
    [[nodiscard]] std::vector<Node> take() { return std::move(nodes_); }

private:
    void add(std::uint32_t node, const prt::Cell& cell) {
        const double size = cell.size(), s = cell.x * size, t = cell.y * size;
        nodes_[node].cell = glm::vec4(cubemap::direction(cell.face, s + 0.5 * size, t + 0.5 * size),
                                      cubemap::solid_angle(s, t, s + size, t + size));
        nodes_[node].first_leaf = num_leaves_;
        if (flags_[next_flag_++]) {
            const auto first_child = static_cast<std::uint32_t>(nodes_.size());
            nodes_[node].first_child = first_child;
            nodes_.resize(nodes_.size() + 4);
            for (std::uint32_t i = 0; i < 4; ++i)
                add(first_child + i, cell.child(i));
        } else {
            ++num_leaves_;
        }
        nodes_[node].end_leaf = num_leaves_;
    }

    std::vector<bool> flags_;
    std::size_t next_flag_ = 0;
    std::uint32_t num_leaves_ = 0;
    std::vector<Node> nodes_;
};

glm::vec3 mean_normal(const prt::Transfer& transfer, std::size_t block) {
    glm::vec3 normal(0.0f);
    const std::size_t first = block * prt::BlockSize;
    for (std::size_t i = first; i < std::min(first + prt::BlockSize, transfer.num_receivers()); ++i)
        normal += transfer.normals[i];
    const float length = glm::length(normal);
    return length > 0.0f ? normal / length : normal;
}

} // namespace

VisibilityPyramid::VisibilityPyramid(const prt::Transfer& transfer) : counts_(transfer.counts) {
    if (counts_.num_mixed() > std::numeric_limits<std::uint32_t>::max())
        throw std::length_error("expected a scene with fewer partly visible cells");
    const std::vector<Node> nodes = NodeList<Node>(transfer.quadtree).take();
    std::uint32_t num_face_branches = 0;
    for (std::uint32_t face = 0; face < cubemap::NumFaces; ++face)
        num_face_branches += nodes[face].is_branch() ? 1 : 0;
    families_.resize(num_face_branches);
    leaves_.resize(num_face_branches);
    for (std::uint32_t face = 0, branch = 0; face < cubemap::NumFaces; ++face)
        if (nodes[face].is_branch())
            add_families(nodes, face, branch++);
    // What Links and Place can count.
    if (families_.size() >= std::size_t{1} << 24u)
        throw std::length_error("expected a scene with fewer clusters");

    const std::size_t num_blocks = counts_.num_blocks();
    faces_.resize(num_blocks * cubemap::NumFaces);
    std::vector<BlockEntries> of_block(num_blocks);
    constexpr std::size_t Grain = 16;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, num_blocks, Grain), [&](const auto& some) {
            Builder builder(*this, nodes);
            for (std::size_t block = some.begin(); block < some.end(); ++block)
                builder.run(block, mean_normal(transfer, block),
                            std::span(faces_).subspan(block * cubemap::NumFaces, cubemap::NumFaces),
                            of_block[block]);
        });
    append(of_block);
}

/// Finds the families of a branch, whose own is there already, and of those below it.
void VisibilityPyramid::add_families(std::span<const Node> nodes, std::uint32_t node,
                                     std::uint32_t branch) {
    Family family{.first_branch = static_cast<std::uint32_t>(families_.size())};
    std::uint32_t num_branches = 0;
    for (std::uint32_t i = 0; i < 4; ++i) {
        const Node& child = nodes[nodes[node].first_child + i];
        const auto bit = static_cast<std::uint8_t>(1u << i);
        if (child.is_branch()) {
            family.branches = static_cast<std::uint8_t>(family.branches | bit);
            ++num_branches;
        } else if (child.is_quad()) {
            family.quads = static_cast<std::uint8_t>(family.quads | bit);
        } else {
            leaves_[branch][i] = child.first_leaf;
        }
    }
    families_[branch] = family;
    families_.resize(families_.size() + num_branches);
    leaves_.resize(families_.size());
    for (std::uint32_t i = 0, next = family.first_branch; i < 4; ++i)
        if ((family.branches >> i & 1u) != 0)
            add_families(nodes, nodes[node].first_child + i, next++);
}

/// Appends the entries of all blocks, which it clears, and makes links count from the very first.
void VisibilityPyramid::append(std::vector<BlockEntries>& blocks) {
    std::size_t num_branches = 0, num_quads = 0;
    for (const BlockEntries& block : blocks) {
        num_branches += block.links.size();
        num_quads += block.quads.size();
    }
    links_.reserve(num_branches);
    parts_.reserve(num_branches * prt::BlockSize);
    quad_sights_.reserve(num_quads);
    quads_.reserve(num_quads);
    for (std::size_t block = 0; block < blocks.size(); ++block) {
        BlockEntries& entries = blocks[block];
        const auto first_branch = static_cast<std::uint32_t>(links_.size());
        const auto first_quad = static_cast<std::uint32_t>(quads_.size());
        for (Links& links : entries.links)
            links.first_quad += first_quad;
        for (std::uint32_t face = 0; face < cubemap::NumFaces; ++face) {
            Place& place = faces_[block * cubemap::NumFaces + face];
            const std::uint32_t first = place.kind() == Kind::Branch ? first_branch
                                        : place.kind() == Kind::Quad ? first_quad
                                                                     : 0;
            place = Place(place.kind(), place.entry() + first, place.branch());
        }
        append_all(links_, entries.links);
        append_all(parts_, entries.parts);
        append_all(quad_sights_, entries.quad_sights);
        append_all(quads_, entries.quads);
        entries = {};
    }
}

/// Returns the number of a mixed cluster's counts.
std::uint32_t VisibilityPyramid::entry_of(std::size_t block, std::uint32_t leaf) const {
    const std::uint8_t* own = counts_.mixed_counts(counts_.word(block, leaf / 64), leaf % 64);
    return static_cast<std::uint32_t>(static_cast<std::size_t>(own - counts_.counts.data()) /
                                      prt::BlockSize);
}

std::size_t VisibilityPyramid::num_bytes() const {
    return families_.size() * (sizeof(Family) + sizeof leaves_[0]) + faces_.size() * sizeof(Place) +
           links_.size() * sizeof(Links) + parts_.size() + quad_sights_.size() +
           quads_.size() * sizeof quads_[0];
}

void VisibilityPyramid::add_quad(const Place& place,
                                 std::array<std::uint8_t, prt::BlockSize>& parts) const {
    const Sights seen = sights(place);
    const std::uint8_t* counts = first_part(place);
    std::array<std::uint8_t, prt::BlockSize> sums;
    sums.fill(static_cast<std::uint8_t>(16 * num_bits(seen.visible)));
    for (std::uint32_t child = num_bits(seen.mixed); child > 0; --child, counts += prt::BlockSize)
        for (std::size_t i = 0; i < prt::BlockSize; ++i)
            sums[i] = static_cast<std::uint8_t>(sums[i] + counts[i]);
    parts = sums;
}

} // namespace relumine::relight
