#include "prt/visibility/beam_kernels.h"

#include <algorithm>
#include <array>
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
/// Rounding errors and their bounds: docs/error-bounds.md, rows B1 to B5.
constexpr float EdgeTolerance = 240.0f * Rounding;
constexpr float SideTolerance = 80.0f * Rounding;
constexpr float Smallest = 1e-35f; // products below are lost
constexpr float LostRoundings = 192.0f;
constexpr float TooNearRoundings = 4096.0f;

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
    const std::array<float, 3> coordinates = {origin.x, origin.y, origin.z};
    Vector corner[3][3], to_corner[3][3];
    Vector reach = hn::Zero(d);
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a) {
            corner[k][a] = hn::Load(d, leaf.corners[3 * k + axes[a]].data() + lane);
            to_corner[k][a] = hn::Sub(corner[k][a], hn::Set(d, coordinates[axes[a]]));
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

    // Without a branch for what a ray meets, which a processor cannot guess.
    std::uint64_t hits = 0;
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
        hits |= std::uint64_t{!hn::AllFalse(d, hit)} << j;
        doubts |= std::uint64_t{!hn::AllFalse(d, maybe)} << j;
    }
    rays &= ~hits;
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

/// One over the distances of boxes from a receiver, and what rounding may lose of a quotient.
template<class V>
struct BoxDistances {
    V per_near, per_far, slack;
};

/// Columns or rows of the patch that 16 boxes cover as one receiver sees them, along one axis.
/// Boxes that begin behind the receiver or too close for a division cover all.
template<class D>
struct Cover {
    hn::Vec<hn::RebindToSigned<D>> first, last;
};
template<class D, class V>
HWY_INLINE Cover<D> covered_bins(D d, V low, V high, const BoxDistances<V>& boxes, float begin,
                                 float bins_per_unit) {
    const hn::RebindToSigned<D> di;
    const auto zero = hn::Zero(d);
    // The least quotient: a negative numerator over the least distance, a positive one over the
    // greatest.
    const V least = hn::Mul(low, hn::IfThenElse(hn::Lt(low, zero), boxes.per_near, boxes.per_far));
    const V most = hn::Mul(high, hn::IfThenElse(hn::Lt(high, zero), boxes.per_far, boxes.per_near));
    const V scale = hn::Set(d, bins_per_unit);
    const V from = hn::Mul(hn::Sub(hn::Sub(least, boxes.slack), hn::Set(d, begin)), scale);
    const V to = hn::Mul(hn::Sub(hn::Add(most, boxes.slack), hn::Set(d, begin)), scale);
    // Clamped to one bin beyond either end, which says: outside.
    const V below = hn::Set(d, -1.0f);
    const V above = hn::Set(d, static_cast<float>(PatchPlane::NumBins));
    return {hn::ConvertTo(di, hn::Floor(hn::Min(hn::Max(from, below), above))),
            hn::ConvertTo(di, hn::Floor(hn::Min(hn::Max(to, below), above)))};
}

/// The leaves of a shaft as one receiver sees them, a vector of leaves at a time.
template<class D>
class LeafView {
    using Vector = hn::Vec<D>;

public:
    HWY_INLINE LeafView(const PatchPlane& patch, const Shaft& shaft, const ShaftLeaves& leaves,
                        const glm::vec3& o)
        : patch_(patch), leaves_(leaves) {
        const D d;
        // The receiver's own cone: the shaft's planes, moved to its origin.
        for (std::size_t k = 0; k < Shaft::NumPlanes; ++k)
            offsets_[k] = hn::Set(d, glm::dot(shaft.normals[k], o) - shaft.margins[k]);
        o_m_ = hn::Set(d, patch.sign * o[patch.axis]);
        o_s_ = hn::Set(d, o[(patch.axis + 1) % 3]);
        o_t_ = hn::Set(d, o[(patch.axis + 2) % 3]);
        lost_ = hn::Set(d, LostRoundings * Rounding * shaft.reach + Smallest);
        too_near_ = hn::Set(d, TooNearRoundings * Rounding * shaft.reach + 64.0f * Smallest);
    }

