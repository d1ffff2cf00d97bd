#include "prt/beam_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/beam_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t Width = TriangleTree::Width;

template<class D>
std::uint32_t bits_of(D d, hn::Mask<D> mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    std::uint32_t bits = 0;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
}

/// Children of a node that are not outside of the shaft. The corner of a box that lies farthest along a normal has the high coordinates
/// where the normal's are positive.
std::uint32_t children_inside(const TriangleTree::Node& node, const Shaft& shaft) {
    const hn::CappedTag<float, Width> d;
    std::uint32_t inside = 0;
    for (std::size_t lane = 0; lane < Width; lane += hn::Lanes(d)) {
        auto mask = hn::FirstN(d, Width);
        for (std::size_t k = 0; k < Shaft::NumPlanes; ++k) {
            const glm::vec3& n = shaft.normals[k];
            const auto farthest = [&](std::size_t axis, float component) {
                return hn::Load(d, node.bounds[component >= 0.0f ? axis + 3 : axis].data() + lane);
            };
            const auto support = hn::MulAdd(
                hn::Set(d, n.x), farthest(0, n.x),
                hn::MulAdd(hn::Set(d, n.y), farthest(1, n.y), hn::Mul(hn::Set(d, n.z), farthest(2, n.z))));
            mask = hn::And(mask, hn::Ge(support, hn::Set(d, shaft.offsets[k])));
        }
        inside |= bits_of(d, mask) << lane;
    }
    return inside;
}

