// One receiver's rays against the triangles of a leaf. Compiled once per instruction set, inside a
// Highway block.
#if defined(RELUMINE_PRT_LEAF_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_PRT_LEAF_TEST_INL_H
#undef RELUMINE_PRT_LEAF_TEST_INL_H
#else
#define RELUMINE_PRT_LEAF_TEST_INL_H
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "prt/visibility/mask_bits-inl.h"
#include "prt/visibility/shaft.h"
#include "prt/visibility/triangle_tree.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Edge function k of a ray with direction w: ((corner k - o) x edge k) . w, up to sign the volume
/// that ray and edge span. The ray hits the triangle when all three have the sign of normal .
/// (corner - o), which says from which side the receiver looks.
///
/// Rounding errors and their bounds: docs/error-bounds.md, rows B1 to B4.
inline constexpr float EdgeTolerance = 256.0f * Rounding;
inline constexpr float SideTolerance = 96.0f * Rounding;
inline constexpr float Smallest = 1e-35f; // products below are lost

/// From so many rays for each triangle that may meet one, rays side by side are faster than
/// triangles side by side. Measured.
inline constexpr int RaysPerTriangle = 6;

/// A leaf's triangles about one of their corners, in the patch's axes. What all receivers share.
struct PlacedLeaf {
    using Row = std::array<float, TriangleTree::Width>;
    /// x, y, z of an edge's vector, or of another
    using Vectors = std::array<Row, 3>;

    /// The corner, and the largest coordinate of the others from there.
    std::array<float, 3> place;
    float radius;
    std::uint32_t size;
    alignas(64) std::array<Vectors, 3> edge;
    /// corner k x edge k
    std::array<Vectors, 3> moment;
    /// edge 0 x edge 1, and its product with corner 0
    Vectors normal;
    Row height;
    Row longest;
};

/// Axis, axis_s and axis_t of a patch.
inline std::array<std::size_t, 3> axes_of(const PatchPlane& patch) {
    const auto axis = static_cast<std::size_t>(patch.axis);
    return {axis, (axis + 1) % 3, (axis + 2) % 3};
}

template<class V>
HWY_INLINE V cross(const V (&p)[3], const V (&q)[3], std::size_t a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    return hn::MulSub(p[b], q[c], hn::Mul(p[c], q[b]));
}

template<class D>
void place_leaf(D d, const TriangleTree::Leaf& leaf, const PatchPlane& patch, PlacedLeaf& placed) {
    using Vector = hn::Vec<D>;
    const std::array<std::size_t, 3> axes = axes_of(patch);
    for (std::size_t a = 0; a < 3; ++a)
        placed.place[a] = leaf.corners[axes[a]][0];
    placed.size = leaf.size;
    Vector radius = hn::Zero(d);
    for (std::size_t lane = 0; lane < TriangleTree::Width; lane += hn::Lanes(d)) {
        const auto store = [&](Vector v, PlacedLeaf::Row& row) {
            hn::Store(v, d, row.data() + lane);
        };
        Vector corner[3][3], edge[3][3], from_place[3][3];
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t a = 0; a < 3; ++a) {
                corner[k][a] = hn::Load(d, leaf.corners[3 * k + axes[a]].data() + lane);
                from_place[k][a] = hn::Sub(corner[k][a], hn::Set(d, placed.place[a]));
                radius = hn::Max(radius, hn::Abs(from_place[k][a]));
            }
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t a = 0; a < 3; ++a) {
                edge[k][a] = hn::Sub(corner[(k + 1) % 3][a], corner[k][a]);
                store(edge[k][a], placed.edge[k][a]);
            }
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t a = 0; a < 3; ++a)
                store(cross(from_place[k], edge[k], a), placed.moment[k][a]);
        Vector height = hn::Zero(d);
        for (std::size_t a = 0; a < 3; ++a) {
            const Vector normal = cross(edge[0], edge[1], a);
            store(normal, placed.normal[a]);
            height = hn::MulAdd(normal, from_place[0][a], height);
        }
        store(height, placed.height);
        store(hn::Load(d, leaf.longest.data() + lane), placed.longest);
    }
    placed.radius = hn::GetLane(hn::MaxOfLanes(d, radius));
}

