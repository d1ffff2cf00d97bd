#include "relight/moving_eye/visibility_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "cubemap/face.h"
#include "files/parallel.h"

namespace relumine::relight {

namespace {

using Sums = std::array<float, prt::BlockSize>;

/// What lies below a block's horizon keeps so much of a weight: some of its receivers may look
/// there.
constexpr float LeastCosine = 0.02f;

/// Returns whether all bits of [first, end) are set, and whether none is.
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

} // namespace

/// Finds the means of one block.
class VisibilityPyramid::Builder {
public:
    Builder(const VisibilityPyramid& pyramid, std::span<const glm::vec4> cells)
        : pyramid_(pyramid), cells_(cells),
          parts_(std::size_t{pyramid.num_stored_} * prt::BlockSize) {}

    /// Writes the bits of a block, and appends the parts of its mixed cells.
    void run(std::size_t block, const glm::vec3& normal, std::span<std::uint64_t> visible,
             std::span<std::uint64_t> mixed, std::vector<std::uint8_t>& parts) {
        block_ = block;
        normal_ = normal;
        visible_ = visible;
        mixed_ = mixed;
        for (std::uint32_t face = 0; face < cubemap::NumFaces; ++face) {
            Sums sums{};
            static_cast<void>(add(face, sums));
        }
        for (std::size_t w = 0; w < mixed.size(); ++w)
            for (std::uint64_t bits = mixed[w]; bits != 0; bits &= bits - 1) {
                const auto* from =
                    parts_.data() +
                    (w * 64 + static_cast<std::size_t>(std::countr_zero(bits))) * prt::BlockSize;
                parts.insert(parts.end(), from, from + prt::BlockSize);
            }
    }

private:
    [[nodiscard]] float weight(std::uint32_t node) const {
        const glm::vec4& cell = cells_[node];
        return cell.w * std::max(glm::dot(normal_, glm::vec3(cell)), LeastCosine);
    }

    /// Adds the visible parts of a node times its weight, which it returns.
    float add(std::uint32_t index, Sums& sums) {
        const Node& node = pyramid_.nodes_[index];
        const prt::VisibleCounts& counts = pyramid_.counts_;
        const auto in_word = [&](const std::vector<std::uint64_t>& bits) {
            return bits_of(node.first_leaf, node.end_leaf,
                           [&](std::uint32_t w) { return bits[counts.word(block_, w)]; });
        };
        const RangeBits visible = in_word(counts.visible);
        const float own = weight(index);
        if (visible.all) {
            for (float& sum : sums)
                sum += own;
            set_visible(node);
            return own;
        }
        if (visible.none && in_word(counts.mixed).none)
            return own;
        if (node.first_child == 0) {
            const std::uint8_t* seen = counts.mixed_counts(
                counts.word(block_, node.first_leaf / 64), node.first_leaf % 64);
            for (std::size_t i = 0; i < sums.size(); ++i)
                sums[i] += own / 16.0f * seen[i];
            return own;
        }
        Sums below{};
        float weights = 0.0f;
        for (std::uint32_t i = 0; i < 4; ++i)
            weights += add(node.first_child + i, below);
        for (std::size_t i = 0; i < sums.size(); ++i)
            sums[i] += below[i];
        if (node.stored != NotStored) {
            set_bit(node, mixed_);
            for (std::size_t i = 0; i < sums.size(); ++i)
                parts_[node.stored * prt::BlockSize + i] = static_cast<std::uint8_t>(
                    std::lround(std::min(below[i] / weights, 1.0f) * 255.0f));
        }
        return weights;
    }

    static void set_bit(const Node& node, std::span<std::uint64_t> bits) {
        bits[node.stored / 64] |= std::uint64_t{1} << node.stored % 64;
    }

    /// Cells below a visible one are visible, too.
    void set_visible(const Node& node) {
        if (node.stored == NotStored)
            return;
        set_bit(node, visible_);
        for (std::uint32_t i = 0; i < 4; ++i)
            set_visible(pyramid_.nodes_[node.first_child + i]);
    }

