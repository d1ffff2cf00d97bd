#include "prt/visibility/shaft_leaves.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/visibility/shaft_leaves.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Supports = std::array<std::array<float, TriangleTree::Width>, Shaft::NumPlanes>;

/// Children of a node that are not outside of the shaft, and the supports of all. The corner of a
/// box that lies farthest along a normal has the high coordinates where the normal's are positive.
std::uint32_t children_inside(const TriangleTree::Node& node, const Shaft& shaft,
                              Supports& supports) {
    const hn::CappedTag<float, TriangleTree::Width> d;
    std::uint32_t inside = 0;
    for (std::size_t lane = 0; lane < TriangleTree::Width; lane += hn::Lanes(d)) {
        auto mask = hn::FirstN(d, TriangleTree::Width);
        for (std::size_t k = 0; k < Shaft::NumPlanes; ++k) {
            const glm::vec3& n = shaft.normals[k];
            const auto farthest = [&](std::size_t axis, float component) {
                return hn::Load(d, node.bounds[component >= 0.0f ? axis + 3 : axis].data() + lane);
            };
            const auto support = hn::MulAdd(hn::Set(d, n.x), farthest(0, n.x),
                                            hn::MulAdd(hn::Set(d, n.y), farthest(1, n.y),
                                                       hn::Mul(hn::Set(d, n.z), farthest(2, n.z))));
            hn::Store(support, d, supports[k].data() + lane);
            mask = hn::And(mask, hn::Ge(support, hn::Set(d, shaft.offsets[k])));
        }
        inside |= bits_of(d, mask) << lane;
    }
    return inside;
}

/// Where a child's box begins along the shaft's axis.
float near_side(const TriangleTree::Node& node, std::size_t lane, const Shaft& shaft) {
    const auto axis = static_cast<std::size_t>(shaft.axis);
    return shaft.sign > 0.0f ? node.bounds[axis][lane] : -node.bounds[axis + 3][lane];
}

/// Into 256 drawers: an order that is nearly right saves as many tests as the right one.
void sort_by_distance(ShaftLeaves& leaves) {
    constexpr std::size_t NumDrawers = 256;
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const ShaftLeaves::Found& found : leaves.found) {
        low = std::min(low, found.near);
        high = std::max(high, found.near);
    }
    const float per_unit = static_cast<float>(NumDrawers - 1) / std::max(high - low, 1e-30f);
    const auto drawer = [&](const ShaftLeaves::Found& found) {
        return static_cast<std::size_t>((found.near - low) * per_unit);
    };
    std::array<std::uint32_t, NumDrawers + 1> begin{};
    for (const ShaftLeaves::Found& found : leaves.found)
        ++begin[drawer(found) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    leaves.order.resize(leaves.found.size());
    for (std::uint32_t i = 0; i < leaves.found.size(); ++i)
        leaves.order[begin[drawer(leaves.found[i])]++] = i;
}

/// Calls visit(node, lane, leaf, supports) for each leaf whose box reaches into the shaft, until it
/// returns false.
template<class Visit>
bool visit_leaves(const TriangleTree& tree, const Shaft& shaft, std::vector<std::int32_t>& stack,
                  const Visit& visit) {
    stack.clear();
    if (!tree.nodes.empty())
        stack.push_back(0);
    alignas(64) Supports supports;
    while (!stack.empty()) {
        const std::int32_t index = stack.back();
        const TriangleTree::Node& node = tree.nodes[static_cast<std::size_t>(index)];
        stack.pop_back();
        for (std::uint32_t bits = children_inside(node, shaft, supports); bits != 0;
             bits &= bits - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
            const std::int32_t child = node.child[lane];
            if (child >= 0)
                stack.push_back(child);
            else if (!visit(index, lane, ~child, supports))
                return false;
        }
    }
    return true;
}

bool find_leaves(const TriangleTree& tree, const Shaft& shaft, std::size_t most,
                 ShaftLeaves& leaves) {
    leaves.found.clear();
    const auto add = [&](std::int32_t node, std::uint32_t lane, std::int32_t leaf,
                         const Supports& supports) {
        ShaftLeaves::Found& found = leaves.found.emplace_back();
        found.near = near_side(tree.nodes[static_cast<std::size_t>(node)], lane, shaft);
        found.leaf = leaf;
        found.node = node;
        found.lane = lane;
        for (std::size_t k = 0; k < Shaft::NumPlanes; ++k)
            found.supports[k] = supports[k][lane];
        return leaves.found.size() <= most;
    };
    if (!visit_leaves(tree, shaft, leaves.stack, add))
        return false;
    sort_by_distance(leaves);
    return true;
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

namespace {
HWY_EXPORT(find_leaves);
} // namespace

bool find_leaves(const TriangleTree& tree, const Shaft& shaft, std::size_t most,
                 ShaftLeaves& leaves) {
    return HWY_DYNAMIC_DISPATCH(find_leaves)(tree, shaft, most, leaves);
}

} // namespace relumine::prt
#endif // HWY_ONCE
