#include "prt/visibility/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <glm/common.hpp>

#include "files/parallel.h"

namespace relumine::prt {

namespace {

constexpr std::size_t Width = TriangleTree::Width;

struct Box {
    glm::vec3 low{std::numeric_limits<float>::infinity()};
    glm::vec3 high{-std::numeric_limits<float>::infinity()};

    void include(const Box& other) {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
    void include(const glm::vec3& point) { include({point, point}); }
    [[nodiscard]] double half_area() const {
        if (!(low.x <= high.x))
            return 0.0;
        const glm::dvec3 size = glm::dvec3(high) - glm::dvec3(low);
        return size.x * size.y + size.y * size.z + size.z * size.x;
    }
};

struct Item {
    Box box;
    std::uint32_t triangle = 0;
    [[nodiscard]] float middle(int axis) const { return 0.5f * (box.low[axis] + box.high[axis]); }
};

struct Part {
    std::span<Item> items;
    Box box;
    /// A leaf that no cut improves.
    bool is_settled = false;
    [[nodiscard]] bool fits_leaf() const { return items.size() <= Width; }
};

/// Returns what `add(result, items)` makes of all items. Many are added in pieces, in parallel, and
/// the pieces' results included in the first one's.
template<typename Result, typename Add>
Result sum_of(std::span<const Item> items, const Add& add) {
    constexpr std::size_t Piece = std::size_t{1} << 15;
    if (items.size() <= Piece) {
        Result result;
        add(result, items);
        return result;
    }
    std::vector<Result> results(items.size() / Piece + 1);
    files::parallel_for(std::size_t{0}, results.size(), [&](std::size_t i) {
        const auto from = items.subspan(i * Piece);
        add(results[i], from.first(std::min(Piece, from.size())));
    });
    for (std::size_t i = 1; i < results.size(); ++i)
        results.front().include(results[i]);
    return results.front();
}

Part part_of(std::span<Item> items) {
    const Box box = sum_of<Box>(items, [](Box& sum, std::span<const Item> some) {
        for (const Item& item : some)
            sum.include(item.box);
    });
    return {items, box, items.size() == 1};
}

constexpr std::size_t NumBins = 16;

/// Triangles by their middles along each axis.
struct Bins {
    std::array<std::array<Box, NumBins>, 3> boxes;
    std::array<std::array<std::size_t, NumBins>, 3> counts{};

    void include(const Bins& other) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t bin = 0; bin < NumBins; ++bin) {
                boxes[axis][bin].include(other.boxes[axis][bin]);
                counts[axis][bin] += other.counts[axis][bin];
            }
    }
};

/// Cuts a part in two at the best of 15 planes on each axis. The surface area heuristic counts
/// whole leaves.
std::pair<Part, Part> split(const Part& part) {
    const Box middles = sum_of<Box>(part.items, [](Box& sum, std::span<const Item> some) {
        for (const Item& item : some)
            sum.include({item.middle(0), item.middle(1), item.middle(2)});
    });
    const auto leaves = [](std::size_t n) {
        const std::size_t num_leaves = (n + Width - 1) / Width;
        return static_cast<double>(num_leaves);
    };

    double best_cost = std::numeric_limits<double>::infinity();
    int best_axis = 0;
    std::size_t best_cut = 0;
    const auto bin_of = [&](const Item& item, int axis) {
        const float part_of_axis =
            (item.middle(axis) - middles.low[axis]) / (middles.high[axis] - middles.low[axis]);
        return std::min(static_cast<std::size_t>(part_of_axis * NumBins), NumBins - 1);
    };
    const auto is_wide = [&](int axis) {
        return middles.low[axis] < middles.high[axis];
    };
    const Bins bins = sum_of<Bins>(part.items, [&](Bins& sum, std::span<const Item> some) {
        for (int axis = 0; axis < 3; ++axis) {
            if (!is_wide(axis))
                continue;
            const auto along = static_cast<std::size_t>(axis);
            for (const Item& item : some) {
                const std::size_t bin = bin_of(item, axis);
                sum.boxes[along][bin].include(item.box);
                ++sum.counts[along][bin];
            }
        }
    });
    for (int axis = 0; axis < 3; ++axis) {
        if (!is_wide(axis))
            continue;
        const auto& boxes = bins.boxes[static_cast<std::size_t>(axis)];
        const auto& counts = bins.counts[static_cast<std::size_t>(axis)];
        std::array<double, NumBins> cost_after{}; // of all bins from here on
        Box box;
        std::size_t count = 0;
        for (std::size_t bin = NumBins; bin-- > 1;) {
            box.include(boxes[bin]);
            count += counts[bin];
            cost_after[bin] = box.half_area() * leaves(count);
        }
        box = {};
        count = 0;
        for (std::size_t cut = 1; cut < NumBins; ++cut) {
            box.include(boxes[cut - 1]);
            count += counts[cut - 1];
            const double cost = box.half_area() * leaves(count) + cost_after[cut];
            if (count > 0 && count < part.items.size() && cost < best_cost) {
                best_cost = cost;
                best_axis = axis;
                best_cut = cut;
            }
        }
    }
    auto middle = part.items.begin() + static_cast<std::ptrdiff_t>(part.items.size() / 2);
    if (best_cut > 0) // otherwise all lie in one place: cut into halves
        middle = std::stable_partition(part.items.begin(), part.items.end(), [&](const Item& item) {
            return bin_of(item, best_axis) < best_cut;
        });
    const auto first_size = static_cast<std::size_t>(middle - part.items.begin());
    return {part_of(part.items.first(first_size)), part_of(part.items.subspan(first_size))};
}

class Builder {
public:
    Builder(std::span<const glm::vec3> positions, std::span<const mesh::Triangle> triangles,
            TriangleTree& tree)
        : positions_(positions), triangles_(triangles), tree_(tree) {}