    const VisibilityPyramid& pyramid_;
    /// [nodes] direction and solid angle.
    std::span<const glm::vec4> cells_;
    /// [num_stored * 16], of mixed ones.
    std::vector<std::uint8_t> parts_;
    std::size_t block_ = 0;
    glm::vec3 normal_{0.0f};
    std::span<std::uint64_t> visible_, mixed_;
};

VisibilityPyramid::VisibilityPyramid(const prt::Transfer& transfer)
    : counts_(transfer.counts), nodes_(cubemap::NumFaces) {
    const std::vector<bool> flags = transfer.quadtree.split_flags();
    std::size_t next_flag = 0;
    for (std::uint32_t face = 0; face < cubemap::NumFaces; ++face)
        add_nodes(face, flags, next_flag);
    std::vector<glm::vec4> cells(nodes_.size());
    const auto place = [&](const auto& self, std::uint32_t node, const prt::Cell& cell) -> void {
        const double size = cell.size(), s = cell.x * size, t = cell.y * size;
        cells[node] = glm::vec4(cubemap::direction(cell.face, s + 0.5 * size, t + 0.5 * size),
                                cubemap::solid_angle(s, t, s + size, t + size));
        for (std::uint32_t i = 0; nodes_[node].first_child != 0 && i < 4; ++i)
            self(self, nodes_[node].first_child + i, cell.child(i));
    };
    for (const cubemap::Face face : cubemap::AllFaces)
        place(place, static_cast<std::uint32_t>(face), prt::Cell{.face = face});

    const std::size_t num_blocks = counts_.num_blocks();
    words_per_block_ = (num_stored_ + 63) / 64;
    visible_.resize(num_blocks * words_per_block_);
    mixed_.resize(visible_.size());
    std::vector<std::vector<std::uint8_t>> of_block(num_blocks);
    constexpr std::size_t Grain = 16;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, num_blocks, Grain), [&](const auto& some) {
            Builder builder(*this, cells);
            for (std::size_t block = some.begin(); block < some.end(); ++block) {
                glm::vec3 normal(0.0f);
                const std::size_t first = block * prt::BlockSize;
                for (std::size_t i = first;
                     i < std::min(first + prt::BlockSize, transfer.num_receivers()); ++i)
                    normal += transfer.normals[i];
                const float length = glm::length(normal);
                const auto words = [&](std::vector<std::uint64_t>& bits) {
                    return std::span(bits).subspan(block * words_per_block_, words_per_block_);
                };
                builder.run(block, length > 0.0f ? normal / length : normal, words(visible_),
                            words(mixed_), of_block[block]);
            }
        });

    mixed_before_.resize(mixed_.size());
    std::uint64_t before = 0;
    for (std::size_t w = 0; w < mixed_.size(); ++w) {
        mixed_before_[w] = static_cast<std::uint32_t>(before);
        before += static_cast<std::uint64_t>(std::popcount(mixed_[w]));
    }
    if (before > std::numeric_limits<std::uint32_t>::max())
        throw std::length_error("expected a scene with fewer partly visible cells");
    parts_.reserve(before * prt::BlockSize);
    for (std::vector<std::uint8_t>& parts : of_block) {
        parts_.insert(parts_.end(), parts.begin(), parts.end());
        parts = {};
    }
}

/// Adds the nodes below one, in the order of prt::Quadtree::split_flags().
void VisibilityPyramid::add_nodes(std::uint32_t node, const std::vector<bool>& flags,
                                  std::size_t& next_flag) {
    nodes_[node].first_leaf = num_leaves_;
    if (flags[next_flag++]) {
        const auto first_child = static_cast<std::uint32_t>(nodes_.size());
        nodes_[node].first_child = first_child;
        nodes_.resize(nodes_.size() + 4);
        for (std::uint32_t i = 0; i < 4; ++i)
            add_nodes(first_child + i, flags, next_flag);
    } else {
        ++num_leaves_;
    }
    nodes_[node].end_leaf = num_leaves_;
    if (nodes_[node].end_leaf - nodes_[node].first_leaf > 4)
        nodes_[node].stored = num_stored_++;
}

std::size_t VisibilityPyramid::num_bytes() const {
    return nodes_.size() * sizeof(Node) + (visible_.size() + mixed_.size()) * 8 +
           mixed_before_.size() * 4 + parts_.size();
}

VisibilityPyramid::Parts VisibilityPyramid::parts(std::size_t block, const Node& node) const {
    Parts result;
    if (node.stored != NotStored) {
        const std::size_t word = block * words_per_block_ + node.stored / 64;
        const std::uint64_t below = mixed_[word] & ((std::uint64_t{1} << node.stored % 64) - 1);
        const std::size_t place =
            mixed_before_[word] + static_cast<std::size_t>(std::popcount(below));
        std::copy_n(parts_.data() + place * prt::BlockSize, prt::BlockSize, result.parts.data());
        result.unit = 1.0f / 255.0f;
        return result;
    }
    for (std::uint32_t leaf = node.first_leaf; leaf < node.end_leaf; ++leaf) {
        const Sight seen = sight_of_leaf(block, leaf);
        const std::uint8_t* own =
            seen == Sight::Mixed ? counts_.mixed_counts(counts_.word(block, leaf / 64), leaf % 64)
                                 : nullptr;
        for (std::size_t i = 0; i < prt::BlockSize; ++i)
            result.parts[i] = static_cast<std::uint8_t>(result.parts[i] + (own != nullptr ? own[i]
                                                                           : seen == Sight::Visible
                                                                               ? std::uint8_t{16}
                                                                               : 0));
    }
    result.unit = 1.0f / (16.0f * static_cast<float>(node.end_leaf - node.first_leaf));
    return result;
}

} // namespace relumine::relight