    /// Which of the leaves from i on reach into the receiver's cone.
    HWY_INLINE std::uint32_t in_cone(std::size_t i) const {
        const D d;
        auto mask = hn::Ge(hn::LoadU(d, leaves_.supports[0].data() + i), offsets_[0]);
        for (std::size_t k = 1; k < Shaft::NumPlanes; ++k)
            mask = hn::And(mask, hn::Ge(hn::LoadU(d, leaves_.supports[k].data() + i), offsets_[k]));
        return bits_of(d, mask);
    }

    /// Finds which columns and rows of the patch the boxes of the leaves from i on cover. Returns
    /// the boxes that are outside of all.
    HWY_INLINE std::uint32_t cover(std::size_t i) {
        const D d;
        const hn::RebindToSigned<D> di;
        const auto relative = [&](std::size_t row, Vector from) {
            return hn::Sub(hn::LoadU(d, leaves_.boxes[row].data() + i), from);
        };
        const Vector near = relative(0, o_m_);
        const auto in_front = hn::Gt(near, too_near_);
        const Vector per_near = hn::Div(hn::Set(d, 1.0f), near);
        const Vector per_far = hn::Div(hn::Set(d, 1.0f), relative(1, o_m_));
        const BoxDistances<Vector> distances{per_near, per_far, hn::Mul(lost_, per_near)};
        const auto columns = covered_bins(d, relative(2, o_s_), relative(3, o_s_), distances,
                                          patch_.s0, patch_.bins_per_s);
        const auto rows = covered_bins(d, relative(4, o_t_), relative(5, o_t_), distances,
                                       patch_.t0, patch_.bins_per_t);
        const auto first = hn::Zero(di);
        const auto last = hn::Set(di, PatchPlane::NumBins - 1);
        const auto in_front_i = hn::RebindMask(di, in_front);
        hn::Store(hn::IfThenElse(in_front_i, hn::Max(columns.first, first), first), di,
                  s_first_.data());
        hn::Store(hn::IfThenElse(in_front_i, hn::Min(columns.last, last), last), di,
                  s_last_.data());
        hn::Store(hn::IfThenElse(in_front_i, hn::Max(rows.first, first), first), di,
                  t_first_.data());
        hn::Store(hn::IfThenElse(in_front_i, hn::Min(rows.last, last), last), di, t_last_.data());
        // Outside in one of the four ways: no ray.
        const auto beside = hn::Or(hn::Or(hn::Gt(columns.first, last), hn::Gt(first, columns.last)),
                                   hn::Or(hn::Gt(rows.first, last), hn::Gt(first, rows.last)));
        return bits_of(di, hn::And(beside, in_front_i));
    }

    /// The patch's rays in the columns and rows of box `lane`.
    HWY_INLINE std::uint64_t touching(std::size_t lane) const {
        const auto at = [&](const std::array<std::uint64_t, PatchPlane::NumBins>& table,
                            const std::array<std::int32_t, Width>& bins) {
            return table[static_cast<std::size_t>(bins[lane])];
        };
        return at(patch_.from_s, s_first_) & at(patch_.until_s, s_last_) &
               at(patch_.from_t, t_first_) & at(patch_.until_t, t_last_);
    }

private:
    const PatchPlane& patch_;
    const ShaftLeaves& leaves_;
    Vector offsets_[Shaft::NumPlanes];
    Vector o_m_, o_s_, o_t_, lost_, too_near_;
    alignas(64) std::array<std::int32_t, Width> s_first_, s_last_, t_first_, t_last_;
};

std::uint64_t clear_certain(const TriangleTree& tree, const PatchPlane& patch, const Shaft& shaft,
                            const ShaftLeaves& leaves, const glm::vec3& origin,
                            std::uint64_t& rays) {
    const hn::CappedTag<float, Width> d;
    LeafView<hn::CappedTag<float, Width>> view(patch, shaft, leaves, origin - tree.centre);
    std::uint64_t doubts = 0;
    for (std::size_t i = 0; i < leaves.size; i += hn::Lanes(d)) {
        std::uint32_t bits = view.in_cone(i);
        if (bits == 0)
            continue;
        bits &= ~view.cover(i);
        for (; bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
            const std::uint64_t touching = view.touching(lane) & rays;
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
