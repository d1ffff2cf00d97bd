#include "prt/visibility/beam_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/visibility/beam_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t Width = TriangleTree::Width;

/// Edge function k of a ray with direction w: ((corner k - o) x edge k) . w, up to sign the volume
/// that ray and edge span. The ray hits the triangle when all three have the sign of normal .
/// (corner - o), which says from which side the receiver looks.
///
/// Error bounds, u = 2^-24, D = largest |corner - o|, L = longest edge, by components. Corners and
/// origins are exact. D and L are off by u of themselves; a component of the cross product is at
/// most 2 L D and off by 8 u L D; |w| has components of at most 2, off by u; the sum of three
/// products adds 9 roundings of at most 10 L D. Together less than 120 u L D; the same bound holds
/// for the errors of Embree's edge functions near a triangle, so that beyond twice that both must
/// agree. Far beside it Embree's may be off by more, as it rounds corner - o first; RayScene drops
/// such hits. The normal is at most 2 L^2 and off by 8 u L^2, its product with D off by less than
/// 40 u L^2 D.
constexpr float EdgeTolerance = 240.0f * Rounding;
constexpr float SideTolerance = 80.0f * Rounding;
constexpr float Smallest = 1e-35f; // products below are lost

/// From so many rays for each triangle of a leaf on, rays side by side are faster than triangles
/// side by side. Measured.
constexpr std::uint32_t RaysPerTriangle = 6;

/// Tests the rays of one receiver against a leaf's triangles: all triangles at a time, ray by ray.
template<class D>
void test_triangles_side_by_side(D d, const TriangleTree::Leaf& leaf, std::size_t lane,
                                 const PatchPlane& patch, const glm::vec3& origin,
                                 std::uint64_t touching, std::uint64_t& rays,
                                 std::uint64_t& doubts) {
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
    const Vector side =
        hn::MulAdd(cross(edge[0], edge[1], 0), to_corner[0][0],
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
        if (any_edge_on) { // seen from near its plane, a triangle is missed for certain only where
                           // its line is from both sides
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
void test_rays_side_by_side(D d, const TriangleTree::Leaf& leaf, std::size_t lane,
                            const PatchPlane& patch, const glm::vec3& origin, std::uint64_t& rays,
                            std::uint64_t& doubts) {
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
        test_triangles_side_by_side(d, leaf, lane / hn::Lanes(d) * hn::Lanes(d), patch, origin,
                                    rays, rays, doubts);
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

/// Columns or rows of the patch that 16 boxes cover as one receiver sees them, along one axis.
/// Boxes that begin behind the receiver or too close for a division cover all.
template<class D>
struct Cover {
    hn::Vec<hn::RebindToSigned<D>> first, last;
};
template<class D, class V>
Cover<D> covered_bins(D d, V low, V high, V per_near, V per_far, V slack, float begin,
                      float bins_per_unit) {
    const hn::RebindToSigned<D> di;
    const auto zero = hn::Zero(d);
    // The least quotient: a negative numerator over the least distance, a positive one over the
    // greatest.
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
                            const ShaftLeaves& leaves, const glm::vec3& origin,
                            std::uint64_t& rays) {
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
    // A difference of coordinates is off by 4 roundings of the reach, and the exact tracer may hit
    // what is 56 off, as for the shaft's margins; a quotient (of at most 2) by three times that
    // over the distance.
    const Vector lost = hn::Set(d, 192.0f * Rounding * shaft.reach + Smallest);
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
        const auto columns = covered_bins(d, relative(2, o_s), relative(3, o_s), per_near, per_far,
                                          slack, patch.s0, patch.bins_per_s);
        const auto rows = covered_bins(d, relative(4, o_t), relative(5, o_t), per_near, per_far,
                                       slack, patch.t0, patch.bins_per_t);
        const auto first = hn::Zero(di);
        const auto last = hn::Set(di, PatchPlane::NumBins - 1);
        const auto in_front_i = hn::RebindMask(di, in_front);
        // Outside in one of the four ways: no ray.
        const auto beside = hn::Or(hn::Or(hn::Gt(columns.first, last), hn::Gt(first, columns.last)),
                                   hn::Or(hn::Gt(rows.first, last), hn::Gt(first, rows.last)));
        bits &= ~bits_of(di, hn::And(beside, in_front_i));
        alignas(64) std::array<std::int32_t, Width> s_first, s_last, t_first, t_last;
        hn::Store(hn::IfThenElse(in_front_i, hn::Max(columns.first, first), first), di,
                  s_first.data());
        hn::Store(hn::IfThenElse(in_front_i, hn::Min(columns.last, last), last), di, s_last.data());
        hn::Store(hn::IfThenElse(in_front_i, hn::Max(rows.first, first), first), di,
                  t_first.data());
        hn::Store(hn::IfThenElse(in_front_i, hn::Min(rows.last, last), last), di, t_last.data());
        for (; bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
            const auto at = [&](const std::array<std::uint64_t, PatchPlane::NumBins>& table,
                                const std::array<std::int32_t, Width>& bins) {
                return table[static_cast<std::size_t>(bins[lane])];
            };
            const std::uint64_t touching = at(patch.from_s, s_first) & at(patch.until_s, s_last) &
                                           at(patch.from_t, t_first) & at(patch.until_t, t_last) &
                                           rays;
            if (touching == 0)
                continue;
            const TriangleTree::Leaf& leaf =
                tree.leaves[static_cast<std::size_t>(leaves.leaves[i + lane])];
            if (static_cast<std::uint32_t>(std::popcount(touching)) > RaysPerTriangle * leaf.size)
                for (std::size_t triangle = 0; triangle < leaf.size; ++triangle)
                    test_rays_side_by_side(d, leaf, triangle, patch, origin, rays, doubts);
            else
                for (std::size_t first_lane = 0; first_lane < leaf.size; first_lane += hn::Lanes(d))
                    test_triangles_side_by_side(d, leaf, first_lane, patch, origin, touching & rays,
                                                rays, doubts);
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
HWY_EXPORT(clear_certain);
} // namespace

std::uint64_t clear_certain(const TriangleTree& tree, const PatchPlane& patch, const Shaft& shaft,
                            const ShaftLeaves& leaves, const glm::vec3& origin,
                            std::uint64_t& rays) {
    return HWY_DYNAMIC_DISPATCH(clear_certain)(tree, patch, shaft, leaves, origin, rays);
}

} // namespace relumine::prt
#endif // HWY_ONCE