/// The rays of a receiver that a leaf may block.
struct AskedRays {
    /// Where they start, in the patch's axes.
    std::array<float, 3> origin;
    /// A rectangle around them.
    float s0, s1, t0, t1;
    std::uint64_t rays;
};

struct RayVerdicts {
    std::uint64_t hits = 0;
    std::uint64_t maybes = 0;
};

/// Edge functions of triangles as one receiver sees them: value k at s, t is moment[k] . (1, s, t),
/// turned so that a hit's three are positive.
template<class D>
struct TriangleView {
    using Vector = hn::Vec<D>;
    Vector moment[3][3];
    /// A value beyond has a sign for certain.
    Vector certain;
    /// Seen so obliquely that the sides are unknown
    hn::Mask<D> edge_on;

    HWY_INLINE Vector edge_function(std::size_t k, Vector s, Vector t) const {
        return hn::MulAdd(t, moment[k][2], hn::MulAdd(s, moment[k][1], moment[k][0]));
    }
};

template<class D>
HWY_INLINE TriangleView<D> view_of(D d, const PlacedLeaf& leaf, std::size_t lane, float sign,
                                   const std::array<float, 3>& origin) {
    using Vector = hn::Vec<D>;
    const auto row = [&](const PlacedLeaf::Row& values) {
        return hn::Load(d, values.data() + lane);
    };
    std::array<float, 3> from_place{};
    float farthest = 0.0f;
    for (std::size_t a = 0; a < 3; ++a) {
        from_place[a] = origin[a] - leaf.place[a];
        farthest = std::max(farthest, std::abs(from_place[a]));
    }
    const Vector o[3] = {hn::Set(d, from_place[0]), hn::Set(d, from_place[1]),
                         hn::Set(d, from_place[2])};
    const float reach = leaf.radius + farthest;
    const Vector longest = row(leaf.longest);
    const Vector smallest = hn::Set(d, Smallest);
    TriangleView<D> view;
    view.certain = hn::MulAdd(longest, hn::Set(d, EdgeTolerance * reach), smallest);
    Vector side = row(leaf.height);
    for (std::size_t a = 0; a < 3; ++a)
        side = hn::NegMulAdd(row(leaf.normal[a]), o[a], side);
    const Vector side_certain =
        hn::MulAdd(hn::Mul(longest, longest), hn::Set(d, SideTolerance * reach), smallest);
    view.edge_on = hn::Not(hn::Gt(hn::Abs(side), side_certain));
    const Vector turn = hn::And(side, hn::SignBit(d));
    const Vector turn_along = hn::Xor(turn, hn::And(hn::Set(d, sign), hn::SignBit(d)));
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
            const Vector moment =
                hn::MulAdd(row(leaf.edge[k][b]), o[c],
                           hn::NegMulAdd(row(leaf.edge[k][c]), o[b], row(leaf.moment[k][a])));
            view.moment[k][a] = hn::Xor(moment, a == 0 ? turn_along : turn);
        }
    return view;
}

/// The triangles that may meet a ray in the rectangle. An edge function is largest at one of the
/// rectangle's corners, with its roundings.
template<class D>
HWY_INLINE std::uint32_t near_rays(D d, const TriangleView<D>& view, const AskedRays& asked) {
    const auto zero = hn::Zero(d);
    const auto possible = hn::Neg(view.certain);
    auto near = hn::FirstN(d, hn::Lanes(d));
    for (std::size_t k = 0; k < 3; ++k) {
        const auto s = hn::IfThenElse(hn::Lt(view.moment[k][1], zero), hn::Set(d, asked.s0),
                                      hn::Set(d, asked.s1));
        const auto t = hn::IfThenElse(hn::Lt(view.moment[k][2], zero), hn::Set(d, asked.t0),
                                      hn::Set(d, asked.t1));
        near = hn::And(near, hn::Ge(view.edge_function(k, s, t), possible));
    }
    return bits_of(d, hn::Or(view.edge_on, near));
}