/// Whether all rays of the shaft run away from the triangle's plane, which then says more than a large triangle's box does.
bool leaves_plane(const TriangleTree::Leaf& leaf, std::size_t lane, const Shaft& shaft) {
    glm::dvec3 corner[3];
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a)
            corner[k][static_cast<int>(a)] = static_cast<double>(leaf.corners[3 * k + a][lane]);
    const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const glm::dvec3 middle = 0.5 * (glm::dvec3(shaft.origins_low) + glm::dvec3(shaft.origins_high));
    const glm::dvec3 half = 0.5 * (glm::dvec3(shaft.origins_high) - glm::dvec3(shaft.origins_low));
    const double height = glm::dot(normal, middle - corner[0]);
    const double spread = glm::dot(glm::abs(normal), half);
    // Embree sees the receiver's side of the plane in float; a ray that runs along the plane must not be judged.
    const double size = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    const double longest = static_cast<double>(leaf.longest[lane]);
    const double margin =
        64.0 * static_cast<double>(Rounding) * (size + longest * longest) * static_cast<double>(shaft.reach);
    if (!(std::abs(height) > spread + margin))
        return false;
    const double side = height > 0.0 ? 1.0 : -1.0;
    return std::all_of(shaft.corners.begin(), shaft.corners.end(), [&](const glm::vec3& w) {
        return side * glm::dot(normal, glm::dvec3(w)) >
               32.0 * static_cast<double>(Rounding) * (size + longest * longest);
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

/// Writes the supports of a leaf's triangles, which are much closer than those of its box where a surface runs along a plane. False where one says
/// that the leaf is outside.
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
                return hn::MulAdd(nx, corner[i], hn::MulAdd(ny, corner[i + 1], hn::Mul(nz, corner[i + 2])));
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

bool find_leaves(const TriangleTree& tree, const Shaft& shaft, ShaftLeaves& leaves) {
    leaves.found.clear();
    leaves.stack.clear();
    if (!tree.nodes.empty())
        leaves.stack.push_back(0);
    const auto axis = static_cast<std::size_t>(shaft.axis);
    while (!leaves.stack.empty()) {
        const std::int32_t index = leaves.stack.back();
        const TriangleTree::Node& node = tree.nodes[static_cast<std::size_t>(index)];
        leaves.stack.pop_back();
        for (std::uint32_t bits = children_inside(node, shaft); bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
            if (node.child[lane] >= 0)
                leaves.stack.push_back(node.child[lane]);
            else if (!leaves_planes(tree.leaves[static_cast<std::size_t>(~node.child[lane])], shaft))
                leaves.found.push_back(
                    {shaft.sign > 0.0f ? node.bounds[axis][lane] : -node.bounds[axis + 3][lane], index,
                     lane});
        }
    }
    if (leaves.found.size() > ShaftLeaves::MaxSize)
        return false;
    std::sort(leaves.found.begin(), leaves.found.end(),
              [](const ShaftLeaves::Found& a, const ShaftLeaves::Found& b) { return a.near < b.near; });
    leaves.size = 0;
    for (const ShaftLeaves::Found& found : leaves.found) {
        const TriangleTree::Node& node = tree.nodes[static_cast<std::size_t>(found.node)];
        const std::int32_t leaf = ~node.child[found.lane];
        const std::size_t i = leaves.size;
        if (!supports_inside(tree.leaves[static_cast<std::size_t>(leaf)], tree.centre, shaft, leaves, i))
            continue;
        ++leaves.size;
        leaves.leaves[i] = leaf;
        const auto low = [&](std::size_t a) {
            return node.bounds[a % 3][found.lane];
        };
        const auto high = [&](std::size_t a) {
            return node.bounds[a % 3 + 3][found.lane];
        };
        leaves.boxes[0][i] = found.near;
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

/// Edge function k of a ray with direction w: ((corner k - o) x edge k) . w, up to sign the volume that ray and edge span. The ray hits the
/// triangle when all three have the sign of normal . (corner - o), which says from which side the receiver looks.
///
/// Error bounds, u = 2^-24, D = largest |corner - o|, L = longest edge, by components. Corners and origins are exact. D and L are off by u
/// of themselves; a component of the cross product is at most 2 L D and off by 8 u L D; |w| has components of at most 2, off by u;
/// the sum of three products adds 9 roundings of at most 10 L D. Together less than 120 u L D; the same bound holds for
/// the errors of Embree's edge functions, so that beyond twice that both must agree.
/// The normal is at most 2 L^2 and off by 8 u L^2, its product with D off by less than 40 u L^2 D.
constexpr float EdgeTolerance = 240.0f * Rounding;
constexpr float SideTolerance = 80.0f * Rounding;
constexpr float Smallest = 1e-35f; // products below are lost

/// From so many rays for each triangle of a leaf on, rays side by side are faster than triangles side by side. Measured.
constexpr std::uint32_t RaysPerTriangle = 6;

/// Tests the rays of one receiver against a leaf's triangles: all triangles at a time, ray by ray.
template<class D>
void test_leaf(D d, const TriangleTree::Leaf& leaf, std::size_t lane, const PatchPlane& patch,
               const glm::vec3& origin, std::uint64_t touching, std::uint64_t& rays, std::uint64_t& doubts) {
    using Vector = hn::Vec<D>;
    const auto axis_m = static_cast<std::size_t>(patch.axis);
    const std::size_t axes[3] = {axis_m, (axis_m + 1) % 3, (axis_m + 2) % 3};
    Vector corner[3][3], to_corner[3][3];
    Vector reach = hn::Zero(d);
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a) {
            corner[k][a] = hn::Load(d, leaf.corners[3 * k + axes[a]].data() + lane);
            to_corner[k][a] = hn::Sub(corner[k][a], hn::Set(d, origin[static_cast<int>(axes[a])]));
            reach = hn::Max(reach, hn::Abs(to_corner[k][a]));
        }
    const Vector longest = hn::Load(d, leaf.longest.data() + lane);
    const Vector product = hn::Mul(longest, reach);
    const Vector certain = hn::MulAdd(product, hn::Set(d, EdgeTolerance), hn::Set(d, Smallest));
    const Vector possible = hn::Neg(certain);
    Vector edge[3][3];
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a)
            edge[k][a] = hn::Sub(corner[(k + 1) % 3][a], corner[k][a]);
    const auto cross = [&](const Vector(&p)[3], const Vector(&q)[3], std::size_t a) {
        return hn::MulSub(p[(a + 1) % 3], q[(a + 2) % 3], hn::Mul(p[(a + 2) % 3], q[(a + 1) % 3]));
    };
    const Vector side = hn::MulAdd(cross(edge[0], edge[1], 0), to_corner[0][0],
                                   hn::MulAdd(cross(edge[0], edge[1], 1), to_corner[0][1],
                                              hn::Mul(cross(edge[0], edge[1], 2), to_corner[0][2])));
    const Vector side_tolerance =
        hn::MulAdd(hn::Mul(product, longest), hn::Set(d, SideTolerance), hn::Set(d, Smallest));
    const auto edge_on = hn::Not(hn::Gt(hn::Abs(side), side_tolerance));
    const bool any_edge_on = !hn::AllFalse(d, edge_on);
    Vector moment[3][3]; // turned so that a hit's are all positive
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a)
            moment[k][a] = hn::Xor(cross(to_corner[k], edge[k], a), hn::And(side, hn::SignBit(d)));
    const Vector along = hn::Set(d, patch.sign);
    for (std::size_t k = 0; k < 3; ++k)
        moment[k][0] = hn::Mul(moment[k][0], along);

    for (std::uint64_t rest = touching; rest != 0; rest &= rest - 1) {
        const auto j = static_cast<std::size_t>(std::countr_zero(rest));
        const Vector s = hn::Set(d, patch.s[j]);
        const Vector t = hn::Set(d, patch.t[j]);
        const auto edge_function = [&](std::size_t k) {
            return hn::MulAdd(t, moment[k][2], hn::MulAdd(s, moment[k][1], moment[k][0]));
        };
        const Vector e0 = edge_function(0);
        const Vector e1 = edge_function(1);
        const Vector e2 = edge_function(2);
        const Vector least = hn::Min(hn::Min(e0, e1), e2);
        auto hit = hn::Gt(least, certain);
        auto maybe = hn::Ge(least, possible);
        if (any_edge_on) { // seen from near its plane, a triangle is missed for certain only where its line is from both sides
            const Vector most = hn::Max(hn::Max(e0, e1), e2);
            hit = hn::AndNot(edge_on, hit);
            maybe = hn::Or(maybe, hn::And(edge_on, hn::Le(most, certain)));
        }
        const std::uint64_t bit = std::uint64_t{1} << j;
        if (!hn::AllFalse(d, hit))
            rays &= ~bit;
        else if (!hn::AllFalse(d, maybe))
            doubts |= bit;
    }
}

/// The same for few triangles before many rays: all rays at a time, triangle by triangle.
template<class D>
void test_triangle(D d, const TriangleTree::Leaf& leaf, std::size_t lane, const PatchPlane& patch,
                   const glm::vec3& origin, std::uint64_t& rays, std::uint64_t& doubts) {
    glm::vec3 corner[3], to_corner[3];
    glm::vec3 farthest(0.0f);
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t a = 0; a < 3; ++a)
            corner[k][static_cast<int>(a)] = leaf.corners[3 * k + a][lane];
        to_corner[k] = corner[k] - origin;
        farthest = glm::max(farthest, glm::abs(to_corner[k]));
    }
    const glm::vec3 edge[3] = {corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
    const float product = leaf.longest[lane] * std::max({farthest.x, farthest.y, farthest.z});
    const float tolerance = EdgeTolerance * product + Smallest;
    const float side = glm::dot(glm::cross(edge[0], edge[1]), to_corner[0]);
    if (!(std::abs(side) > SideTolerance * product * leaf.longest[lane] + Smallest)) {
        test_leaf(d, leaf, lane / hn::Lanes(d) * hn::Lanes(d), patch, origin, rays, rays, doubts);
        return;
    }
    hn::Vec<D> moment[3][3];
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::vec3 m = (side > 0.0f ? 1.0f : -1.0f) * glm::cross(to_corner[k], edge[k]);
        moment[k][0] = hn::Set(d, patch.sign * m[patch.axis]);
        moment[k][1] = hn::Set(d, m[(patch.axis + 1) % 3]);
        moment[k][2] = hn::Set(d, m[(patch.axis + 2) % 3]);
    }
    const auto certain = hn::Set(d, tolerance);
    const auto possible = hn::Set(d, -tolerance);
    std::uint64_t hits = 0;
    std::uint64_t maybes = 0;
    for (std::size_t j = 0; j < DirectionPatch::Size; j += hn::Lanes(d)) {
        const auto s = hn::Load(d, patch.s.data() + j);
        const auto t = hn::Load(d, patch.t.data() + j);
        const auto edge_function = [&](std::size_t k) {
            return hn::MulAdd(t, moment[k][2], hn::MulAdd(s, moment[k][1], moment[k][0]));
        };
        const auto least = hn::Min(hn::Min(edge_function(0), edge_function(1)), edge_function(2));
        hits |= std::uint64_t{bits_of(d, hn::Gt(least, certain))} << j;
        maybes |= std::uint64_t{bits_of(d, hn::Ge(least, possible))} << j;
    }
    rays &= ~hits;
    doubts |= maybes;
}

