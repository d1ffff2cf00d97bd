#include "prt/visibility/shaft_leaves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/visibility/shaft_leaves.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t Width = TriangleTree::Width;

using Supports = std::array<std::array<float, Width>, Shaft::NumPlanes>;

/// Children of a node that are not outside of the shaft, and the supports of all. The corner of a
/// box that lies farthest along a normal has the high coordinates where the normal's are positive.
std::uint32_t children_inside(const TriangleTree::Node& node, const Shaft& shaft,
                              Supports& supports) {
    const hn::CappedTag<float, Width> d;
    std::uint32_t inside = 0;
    for (std::size_t lane = 0; lane < Width; lane += hn::Lanes(d)) {
        auto mask = hn::FirstN(d, Width);
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

/// Rounding errors and their bounds: docs/error-bounds.md, rows S4 and S5.
constexpr double HeightRoundings = 64.0;
constexpr double AwayRoundings = 32.0;

/// Whether all rays of the shaft run away from the triangle's plane, which then says more than a
/// large triangle's box does.
bool leaves_plane(const TriangleTree::Leaf& leaf, std::size_t lane, const Shaft& shaft) {
    glm::dvec3 corner[3];
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a)
            corner[k][static_cast<int>(a)] = static_cast<double>(leaf.corners[3 * k + a][lane]);
    const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const glm::dvec3 middle =
        0.5 * (glm::dvec3(shaft.origins_low) + glm::dvec3(shaft.origins_high));
    const glm::dvec3 half = 0.5 * (glm::dvec3(shaft.origins_high) - glm::dvec3(shaft.origins_low));
    const double height = glm::dot(normal, middle - corner[0]);
    const double spread = glm::dot(glm::abs(normal), half);
    const double size = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    const double longest = static_cast<double>(leaf.longest[lane]);
    const double rounding = static_cast<double>(Rounding) * (size + longest * longest);
    const double margin = HeightRoundings * rounding * static_cast<double>(shaft.reach);
    if (!(std::abs(height) > spread + margin))
        return false;
    const double side = height > 0.0 ? 1.0 : -1.0;
    return std::all_of(shaft.corners.begin(), shaft.corners.end(), [&](const glm::vec3& w) {
        return side * glm::dot(normal, glm::dvec3(w)) > AwayRoundings * rounding;
    });
}

bool leaves_planes(const TriangleTree::Leaf& leaf, const Shaft& shaft) {
    constexpr std::uint32_t FewTriangles = 4; // more are rarely large
    if (leaf.size > FewTriangles)
        return false;
    for (std::size_t lane = 0; lane < leaf.size; ++lane)
        if (!leaves_plane(leaf, lane, shaft))
            return false;
    return true;
}

/// Writes the supports of a leaf's triangles, which are much closer than those of its box where a
/// surface runs along a plane. False where one says that the leaf is outside.
bool supports_inside(const TriangleTree::Leaf& leaf, const glm::vec3& centre, const Shaft& shaft,
                     ShaftLeaves& leaves, std::size_t place) {
    const hn::CappedTag<float, Width> d;
    using Vector = hn::Vec<decltype(d)>;
    Vector most[Shaft::NumPlanes];
    for (std::size_t lane = 0; lane < Width; lane += hn::Lanes(d)) {
        Vector corner[9];
        for (std::size_t i = 0; i < 9; ++i)
            corner[i] = hn::Sub(hn::Load(d, leaf.corners[i].data() + lane),
                                hn::Set(d, centre[static_cast<int>(i % 3)]));
        for (std::size_t k = 0; k < Shaft::NumPlanes; ++k) {
            const Vector nx = hn::Set(d, shaft.normals[k].x);
            const Vector ny = hn::Set(d, shaft.normals[k].y);
            const Vector nz = hn::Set(d, shaft.normals[k].z);
            const auto along = [&](std::size_t i) {
                return hn::MulAdd(nx, corner[i],
                                  hn::MulAdd(ny, corner[i + 1], hn::Mul(nz, corner[i + 2])));
            };
            const Vector support = hn::Max(hn::Max(along(0), along(3)), along(6));
            most[k] = lane == 0 ? support : hn::Max(most[k], support);
        }
    }
    bool inside = true;
    for (std::size_t k = 0; k < Shaft::NumPlanes; ++k) {
        const float support = hn::GetLane(hn::MaxOfLanes(d, most[k]));
        leaves.supports[k][place] = support;
        inside = inside && support >= shaft.offsets[k];
    }
    return inside;
}

/// Ascending by `near`, then by `place`.
std::uint64_t sort_key(float near, std::size_t place) {
    const auto bits = std::bit_cast<std::uint32_t>(near);
    const std::uint32_t ascending = (bits >> 31u) != 0 ? ~bits : bits | 0x80000000u;
    return std::uint64_t{ascending} << 32u | place;
}

/// Where a child's box begins along the shaft's axis.
float near_side(const TriangleTree::Node& node, std::size_t lane, const Shaft& shaft) {
    const auto axis = static_cast<std::size_t>(shaft.axis);
    return shaft.sign > 0.0f ? node.bounds[axis][lane] : -node.bounds[axis + 3][lane];
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
    leaves.order.clear();
    const auto add = [&](std::int32_t node, std::uint32_t lane, std::int32_t leaf,
                         const Supports&) {
        if (leaves_planes(tree.leaves[static_cast<std::size_t>(leaf)], shaft))
            return true;
        const float near = near_side(tree.nodes[static_cast<std::size_t>(node)], lane, shaft);
        leaves.order.push_back(sort_key(near, leaves.found.size()));
        leaves.found.push_back({.node = node, .lane = lane, .leaf = leaf});
        return leaves.found.size() <= most;
    };
    if (!visit_leaves(tree, shaft, leaves.stack, add))
        return false;
    std::sort(leaves.order.begin(), leaves.order.end());
    const auto axis = static_cast<std::size_t>(shaft.axis);
    leaves.size = 0;
    for (const std::uint64_t key : leaves.order) {
        const ShaftLeaves::Found& found = leaves.found[key & 0xffffffff];
        const TriangleTree::Node& node = tree.nodes[static_cast<std::size_t>(found.node)];
        const std::int32_t leaf = found.leaf;
        const std::size_t i = leaves.size;
        if (!supports_inside(tree.leaves[static_cast<std::size_t>(leaf)], tree.centre, shaft,
                             leaves, i))
            continue;
        ++leaves.size;
        leaves.leaves[i] = leaf;
        const auto low = [&](std::size_t a) {
            return node.bounds[a % 3][found.lane];
        };
        const auto high = [&](std::size_t a) {
            return node.bounds[a % 3 + 3][found.lane];
        };
        leaves.boxes[0][i] = near_side(node, found.lane, shaft);
        leaves.boxes[1][i] = shaft.sign > 0.0f ? high(axis) : -low(axis);
        leaves.boxes[2][i] = low(axis + 1);
        leaves.boxes[3][i] = high(axis + 1);
        leaves.boxes[4][i] = low(axis + 2);
        leaves.boxes[5][i] = high(axis + 2);
    }
    for (auto& row : leaves.supports)
        std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(leaves.size), ShaftLeaves::Padding,
                    -std::numeric_limits<float>::infinity());
    return true;
}