    /// Adds the node over a part and returns its index. Cuts the biggest piece until there are
    /// sixteen, or none is worth a cut.
    std::int32_t node(const Part& whole) {
        std::vector<Part> parts = {whole};
        while (parts.size() < Width) {
            const auto rank = [](const Part& part) {
                return part.is_settled ? -1.0 : part.box.half_area();
            };
            const auto biggest =
                std::max_element(parts.begin(), parts.end(),
                                 [&](const Part& a, const Part& b) { return rank(a) < rank(b); });
            if (biggest->is_settled)
                break;
            const auto [first, second] = split(*biggest);
            // Triangles that fit into one leaf are cut only if their sizes differ much.
            if (biggest->fits_leaf() && std::min(first.box.half_area(), second.box.half_area()) >
                                            0.005 * biggest->box.half_area()) {
                biggest->is_settled = true;
                continue;
            }
            *biggest = first;
            parts.push_back(second);
        }
        const std::size_t index = tree_.nodes.size();
        tree_.nodes.emplace_back();
        constexpr float Far = std::numeric_limits<float>::max() / 16.0f;
        for (int axis = 0; axis < 3; ++axis) {
            tree_.nodes[index].bounds[static_cast<std::size_t>(axis)].fill(Far);
            tree_.nodes[index].bounds[static_cast<std::size_t>(axis) + 3].fill(-Far);
        }
        tree_.nodes[index].child.fill(0);
        std::vector<TriangleTree> large = large_children(parts);
        reserve_for(large);
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const std::int32_t child = !large[i].nodes.empty() ? add(std::exchange(large[i], {}))
                                       : parts[i].fits_leaf()  ? ~leaf(parts[i])
                                                               : node(parts[i]);
            TriangleTree::Node& node = tree_.nodes[index];
            node.child[i] = child;
            for (int axis = 0; axis < 3; ++axis) {
                node.bounds[static_cast<std::size_t>(axis)][i] = parts[i].box.low[axis];
                node.bounds[static_cast<std::size_t>(axis) + 3][i] = parts[i].box.high[axis];
            }
        }
        return static_cast<std::int32_t>(index);
    }

private:
    /// Builds the large parts in parallel, each as a tree; the others' are empty.
    std::vector<TriangleTree> large_children(std::span<const Part> parts) const {
        constexpr std::size_t Large = std::size_t{1} << 14;
        std::vector<TriangleTree> trees(parts.size());
        files::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
            if (parts[i].items.size() >= Large)
                Builder(positions_, triangles_, trees[i]).node(parts[i]);
        });
        return trees;
    }
    /// Makes room for trees. Vectors that grow on their way take new pages again and again.
    void reserve_for(std::span<const TriangleTree> trees) {
        std::size_t num_nodes = tree_.nodes.size(), num_leaves = tree_.leaves.size();
        for (const TriangleTree& tree : trees) {
            num_nodes += tree.nodes.size();
            num_leaves += tree.leaves.size();
        }
        if (num_leaves == tree_.leaves.size())
            return;
        tree_.nodes.reserve(num_nodes);
        tree_.leaves.reserve(num_leaves);
        tree_.triangles.reserve(num_leaves);
    }
    std::int32_t add(const TriangleTree& other) {
        return static_cast<std::int32_t>(append(tree_, other, whole(other)).first_node);
    }
    std::int32_t leaf(const Part& part) {
        TriangleTree::Leaf& leaf = tree_.leaves.emplace_back();
        auto& numbers = tree_.triangles.emplace_back();
        for (const Item& item : part.items) {
            const mesh::Triangle& triangle = triangles_[item.triangle];
            const std::size_t lane = leaf.size++;
            numbers[lane] = item.triangle;
            leaf.longest[lane] = 0.0f;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const glm::vec3& place = positions_[triangle[corner]];
                const glm::vec3 edge = glm::abs(positions_[triangle[(corner + 1) % 3]] - place);
                leaf.longest[lane] = std::max({leaf.longest[lane], edge.x, edge.y, edge.z});
                for (int axis = 0; axis < 3; ++axis)
                    leaf.corners[3 * corner + static_cast<std::size_t>(axis)][lane] = place[axis];
            }
        }
        for (auto& row : leaf.corners)
            std::fill(row.begin() + leaf.size, row.end(), row.front());
        std::fill(leaf.longest.begin() + leaf.size, leaf.longest.end(), leaf.longest.front());
        return static_cast<std::int32_t>(tree_.leaves.size() - 1);
    }

    std::span<const glm::vec3> positions_;
    std::span<const mesh::Triangle> triangles_;
    TriangleTree& tree_;
};

} // namespace

