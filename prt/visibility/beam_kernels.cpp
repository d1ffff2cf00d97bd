#include "prt/visibility/beam_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "prt/visibility/triangle_verdict.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/visibility/beam_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/leaf_supports-inl.h"
#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t Width = TriangleTree::Width;
constexpr std::size_t MaxReceivers = ReceiverGroup::MaxSize;

/// Edge function k of a ray with direction w: ((corner k - o) x edge k) . w, up to sign the volume
/// that ray and edge span. The ray hits the triangle when all three have the sign of normal .
/// (corner - o), which says from which side the receiver looks.
///
/// Rounding errors and their bounds: docs/error-bounds.md, rows B1 to B6.
constexpr float EdgeTolerance = 256.0f * Rounding;
constexpr float SideTolerance = 96.0f * Rounding;
constexpr float Smallest = 1e-35f; // products below are lost
constexpr float LostRoundings = 192.0f;
constexpr float TooNearRoundings = 4096.0f;

/// From so many rays for each triangle that may meet one, rays side by side are faster than
/// triangles side by side. Measured.
constexpr int RaysPerTriangle = 6;

/// A leaf's triangles about one of their corners, in the patch's axes. What all receivers share.
struct PlacedLeaf {
    using Row = std::array<float, Width>;
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
std::array<std::size_t, 3> axes_of(const PatchPlane& patch) {
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
    for (std::size_t lane = 0; lane < Width; lane += hn::Lanes(d)) {
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

/// Edge functions of triangles as one receiver sees them: value k at s, t is
/// moment[k] . (1, s, t), turned so that a hit's three are positive.
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

/// Triangles that a ray meets for certain, and those that it may meet.
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
    if (any_edge_on) { // seen from near its plane, a triangle is missed for certain only where its
                       // line is from both sides
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
    alignas(64) float rows[10][Width];
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
        for (std::size_t j = 0; j < DirectionPatch::Size; j += hn::Lanes(d)) {
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

/// One over the distances of a box from receivers, and what rounding may lose of a quotient.
template<class V>
struct BoxDistances {
    V per_near, per_far, slack;
};

/// The bins that a box covers along one axis, as receivers see it.
template<class D>
struct Cover {
    hn::Vec<hn::RebindToUnsigned<D>> first, last;
};
template<class D, class V>
HWY_INLINE Cover<D> covered_bins(D d, V low, V high, const BoxDistances<V>& box,
                                 const PatchPlane::Bins& bins) {
    const hn::RebindToUnsigned<D> du;
    const auto zero = hn::Zero(d);
    // The least quotient: a negative numerator over the least distance, a positive one over the
    // greatest.
    const V least = hn::Mul(low, hn::IfThenElse(hn::Lt(low, zero), box.per_near, box.per_far));
    const V most = hn::Mul(high, hn::IfThenElse(hn::Lt(high, zero), box.per_far, box.per_near));
    const auto bin = [&](V place) { // PatchPlane::Bins::bin
        const V exact = hn::Mul(hn::Sub(place, hn::Set(d, bins.begin)), hn::Set(d, bins.per_unit));
        const V last = hn::Set(d, static_cast<float>(PatchPlane::NumBins - 1));
        const V rounded =
            hn::Add(hn::Min(hn::Max(exact, zero), last), hn::Set(d, PatchPlane::Bins::ToInteger));
        return hn::And(hn::BitCast(du, rounded), hn::Set(du, PatchPlane::NumBins - 1));
    };
    return {bin(hn::Sub(least, box.slack)), bin(hn::Add(most, box.slack))};
}

/// Entry `bins` of a table.
template<class DU, class V>
HWY_INLINE V look_up(DU du, const PatchPlane::Bins::Row<std::uint32_t>& table, V bins) {
    static_assert(PatchPlane::NumBins == 16);
    if constexpr (hn::MaxLanes(DU()) == 16) {
        return hn::TableLookupLanes(hn::Load(du, table.data()), hn::IndicesFromVec(du, bins));
    } else if constexpr (hn::MaxLanes(DU()) == 8) {
        const V low = hn::And(bins, hn::Set(du, 7));
        const auto index = hn::IndicesFromVec(du, low);
        return hn::IfThenElse(hn::Eq(low, bins),
                              hn::TableLookupLanes(hn::Load(du, table.data()), index),
                              hn::TableLookupLanes(hn::Load(du, table.data() + 8), index));
    } else {
        alignas(16) std::array<std::uint32_t, hn::MaxLanes(DU())> entries;
        hn::Store(bins, du, entries.data());
        for (std::uint32_t& entry : entries)
            entry = table[entry];
        return hn::Load(du, entries.data());
    }
}

/// A leaf in a shaft, as all receivers of a group see it.
struct ShaftLeaf {
    /// For each plane, the maximum of normal . x over the triangles; two more.
    alignas(32) std::array<float, 8> supports;
    /// The box in the patch's axes: low and high along `axis` (times its sign), along s, along t.
    std::array<float, 6> box;
};

/// Looks at a leaf's triangles. False where they say that it is outside of the shaft.
bool reaches_inside(const TriangleTree& tree, const Shaft& shaft, const ShaftLeaves::Found& found,
                    ShaftLeaf& leaf) {
    const TriangleTree::Leaf& triangles = tree.leaves[static_cast<std::size_t>(found.leaf)];
    if (leaves_planes(triangles, shaft) ||
        !supports_inside(triangles, tree.centre, shaft, leaf.supports))
        return false;
    const TriangleTree::Node& node = tree.nodes[static_cast<std::size_t>(found.node)];
    const auto low = [&](std::size_t a) {
        return node.bounds[a % 3][found.lane];
    };
    const auto high = [&](std::size_t a) {
        return node.bounds[a % 3 + 3][found.lane];
    };
    const auto axis = static_cast<std::size_t>(shaft.axis);
    leaf.box = {found.near,    shaft.sign > 0.0f ? high(axis) : -low(axis),
                low(axis + 1), high(axis + 1),
                low(axis + 2), high(axis + 2)};
    return true;
}

/// The rays of a group that no leaf has blocked yet.
template<class D>
class OpenRays {
    using Vector = hn::Vec<D>;

public:
    OpenRays(const PatchPlane& patch, const GroupOrigins& origins, const ReceiverCones& cones,
             std::span<std::uint64_t> rays)
        : patch_(patch), origins_(origins), cones_(cones), rays_(rays), axes_(axes_of(patch)),
          lost_(LostRoundings * Rounding * origins.reach + Smallest),
          too_near_(TooNearRoundings * Rounding * origins.reach + 64.0f * Smallest) {
        low_.fill(0);
        high_.fill(0);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            set(i, rays[i]);
            num_open_ += rays[i] != 0 ? 1 : 0;
        }
    }

    [[nodiscard]] bool empty() const { return num_open_ == 0; }

    /// Which bundles have a cone that the leaf reaches into.
    [[nodiscard]] HWY_INLINE std::uint32_t in_bundles(const ShaftLeaf& leaf) const {
        const hn::CappedTag<float, ReceiverCones::NumBundles> d;
        std::uint32_t bundles = 0;
        for (std::size_t first = 0; first < ReceiverCones::NumBundles; first += hn::Lanes(d)) {
            auto mask = hn::FirstN(d, hn::Lanes(d));
            for (std::size_t k = 0; k < Shaft::NumPlanes; ++k)
                mask = hn::And(mask, hn::Ge(hn::Set(d, leaf.supports[k]),
                                            hn::Load(d, cones_.of_bundles[k].data() + first)));
            bundles |= bits_of(d, mask) << first;
        }
        return bundles;
    }

    /// Which of the receivers from `first` on have a cone that the leaf reaches into.
    [[nodiscard]] HWY_INLINE std::uint32_t in_cones(const ShaftLeaf& leaf,
                                                    std::size_t first) const {
        const D d;
        auto mask = hn::FirstN(d, hn::Lanes(d));
        for (std::size_t k = 0; k < Shaft::NumPlanes; ++k)
            mask = hn::And(mask, hn::Ge(hn::Set(d, leaf.supports[k]),
                                        hn::Load(d, cones_.offsets[k].data() + first)));
        return bits_of(d, mask);
    }

    /// Finds what the leaf's box covers of the patch for the receivers from `first` on. Returns
    /// those that have rays there.
    HWY_INLINE std::uint32_t cover(const ShaftLeaf& leaf, std::size_t first) {
        const D d;
        const hn::RebindToUnsigned<D> du;
        const Vector along = hn::Load(d, origins_.from_centre[axes_[0]].data() + first);
        const Vector o_m = hn::Mul(along, hn::Set(d, patch_.sign));
        const Vector o_s = hn::Load(d, origins_.from_centre[axes_[1]].data() + first);
        const Vector o_t = hn::Load(d, origins_.from_centre[axes_[2]].data() + first);
        const auto relative = [&](std::size_t row, Vector from) {
            return hn::Sub(hn::Set(d, leaf.box[row]), from);
        };
        const Vector near = relative(0, o_m);
        const auto in_front = hn::RebindMask(du, hn::Gt(near, hn::Set(d, too_near_)));
        const Vector per_near = hn::Div(hn::Set(d, 1.0f), near);
        const Vector per_far = hn::Div(hn::Set(d, 1.0f), relative(1, o_m));
        const BoxDistances<Vector> distances{per_near, per_far,
                                             hn::Mul(hn::Set(d, lost_), per_near)};
        const Cover<D> columns =
            covered_bins(d, relative(2, o_s), relative(3, o_s), distances, patch_.columns);
        const Cover<D> rows =
            covered_bins(d, relative(4, o_t), relative(5, o_t), distances, patch_.rows);
        // Boxes that begin behind a receiver, or too close for a division, cover all.
        const auto last = hn::Set(du, PatchPlane::NumBins - 1);
        const auto s_first = hn::IfThenElseZero(in_front, columns.first);
        const auto s_last = hn::IfThenElse(in_front, columns.last, last);
        const auto t_first = hn::IfThenElseZero(in_front, rows.first);
        const auto t_last = hn::IfThenElse(in_front, rows.last, last);
        hn::Store(s_first, du, s_first_.data());
        hn::Store(s_last, du, s_last_.data());
        hn::Store(t_first, du, t_first_.data());
        hn::Store(t_last, du, t_last_.data());
        const auto covered = [&](std::size_t half) {
            return hn::And(hn::And(look_up(du, patch_.columns.from[half], s_first),
                                   look_up(du, patch_.columns.until[half], s_last)),
                           hn::And(look_up(du, patch_.rows.from[half], t_first),
                                   look_up(du, patch_.rows.until[half], t_last)));
        };
        const auto low = hn::And(covered(0), hn::Load(du, low_.data() + first));
        const auto high = hn::And(covered(1), hn::Load(du, high_.data() + first));
        hn::Store(low, du, covered_low_.data());
        hn::Store(high, du, covered_high_.data());
        return bits_of(du, hn::Ne(hn::Or(low, high), hn::Zero(du)));
    }

    /// The rays of receiver first + lane that the box covers.
    [[nodiscard]] HWY_INLINE AskedRays asked(std::size_t first, std::size_t lane) const {
        const auto origin = [&](std::size_t a) {
            return origins_.rows[axes_[a]][first + lane];
        };
        return {.origin = {origin(0), origin(1), origin(2)},
                .s0 = patch_.columns.least_from[s_first_[lane]],
                .s1 = patch_.columns.greatest_until[s_last_[lane]],
                .t0 = patch_.rows.least_from[t_first_[lane]],
                .t1 = patch_.rows.greatest_until[t_last_[lane]],
                .rays = std::uint64_t{covered_high_[lane]} << 32u | covered_low_[lane]};
    }

    /// Clears rays of receiver i.
    HWY_INLINE void clear(std::size_t i, std::uint64_t hits) {
        if (hits == 0)
            return;
        rays_[i] &= ~hits;
        set(i, rays_[i]);
        num_open_ -= rays_[i] == 0 ? 1 : 0;
    }

private:
    HWY_INLINE void set(std::size_t i, std::uint64_t rays) {
        low_[i] = static_cast<std::uint32_t>(rays);
        high_[i] = static_cast<std::uint32_t>(rays >> 32u);
    }

    const PatchPlane& patch_;
    const GroupOrigins& origins_;
    const ReceiverCones& cones_;
    std::span<std::uint64_t> rays_;
    std::array<std::size_t, 3> axes_;
    float lost_, too_near_;
    std::size_t num_open_ = 0;
    /// The first and the last 32 directions of `rays_`.
    alignas(64) std::array<std::uint32_t, MaxReceivers> low_, high_;
    /// What cover() found.
    alignas(64) std::array<std::uint32_t, Width> s_first_, s_last_, t_first_, t_last_;
    alignas(64) std::array<std::uint32_t, Width> covered_low_, covered_high_;
};

/// Judges rays that the leaf may block in double precision.
template<class D>
RayVerdicts judge_rays(D d, const TriangleTree::Leaf& leaf, const PlacedLeaf& placed,
                       const BeamPatch& patch, const AskedRays& asked, const glm::vec3& origin) {
    RayVerdicts verdicts;
    for (std::size_t lane = 0; lane < leaf.size; lane += hn::Lanes(d)) {
        const TriangleView<D> view = view_of(d, placed, lane, patch.plane.sign, asked.origin);
        for (std::uint64_t rays = asked.rays; rays != 0; rays &= rays - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(rays));
            const Meets<D> met = meets(d, view, true, patch.plane.s[j], patch.plane.t[j]);
            for (std::uint32_t bits = bits_of(d, met.maybe); bits != 0; bits &= bits - 1) {
                const std::size_t triangle =
                    lane + static_cast<std::size_t>(std::countr_zero(bits));
                const Verdict verdict =
                    judge(leaf, triangle, origin, patch.directions.direction(j));
                verdicts.hits |= std::uint64_t{verdict == Verdict::Hit} << j;
                verdicts.maybes |= std::uint64_t{verdict == Verdict::Doubt} << j;
            }
        }
    }
    return verdicts;
}

void clear_certain(const TriangleTree& tree, const BeamPatch& patch, const ShaftLeaves& leaves,
                   const GroupOrigins& origins, const ReceiverCones& cones,
                   std::span<std::uint64_t> rays, std::span<std::uint64_t> doubts) {
    const hn::CappedTag<float, Width> d;
    OpenRays<hn::CappedTag<float, Width>> open(patch.plane, origins, cones, rays);
    PlacedLeaf placed;
    std::fill(doubts.begin(), doubts.end(), 0);
    for (const std::uint32_t i : leaves.order) {
        const ShaftLeaves::Found& found = leaves.found[i];
        const TriangleTree::Leaf& leaf = tree.leaves[static_cast<std::size_t>(found.leaf)];
        ShaftLeaf in_shaft;
        if (!reaches_inside(tree, patch.shaft, found, in_shaft))
            continue;
        bool is_placed = false;
        const auto test = [&](std::size_t first, std::size_t lane) {
            if (!is_placed)
                place_leaf(d, leaf, patch.plane, placed);
            is_placed = true;
            AskedRays asked = open.asked(first, lane);
            RayVerdicts verdicts = test_leaf(d, placed, patch.plane, asked);
            const std::size_t receiver = first + lane;
            asked.rays &= verdicts.maybes & ~verdicts.hits;
            if (asked.rays != 0) [[unlikely]] {
                const RayVerdicts judged =
                    judge_rays(d, leaf, placed, patch, asked, origins.all[receiver]);
                verdicts.hits |= judged.hits;
                doubts[receiver] |= judged.maybes;
            }
            open.clear(receiver, verdicts.hits);
        };
        for (std::uint32_t bundles = open.in_bundles(in_shaft); bundles != 0;
             bundles &= bundles - 1) {
            const auto begin =
                static_cast<std::size_t>(std::countr_zero(bundles)) * ReceiverCones::BundleSize;
            for (std::size_t first = begin; first < begin + ReceiverCones::BundleSize;
                 first += hn::Lanes(d)) {
                std::uint32_t bits = open.in_cones(in_shaft, first);
                if (bits == 0)
                    continue;
                for (bits &= open.cover(in_shaft, first); bits != 0; bits &= bits - 1)
                    test(first, static_cast<std::size_t>(std::countr_zero(bits)));
            }
        }
        if (open.empty())
            break;
    }
    for (std::size_t i = 0; i < rays.size(); ++i)
        doubts[i] &= rays[i];
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

namespace {
HWY_EXPORT(clear_certain);
} // namespace

void clear_certain(const TriangleTree& tree, const BeamPatch& patch, const ShaftLeaves& leaves,
                   const GroupOrigins& origins, const ReceiverCones& cones,
                   std::span<std::uint64_t> rays, std::span<std::uint64_t> doubts) {
    HWY_DYNAMIC_DISPATCH(clear_certain)(tree, patch, leaves, origins, cones, rays, doubts);
}

} // namespace relumine::prt
#endif // HWY_ONCE