bool find_boxes(const TriangleTree& tree, const Shaft& shaft, std::size_t most, ShaftBoxes& boxes) {
    boxes.found.clear();
    boxes.order.clear();
    const auto add = [&](std::int32_t node, std::uint32_t lane, std::int32_t leaf,
                         const Supports& supports) {
        const float near = near_side(tree.nodes[static_cast<std::size_t>(node)], lane, shaft);
        boxes.order.push_back(sort_key(near, boxes.found.size()));
        ShaftBoxes::Found& found = boxes.found.emplace_back();
        found.leaf = leaf;
        for (std::size_t k = 0; k < Shaft::NumPlanes; ++k)
            found.supports[k] = supports[k][lane];
        return boxes.found.size() <= most;
    };
    if (!visit_leaves(tree, shaft, boxes.stack, add))
        return false;
    std::sort(boxes.order.begin(), boxes.order.end());
    return true;
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

namespace {
HWY_EXPORT(find_leaves);
HWY_EXPORT(find_boxes);
} // namespace

bool find_leaves(const TriangleTree& tree, const Shaft& shaft, std::size_t most,
                 ShaftLeaves& leaves) {
    return HWY_DYNAMIC_DISPATCH(find_leaves)(tree, shaft, most, leaves);
}

bool find_boxes(const TriangleTree& tree, const Shaft& shaft, std::size_t most, ShaftBoxes& boxes) {
    return HWY_DYNAMIC_DISPATCH(find_boxes)(tree, shaft, most, boxes);
}

} // namespace relumine::prt
#endif // HWY_ONCE
