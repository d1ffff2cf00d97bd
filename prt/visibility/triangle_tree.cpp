#include "prt/visibility/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include <glm/common.hpp>

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

Part part_of(std::span<Item> items) {
    Part part{items, {}, items.size() == 1};
    for (const Item& item : items)
        part.box.include(item.box);
    return part;
}

/// Cuts a part in two at the best of 15 planes on each axis. The surface area heuristic counts
/// whole leaves.
std::pair<Part, Part> split(const Part& part) {
    constexpr int NumBins = 16;
    Box middles;
    for (const Item& item : part.items)
        middles.include({item.middle(0), item.middle(1), item.middle(2)});
    const auto leaves = [](std::size_t n) {
        const std::size_t num_leaves = (n + Width - 1) / Width;
        return static_cast<double>(num_leaves);
    };

    double best_cost = std::numeric_limits<double>::infinity();
    int best_axis = 0;
    int best_cut = 0;
    const auto bin_of = [&](const Item& item, int axis) {
        const float part_of_axis =
            (item.middle(axis) - middles.low[axis]) / (middles.high[axis] - middles.low[axis]);
        return std::min(static_cast<int>(part_of_axis * NumBins), NumBins - 1);
    };
    for (int axis = 0; axis < 3; ++axis) {
        if (!(middles.low[axis] < middles.high[axis]))
            continue;
        std::array<Box, NumBins> boxes;
        std::array<std::size_t, NumBins> counts{};
        for (const Item& item : part.items) {
            const auto bin = static_cast<std::size_t>(bin_of(item, axis));
            boxes[bin].include(item.box);
            ++counts[bin];
        }
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
                best_cut = static_cast<int>(cut);
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
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const std::int32_t child = parts[i].fits_leaf() ? ~leaf(parts[i]) : node(parts[i]);
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

TriangleTree triangle_tree(std::span<const glm::vec3> positions,
                           std::span<const mesh::Triangle> triangles) {
    TriangleTree tree;
    if (triangles.empty())
        return tree;
    Box box;
    for (const mesh::Triangle& triangle : triangles)
        for (const std::uint32_t vertex : triangle)
            box.include(positions[vertex]);
    tree.centre = 0.5f * (box.low + box.high);
    std::vector<Item> items(triangles.size());
    for (std::uint32_t i = 0; i < items.size(); ++i) {
        items[i].triangle = i;
        for (const std::uint32_t vertex : triangles[i])
            items[i].box.include(positions[vertex] - tree.centre);
    }
    const Part whole = part_of(items);
    for (int axis = 0; axis < 3; ++axis)
        tree.extent =
            std::max({tree.extent, std::abs(whole.box.low[axis]), std::abs(whole.box.high[axis])});
    Builder(positions, triangles, tree).node(whole);
    return tree;
}

} // namespace relumine::prt