/// Columns or rows of the patch that 16 boxes cover as one receiver sees them, along one axis. Boxes that begin behind the receiver or too
/// close for a division cover all.
template<class D>
struct Cover {
    hn::Vec<hn::RebindToSigned<D>> first, last;
};
template<class D, class V>
Cover<D> covered_bins(D d, V low, V high, V per_near, V per_far, V slack, float begin, float bins_per_unit) {
    const hn::RebindToSigned<D> di;
    const auto zero = hn::Zero(d);
    // The least quotient: a negative numerator over the least distance, a positive one over the greatest.
    const V least = hn::Mul(low, hn::IfThenElse(hn::Lt(low, zero), per_near, per_far));
    const V most = hn::Mul(high, hn::IfThenElse(hn::Lt(high, zero), per_far, per_near));
    const V scale = hn::Set(d, bins_per_unit);
    const V from = hn::Mul(hn::Sub(hn::Sub(least, slack), hn::Set(d, begin)), scale);
    const V to = hn::Mul(hn::Sub(hn::Add(most, slack), hn::Set(d, begin)), scale);
    // Clamped to one bin beyond either end, which says: outside.
    const V below = hn::Set(d, -1.0f);
    const V above = hn::Set(d, static_cast<float>(PatchPlane::NumBins));
    return {hn::ConvertTo(di, hn::Floor(hn::Min(hn::Max(from, below), above))),
            hn::ConvertTo(di, hn::Floor(hn::Min(hn::Max(to, below), above)))};
}