TreePart whole(const TriangleTree& tree) {
    return {.end_node = tree.nodes.size(), .end_leaf = tree.leaves.size()};
}

TreePart append(TriangleTree& to, const TriangleTree& from, const TreePart& part) {
    const TreePart result{.first_node = to.nodes.size(),
                          .end_node = to.nodes.size() + part.end_node - part.first_node,
                          .first_leaf = to.leaves.size(),
                          .end_leaf = to.leaves.size() + part.end_leaf - part.first_leaf};
    const auto add = [](auto& all, const auto& more, std::size_t first, std::size_t end) {
        all.insert(all.end(), more.begin() + static_cast<std::ptrdiff_t>(first),
                   more.begin() + static_cast<std::ptrdiff_t>(end));
    };
    add(to.nodes, from.nodes, part.first_node, part.end_node);
    add(to.leaves, from.leaves, part.first_leaf, part.end_leaf);
    if (!from.triangles.empty())
        add(to.triangles, from.triangles, part.first_leaf, part.end_leaf);
    const auto by_nodes =
        static_cast<std::int32_t>(result.first_node) - static_cast<std::int32_t>(part.first_node);
    const auto by_leaves =
        static_cast<std::int32_t>(result.first_leaf) - static_cast<std::int32_t>(part.first_leaf);
    for (std::size_t i = result.first_node; i < result.end_node; ++i)
        for (std::size_t lane = 0; lane < Width; ++lane) {
            TriangleTree::Node& node = to.nodes[i];
            if (node.bounds[0][lane] > node.bounds[3][lane])
                continue; // unused
            std::int32_t& child = node.child[lane];
            child += child >= 0 ? by_nodes : -by_leaves;
        }
    return result;
}

TriangleTree triangle_tree(std::span<const glm::vec3> positions,
                           std::span<const mesh::Triangle> triangles,
                           const std::optional<glm::vec3>& centre) {
    TriangleTree tree;
    if (triangles.empty())
        return tree;
    Box box;
    for (const mesh::Triangle& triangle : triangles)
        for (const std::uint32_t vertex : triangle)
            box.include(positions[vertex]);
    tree.centre = centre.value_or(0.5f * (box.low + box.high));
    std::vector<Item> items(triangles.size());
    files::parallel_for(std::size_t{0}, items.size(), [&](std::size_t i) {
        items[i].triangle = static_cast<std::uint32_t>(i);
        for (const std::uint32_t vertex : triangles[i])
            items[i].box.include(positions[vertex] - tree.centre);
    });
    const Part whole = part_of(items);
    for (int axis = 0; axis < 3; ++axis)
        tree.extent =
            std::max({tree.extent, std::abs(whole.box.low[axis]), std::abs(whole.box.high[axis])});
    Builder(positions, triangles, tree).node(whole);
    return tree;
}

} // namespace relumine::prt