/// Triangles that a ray meets for certain, and triangles that it may meet.
template<class D>
struct Meets {
    hn::Mask<D> hit, maybe;
};
template<class D>
HWY_INLINE Meets<D> meets(D d, const TriangleView<D>& view, bool any_edge_on, float at_s,
                          float at_t) {
    const auto s = hn::Set(d, at_s);
    const auto t = hn::Set(d, at_t);
    const auto e0 = view.edge_function(0, s, t);
    const auto e1 = view.edge_function(1, s, t);
    const auto e2 = view.edge_function(2, s, t);
    const auto least = hn::Min(hn::Min(e0, e1), e2);
    Meets<D> result{hn::Gt(least, view.certain), hn::Ge(least, hn::Neg(view.certain))};
    // Seen from near its plane, a triangle is missed for certain only where its line is from both
    // sides.
    if (any_edge_on) {
        const auto most = hn::Max(hn::Max(e0, e1), e2);
        result.hit = hn::AndNot(view.edge_on, result.hit);
        result.maybe = hn::Or(result.maybe, hn::And(view.edge_on, hn::Le(most, view.certain)));
    }
    return result;
}

/// Tests triangles side by side, ray by ray.
template<class D>
HWY_INLINE RayVerdicts test_triangles(D d, const TriangleView<D>& view, const PatchPlane& patch,
                                      std::uint64_t rays) {
    const bool any_edge_on = !hn::AllFalse(d, view.edge_on);
    RayVerdicts verdicts;
    // Without a branch for what a ray meets, which a processor cannot guess.
    for (; rays != 0; rays &= rays - 1) {
        const auto j = static_cast<std::size_t>(std::countr_zero(rays));
        const Meets<D> met = meets(d, view, any_edge_on, patch.s[j], patch.t[j]);
        verdicts.hits |= std::uint64_t{!hn::AllFalse(d, met.hit)} << j;
        verdicts.maybes |= std::uint64_t{!hn::AllFalse(d, met.maybe)} << j;
    }
    return verdicts;
}

/// Tests all rays of the patch side by side, triangle by triangle. None is seen edge-on.
template<class D>
HWY_INLINE RayVerdicts test_rays(D d, const TriangleView<D>& view, const PatchPlane& patch,
                                 std::uint32_t triangles) {
    alignas(64) float rows[10][TriangleTree::Width];
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a)
            hn::Store(view.moment[k][a], d, rows[3 * k + a]);
    hn::Store(view.certain, d, rows[9]);
    RayVerdicts verdicts;
    for (; triangles != 0; triangles &= triangles - 1) {
        const auto triangle = static_cast<std::size_t>(std::countr_zero(triangles));
        TriangleView<D> of_triangle;
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t a = 0; a < 3; ++a)
                of_triangle.moment[k][a] = hn::Set(d, rows[3 * k + a][triangle]);
        const auto certain = hn::Set(d, rows[9][triangle]);
        const auto possible = hn::Neg(certain);
        for (std::size_t j = 0; j < patch.num_directions; j += hn::Lanes(d)) {
            const auto s = hn::Load(d, patch.s.data() + j);
            const auto t = hn::Load(d, patch.t.data() + j);
            const auto least = hn::Min(
                hn::Min(of_triangle.edge_function(0, s, t), of_triangle.edge_function(1, s, t)),
                of_triangle.edge_function(2, s, t));
            verdicts.hits |= std::uint64_t{bits_of(d, hn::Gt(least, certain))} << j;
            verdicts.maybes |= std::uint64_t{bits_of(d, hn::Ge(least, possible))} << j;
        }
    }
    return verdicts;
}

template<class D>
RayVerdicts test_leaf(D d, const PlacedLeaf& leaf, const PatchPlane& patch,
                      const AskedRays& asked) {
    RayVerdicts verdicts;
    for (std::size_t lane = 0; lane < leaf.size; lane += hn::Lanes(d)) {
        const TriangleView<D> view = view_of(d, leaf, lane, patch.sign, asked.origin);
        const std::uint32_t near = near_rays(d, view, asked);
        if (near == 0)
            continue;
        const bool few_triangles =
            std::popcount(asked.rays) > RaysPerTriangle * std::popcount(near);
        const RayVerdicts more = few_triangles && hn::AllFalse(d, view.edge_on)
                                     ? test_rays(d, view, patch, near)
                                     : test_triangles(d, view, patch, asked.rays);
        verdicts.hits |= more.hits;
        verdicts.maybes |= more.maybes;
    }
    return verdicts;
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif // toggle