std::uint64_t clear_certain(const TriangleTree& tree, const PatchPlane& patch, const Shaft& shaft,
                            const ShaftLeaves& leaves, const glm::vec3& origin, std::uint64_t& rays) {
    const hn::CappedTag<float, Width> d;
    const hn::RebindToSigned<decltype(d)> di;
    using Vector = hn::Vec<decltype(d)>;
    const glm::vec3 o = origin - tree.centre;
    // The receiver's own cone: the shaft's planes, moved to its origin.
    Vector offsets[Shaft::NumPlanes];
    for (std::size_t k = 0; k < Shaft::NumPlanes; ++k)
        offsets[k] = hn::Set(d, glm::dot(shaft.normals[k], o) - shaft.margins[k]);
    const Vector o_m = hn::Set(d, patch.sign * o[patch.axis]);
    const Vector o_s = hn::Set(d, o[(patch.axis + 1) % 3]);
    const Vector o_t = hn::Set(d, o[(patch.axis + 2) % 3]);
    // A difference of coordinates is off by 4 roundings of the reach, a quotient (of at most 2) by three times that over the distance; the
    // exact tracer's corners by a few more, as for the shaft's margins.
    const Vector lost = hn::Set(d, 64.0f * Rounding * shaft.reach + Smallest);
    const Vector too_near = hn::Set(d, 4096.0f * Rounding * shaft.reach + 64.0f * Smallest);

    std::uint64_t doubts = 0;
    for (std::size_t i = 0; i < leaves.size; i += hn::Lanes(d)) {
        auto mask = hn::Ge(hn::LoadU(d, leaves.supports[0].data() + i), offsets[0]);
        for (std::size_t k = 1; k < Shaft::NumPlanes; ++k)
            mask = hn::And(mask, hn::Ge(hn::LoadU(d, leaves.supports[k].data() + i), offsets[k]));
        std::uint32_t bits = bits_of(d, mask);
        if (bits == 0)
            continue;
        // Which columns and rows of the patch each box covers.
        const auto relative = [&](std::size_t row, Vector from) {
            return hn::Sub(hn::LoadU(d, leaves.boxes[row].data() + i), from);
        };
        const Vector near = relative(0, o_m);
        const auto in_front = hn::Gt(near, too_near);
        const Vector per_near = hn::Div(hn::Set(d, 1.0f), near);
        const Vector per_far = hn::Div(hn::Set(d, 1.0f), relative(1, o_m));
        const Vector slack = hn::Mul(lost, per_near);
        const auto columns = covered_bins(d, relative(2, o_s), relative(3, o_s), per_near, per_far, slack,
                                          patch.s0, patch.bins_per_s);
        const auto rows = covered_bins(d, relative(4, o_t), relative(5, o_t), per_near, per_far, slack,
                                       patch.t0, patch.bins_per_t);
        const auto first = hn::Zero(di);
        const auto last = hn::Set(di, PatchPlane::NumBins - 1);
        const auto in_front_i = hn::RebindMask(di, in_front);
        // Outside in one of the four ways: no ray.
        const auto beside = hn::Or(hn::Or(hn::Gt(columns.first, last), hn::Gt(first, columns.last)),
                                   hn::Or(hn::Gt(rows.first, last), hn::Gt(first, rows.last)));
        bits &= ~bits_of(di, hn::And(beside, in_front_i));
        alignas(64) std::array<std::int32_t, Width> s_first, s_last, t_first, t_last;
        hn::Store(hn::IfThenElse(in_front_i, hn::Max(columns.first, first), first), di, s_first.data());
        hn::Store(hn::IfThenElse(in_front_i, hn::Min(columns.last, last), last), di, s_last.data());
        hn::Store(hn::IfThenElse(in_front_i, hn::Max(rows.first, first), first), di, t_first.data());
        hn::Store(hn::IfThenElse(in_front_i, hn::Min(rows.last, last), last), di, t_last.data());
        for (; bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
            const auto at = [&](const std::array<std::uint64_t, PatchPlane::NumBins>& table,
                                const std::array<std::int32_t, Width>& bins) {
                return table[static_cast<std::size_t>(bins[lane])];
            };
            const std::uint64_t touching = at(patch.from_s, s_first) & at(patch.until_s, s_last) &
                                           at(patch.from_t, t_first) & at(patch.until_t, t_last) & rays;
            if (touching == 0)
                continue;
            const TriangleTree::Leaf& leaf = tree.leaves[static_cast<std::size_t>(leaves.leaves[i + lane])];
            if (static_cast<std::uint32_t>(std::popcount(touching)) > RaysPerTriangle * leaf.size)
                for (std::size_t triangle = 0; triangle < leaf.size; ++triangle)
                    test_triangle(d, leaf, triangle, patch, origin, rays, doubts);
            else
                for (std::size_t first_lane = 0; first_lane < leaf.size; first_lane += hn::Lanes(d))
                    test_leaf(d, leaf, first_lane, patch, origin, touching & rays, rays, doubts);
            if (rays == 0)
                return 0;
        }
    }
    return doubts & rays;
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

namespace {
HWY_EXPORT(find_leaves);
HWY_EXPORT(clear_certain);
} // namespace

bool find_leaves(const TriangleTree& tree, const Shaft& shaft, ShaftLeaves& leaves) {
    return HWY_DYNAMIC_DISPATCH(find_leaves)(tree, shaft, leaves);
}

std::uint64_t clear_certain(const TriangleTree& tree, const PatchPlane& patch, const Shaft& shaft,
                            const ShaftLeaves& leaves, const glm::vec3& origin, std::uint64_t& rays) {
    return HWY_DYNAMIC_DISPATCH(clear_certain)(tree, patch, shaft, leaves, origin, rays);
}

} // namespace relumine::prt
#endif // HWY_ONCE
