#include "prt/visibility/grouped_tree.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

namespace relumine::prt {

namespace {

/// A group's tree, and what its root's boxes fill: low x, y, z, high x, y, z.
struct Root {
    std::size_t group = 0;
    std::array<float, 6> box{};
    [[nodiscard]] float middle(std::size_t axis) const { return box[axis] + box[axis + 3]; }
};

constexpr std::array<float, 6> nothing() {
    constexpr float Far = std::numeric_limits<float>::max() / 16.0f;
    return {Far, Far, Far, -Far, -Far, -Far};
}
void include(std::array<float, 6>& box, const std::array<float, 6>& other) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box[axis] = std::min(box[axis], other[axis]);
        box[axis + 3] = std::max(box[axis + 3], other[axis + 3]);
    }
}

std::array<float, 6> box_of(const TriangleTree::Node& node) {
    std::array<float, 6> box = nothing();
    for (std::size_t lane = 0; lane < TriangleTree::Width; ++lane) {
        std::array<float, 6> own{};
        for (std::size_t side = 0; side < own.size(); ++side)
            own[side] = node.bounds[side][lane];
        include(box, own); // an unused lane is inside out
    }
    return box;
}
std::array<float, 6> box_of(std::span<const Root> roots) {
    std::array<float, 6> box = nothing();
    for (const Root& root : roots)
        include(box, root.box);
    return box;
}

/// Cuts roots into halves along the axis at which they are widest.
std::pair<std::span<Root>, std::span<Root>> halves(std::span<Root> roots) {
    const std::array<float, 6> box = box_of(roots);
    std::size_t axis = 0;
    for (std::size_t other = 1; other < 3; ++other)
        if (box[other + 3] - box[other] > box[axis + 3] - box[axis])
            axis = other;
    const std::size_t middle = roots.size() / 2;
    std::nth_element(roots.begin(), roots.begin() + static_cast<std::ptrdiff_t>(middle),
                     roots.end(), [axis](const Root& a, const Root& b) {
                         return std::pair(a.middle(axis), a.group) <
                                std::pair(b.middle(axis), b.group);
                     });
    return {roots.first(middle), roots.subspan(middle)};
}

/// Adds nodes over two roots or more. Their children are such nodes, or groups: ~group.
std::int32_t add_nodes(std::span<Root> roots, std::vector<TriangleTree::Node>& nodes) {
    std::vector<std::span<Root>> spans = {roots};
    while (spans.size() < std::min(TriangleTree::Width, roots.size())) {
        const auto largest = std::ranges::max_element(spans, {}, &std::span<Root>::size);
        const auto [first, second] = halves(*largest);
        *largest = first;
        spans.push_back(second);
    }
    const std::size_t index = nodes.size();
    nodes.emplace_back();
    for (std::size_t lane = 0; lane < TriangleTree::Width; ++lane) {
        const std::span<Root> own = lane < spans.size() ? spans[lane] : std::span<Root>();
        const std::array<float, 6> box = box_of(own);
        const std::int32_t child = own.empty()       ? 0
                                   : own.size() == 1 ? ~static_cast<std::int32_t>(own[0].group)
                                                     : add_nodes(own, nodes);
        for (std::size_t side = 0; side < box.size(); ++side)
            nodes[index].bounds[side][lane] = box[side];
        nodes[index].child[lane] = child;
    }
    return static_cast<std::int32_t>(index);
}

/// Where a tree is to be taken from.
struct Source {
    const TriangleTree* tree = nullptr;
    TreePart part = {};
    [[nodiscard]] bool is_empty() const { return part.first_node == part.end_node; }
};

/// Puts the trees of groups behind nodes over them. `parts` gets where they are.
TriangleTree joined(std::span<const Source> sources, std::vector<TreePart>& parts) {
    TriangleTree result;
    std::vector<Root> roots;
    TreePart sizes;
    for (std::size_t group = 0; group < sources.size(); ++group) {
        const auto& [tree, part] = sources[group];
        if (sources[group].is_empty())
            continue;
        roots.push_back({group, box_of(tree->nodes[part.first_node])});
        sizes.end_node += part.end_node - part.first_node;
        sizes.end_leaf += part.end_leaf - part.first_leaf;
        result.centre = tree->centre;
        for (const float side : roots.back().box)
            result.extent = std::max(result.extent, std::abs(side));
    }
    if (roots.size() > 1)
        add_nodes(roots, result.nodes);
    const std::size_t num_over = result.nodes.size();
    result.nodes.reserve(num_over + sizes.end_node);
    result.leaves.reserve(sizes.end_leaf);
    parts.assign(sources.size(), {});
    for (std::size_t group = 0; group < sources.size(); ++group)
        if (!sources[group].is_empty())
            parts[group] = append(result, *sources[group].tree, sources[group].part);
    for (std::size_t i = 0; i < num_over; ++i)
        for (std::int32_t& child : result.nodes[i].child)
            if (child < 0)
                child =
                    static_cast<std::int32_t>(parts[static_cast<std::size_t>(~child)].first_node);
    return result;
}

} // namespace

GroupedTree::GroupedTree(std::vector<TriangleTree> groups) {
    std::vector<Source> sources;
    for (const TriangleTree& tree : groups)
        sources.push_back({&tree, whole(tree)});
    tree_ = joined(sources, parts_);
}

void GroupedTree::replace(std::size_t group, const TriangleTree& tree) {
    std::vector<Source> sources;
    for (const TreePart& part : parts_)
        sources.push_back({&tree_, part});
    sources[group] = {&tree, whole(tree)};
    std::vector<TreePart> parts;
    tree_ = joined(sources, parts);
    parts_ = std::move(parts);
}

} // namespace relumine::prt
