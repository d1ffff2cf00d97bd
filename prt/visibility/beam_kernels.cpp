#include "prt/visibility/beam_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "prt/visibility/triangle_verdict.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/visibility/beam_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/leaf_supports-inl.h"
#include "prt/visibility/leaf_test-inl.h"
#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Rounding errors and their bounds: docs/error-bounds.md, rows B5 and B6.
constexpr float LostRoundings = 192.0f;
constexpr float TooNearRoundings = 4096.0f;

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
    /// For each plane, the maximum of normal . x over the triangles. The last two mean nothing.
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
    alignas(64) std::array<std::uint32_t, ReceiverGroup::MaxSize> low_, high_;
    /// What cover() found.
    alignas(64) std::array<std::uint32_t, TriangleTree::Width> s_first_, s_last_, t_first_, t_last_;
    alignas(64) std::array<std::uint32_t, TriangleTree::Width> covered_low_, covered_high_;
};

/// Calls meet(triangle, ray, is_certain) where an asked ray may meet a triangle of the leaf.
template<class D, class Meet>
void find_meetings(D d, const PlacedLeaf& leaf, const PatchPlane& patch, const AskedRays& asked,
                   const Meet& meet) {
    for (std::size_t lane = 0; lane < leaf.size; lane += hn::Lanes(d)) {
        const TriangleView<D> view = view_of(d, leaf, lane, patch.sign, asked.origin);
        const std::size_t count = std::min<std::size_t>(leaf.size - lane, hn::Lanes(d));
        const std::uint32_t near = near_rays(d, view, asked) & ((1u << count) - 1);
        if (near == 0)
            continue;
        for (std::uint64_t rays = asked.rays; rays != 0; rays &= rays - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(rays));
            const Meets<D> met = meets(d, view, true, patch.s[j], patch.t[j]);
            const std::uint32_t hits = bits_of(d, met.hit);
            for (std::uint32_t bits = bits_of(d, met.maybe) & near; bits != 0; bits &= bits - 1) {
                const auto triangle = static_cast<std::size_t>(std::countr_zero(bits));
                meet(lane + triangle, j, (hits >> triangle & 1u) != 0);
            }
        }
    }
}

/// Finds the rays that the leaf blocks, and as maybes those that only the exact tracer knows. What
/// single precision leaves in doubt is judged in double.
template<class D>
RayVerdicts test_blocking_leaf(D d, const TriangleTree::Leaf& leaf, const PlacedLeaf& placed,
                               const BeamPatch& patch, AskedRays asked, const glm::vec3& origin) {
    RayVerdicts verdicts = test_leaf(d, placed, patch.plane, asked);
    asked.rays &= verdicts.maybes & ~verdicts.hits;
    verdicts.maybes = 0;
    if (asked.rays != 0) [[unlikely]]
        find_meetings(d, placed, patch.plane, asked,
                      [&](std::size_t triangle, std::size_t j, bool) {
                          const Verdict verdict =
                              judge(leaf, triangle, origin, patch.directions.direction(j));
                          verdicts.hits |= std::uint64_t{verdict == Verdict::Hit} << j;
                          verdicts.maybes |= std::uint64_t{verdict == Verdict::Doubt} << j;
                      });
    return verdicts;
}

/// Finds the rays that a leaf blocks whose triangles let some rays pass. `numbers` are the
/// triangles' in the mesh. Maybes are rays that only the exact tracer knows.
template<class D>
RayVerdicts test_passed_leaf(D d, const TriangleTree::Leaf& leaf,
                             const std::array<std::uint32_t, TriangleTree::Width>& numbers,
                             const PlacedLeaf& placed, const BeamPatch& patch,
                             const PassedTriangles& passed, const AskedRays& asked,
                             const glm::vec3& origin) {
    RayVerdicts verdicts;
    const auto passes = [&](std::size_t triangle, const glm::vec3& direction) {
        std::array<glm::dvec3, 3> corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] =
                glm::dvec3(leaf.corners[3 * k][triangle], leaf.corners[3 * k + 1][triangle],
                           leaf.corners[3 * k + 2][triangle]) -
                glm::dvec3(origin);
        return passed.see_through.light_passes(numbers[triangle], corners, origin, direction,
                                               passed.of);
    };
    find_meetings(d, placed, patch.plane, asked,
                  [&](std::size_t triangle, std::size_t j, bool is_certain) {
                      const std::uint64_t ray = std::uint64_t{1} << j;
                      if ((verdicts.hits & ray) != 0)
                          return;
                      const glm::vec3 direction = patch.directions.direction(j);
                      const Verdict verdict =
                          is_certain ? Verdict::Hit : judge(leaf, triangle, origin, direction);
                      if (verdict == Verdict::Doubt)
                          verdicts.maybes |= ray;
                      else if (verdict == Verdict::Hit && !passes(triangle, direction))
                          verdicts.hits |= ray;
                  });
    return verdicts;
}

void clear_certain(const TriangleTree& tree, const PassedTriangles* passed, const BeamPatch& patch,
                   const ShaftLeaves& leaves, const GroupOrigins& origins,
                   const ReceiverCones& cones, std::span<std::uint64_t> rays,
                   std::span<std::uint64_t> doubts) {
    const hn::CappedTag<float, TriangleTree::Width> d;
    OpenRays<hn::CappedTag<float, TriangleTree::Width>> open(patch.plane, origins, cones, rays);
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
            const AskedRays asked = open.asked(first, lane);
            const std::size_t receiver = first + lane;
            const glm::vec3& origin = origins.all[receiver];
            const RayVerdicts verdicts =
                passed == nullptr
                    ? test_blocking_leaf(d, leaf, placed, patch, asked, origin)
                    : test_passed_leaf(d, leaf,
                                       tree.triangles[static_cast<std::size_t>(found.leaf)], placed,
                                       patch, *passed, asked, origin);
            doubts[receiver] |= verdicts.maybes;
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

void clear_certain(const TriangleTree& tree, const PassedTriangles* passed, const BeamPatch& patch,
                   const ShaftLeaves& leaves, const GroupOrigins& origins,
                   const ReceiverCones& cones, std::span<std::uint64_t> rays,
                   std::span<std::uint64_t> doubts) {
    HWY_DYNAMIC_DISPATCH(clear_certain)
    (tree, passed, patch, leaves, origins, cones, rays, doubts);
}

} // namespace relumine::prt
#endif // HWY_ONCE
