#include "prt/visibility/parallel_rays.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "prt/visibility/bit_matrix.h"
#include "prt/visibility/shaft_leaves.h"
#include "prt/visibility/triangle_verdict.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/visibility/parallel_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Beyond so many leaves in one direction the exact tracer is faster. Measured.
constexpr std::size_t MostLeaves = 1024;

/// Rounding errors and their bounds: docs/error-bounds.md, rows P1 to P5.
constexpr float ParallelEdgeTolerance = 520.0f * Rounding;
constexpr float ParallelSideTolerance = 180.0f * Rounding;
constexpr float ParallelSmallest = 1e-35f; // products below are lost
constexpr float OutlineRoundings = 128.0f;
constexpr float DirectionSlack = 8.0f * Rounding; // of s and t

/// A leaf's triangles projected along the rays, about the middle of the group.
///
/// The rays' direction is w = sign * axis + s * axis_s + t * axis_t. Every point is moved along w
/// to the plane where its coordinate `axis` is 0; its other two coordinates stay, and triple
/// products with w become products of two edges in that plane.
struct ProjectedLeaf {
    using Row = std::array<float, TriangleTree::Width>;
    /// Around each triangle
    alignas(64) Row s_low, s_high, t_low, t_high;
    /// Edge function k of an origin o is constant - edge_t * o_s + edge_s * o_t; beyond `certain`
    /// it has a sign.
    std::array<Row, 3> edge_s, edge_t, constant;
    Row certain;
    /// normal . (corner 0 - o) = height - normal . o, along axis, axis_s, axis_t; beyond
    /// `side_certain` it has a sign.
    std::array<Row, 3> normal;
    Row height, side_certain;
};

/// That of the rays.
struct Direction {
    /// Axis, axis_s, axis_t
    std::size_t axes[3];
    float sign, s, t;
    /// The direction as the exact tracer has it
    glm::vec3 unit;
};

/// Stores what holds the triangles' corners along one axis, with what rounding may lose.
template<class D>
HWY_INLINE void store_range(D d, const hn::Vec<D> (&corners)[3], hn::Vec<D> lost, std::size_t lane,
                            ProjectedLeaf::Row& low, ProjectedLeaf::Row& high) {
    hn::Store(hn::Sub(hn::Min(hn::Min(corners[0], corners[1]), corners[2]), lost), d,
              low.data() + lane);
    hn::Store(hn::Add(hn::Max(hn::Max(corners[0], corners[1]), corners[2]), lost), d,
              high.data() + lane);
}

template<class D>
void project(D d, const TriangleTree::Leaf& leaf, const Direction& direction,
             const GroupOrigins& origins, ProjectedLeaf& projected) {
    using Vector = hn::Vec<D>;
    const Vector along_s = hn::Set(d, direction.sign * direction.s);
    const Vector along_t = hn::Set(d, direction.sign * direction.t);
    const Vector sign = hn::Set(d, direction.sign);
    for (std::size_t lane = 0; lane < TriangleTree::Width; lane += hn::Lanes(d)) {
        Vector corner[3][3], from_middle[3][3], edge[3][3];
        Vector reach = hn::Zero(d);
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t a = 0; a < 3; ++a) {
                corner[k][a] = hn::Load(d, leaf.corners[3 * k + direction.axes[a]].data() + lane);
                const float middle = origins.middle[static_cast<int>(direction.axes[a])];
                from_middle[k][a] = hn::Sub(corner[k][a], hn::Set(d, middle));
                reach = hn::Max(reach, hn::Abs(from_middle[k][a]));
            }
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t a = 0; a < 3; ++a)
                edge[k][a] = hn::Sub(corner[(k + 1) % 3][a], corner[k][a]);
        reach = hn::Add(reach, hn::Set(d, origins.radius));
        const Vector longest = hn::Load(d, leaf.longest.data() + lane);
        const Vector product = hn::Mul(longest, reach);
        const auto store = [&](Vector v, ProjectedLeaf::Row& row) {
            hn::Store(v, d, row.data() + lane);
        };

        Vector moved_s[3], moved_t[3];
        for (std::size_t k = 0; k < 3; ++k) {
            moved_s[k] = hn::NegMulAdd(along_s, from_middle[k][0], from_middle[k][1]);
            moved_t[k] = hn::NegMulAdd(along_t, from_middle[k][0], from_middle[k][2]);
            const Vector edge_s = hn::Mul(sign, hn::NegMulAdd(along_s, edge[k][0], edge[k][1]));
            const Vector edge_t = hn::Mul(sign, hn::NegMulAdd(along_t, edge[k][0], edge[k][2]));
            store(edge_s, projected.edge_s[k]);
            store(edge_t, projected.edge_t[k]);
            store(hn::MulSub(moved_s[k], edge_t, hn::Mul(moved_t[k], edge_s)),
                  projected.constant[k]);
        }
        store(hn::MulAdd(product, hn::Set(d, ParallelEdgeTolerance), hn::Set(d, ParallelSmallest)),
              projected.certain);
        const Vector lost = hn::MulAdd(reach, hn::Set(d, OutlineRoundings * Rounding),
                                       hn::Set(d, ParallelSmallest));
        store_range(d, moved_s, lost, lane, projected.s_low, projected.s_high);
        store_range(d, moved_t, lost, lane, projected.t_low, projected.t_high);

        Vector height = hn::Zero(d);
        for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
            const Vector normal =
                hn::MulSub(edge[0][b], edge[1][c], hn::Mul(edge[0][c], edge[1][b]));
            store(normal, projected.normal[a]);
            height = hn::MulAdd(normal, from_middle[0][a], height);
        }
        store(height, projected.height);
        store(hn::MulAdd(hn::Mul(product, longest), hn::Set(d, ParallelSideTolerance),
                         hn::Set(d, ParallelSmallest)),
              projected.side_certain);
    }
}

/// The receivers of a group projected along the rays, in bundles of as many as a vector has lanes.
struct ProjectedReceivers {
    using Row = ReceiverRow;
    /// From the middle, along axis, axis_s, axis_t
    std::array<const float*, 3> origin;
    /// Moved along the rays
    alignas(64) Row s, t;
    /// [bundles that have rays] bounds of the bundle's s and t
    Row s_low, s_high, t_low, t_high;
    /// [plane][bundle] offsets of the bundle's own shaft; infinite where it has no rays left
    std::array<Row, Shaft::NumPlanes> offsets;
};

template<class D>
hn::Mask<D> mask_of(D d, const ReceiverBits& bits, std::size_t first) {
    const std::uint64_t of_bundle = bits[first / WordSize] >> (first % WordSize);
    std::uint8_t bytes[8];
    std::memcpy(bytes, &of_bundle, sizeof bytes);
    return hn::LoadMaskBits(d, bytes);
}

/// Also sets the shaft's offsets to those of all bundles.
template<class D>
void project(D d, const Direction& direction, const GroupOrigins& origins,
             const ReceiverBits& active, Shaft& shaft, ProjectedReceivers& projected) {
    using Vector = hn::Vec<D>;
    const Vector infinity = hn::Set(d, std::numeric_limits<float>::infinity());
    const Vector along_s = hn::Set(d, direction.sign * direction.s);
    const Vector along_t = hn::Set(d, direction.sign * direction.t);
    for (std::size_t a = 0; a < 3; ++a)
        projected.origin[a] = origins.from_middle[direction.axes[a]].data();
    for (auto& row : projected.offsets)
        row.fill(std::numeric_limits<float>::infinity());
    for (std::size_t first = 0; first < ReceiverGroup::MaxSize; first += hn::Lanes(d)) {
        const auto mask = mask_of(d, active, first);
        if (hn::AllFalse(d, mask))
            continue;
        const std::size_t bundle = first / hn::Lanes(d);
        const auto least = [&](Vector v) {
            return hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(mask, v, infinity)));
        };
        const Vector o = hn::Load(d, projected.origin[0] + first);
        const Vector s = hn::NegMulAdd(along_s, o, hn::Load(d, projected.origin[1] + first));
        const Vector t = hn::NegMulAdd(along_t, o, hn::Load(d, projected.origin[2] + first));
        hn::Store(s, d, projected.s.data() + first);
        hn::Store(t, d, projected.t.data() + first);
        projected.s_low[bundle] = least(s);
        projected.s_high[bundle] = -least(hn::Neg(s));
        projected.t_low[bundle] = least(t);
        projected.t_high[bundle] = -least(hn::Neg(t));
        for (std::size_t k = 0; k < Shaft::NumPlanes; ++k) {
            Vector along = hn::Zero(d);
            for (std::size_t a = 0; a < 3; ++a)
                along = hn::MulAdd(hn::Set(d, shaft.normals[k][static_cast<int>(a)]),
                                   hn::Load(d, origins.from_centre[a].data() + first), along);
            projected.offsets[k][bundle] = least(along) - shaft.margins[k];
            shaft.offsets[k] = std::min(shaft.offsets[k], projected.offsets[k][bundle]);
        }
    }
}

/// Returns the triangles of a leaf whose outline comes near a bundle, one bit each.
template<class D>
HWY_INLINE std::uint32_t triangles_near(D d, const ProjectedLeaf& projected,
                                        const ProjectedReceivers& receivers, std::size_t bundle) {
    std::uint32_t near = 0;
    for (std::size_t lane = 0; lane < TriangleTree::Width; lane += hn::Lanes(d)) {
        const auto row = [&](const ProjectedLeaf::Row& values) {
            return hn::Load(d, values.data() + lane);
        };
        const auto s = hn::And(hn::Ge(hn::Set(d, receivers.s_high[bundle]), row(projected.s_low)),
                               hn::Ge(row(projected.s_high), hn::Set(d, receivers.s_low[bundle])));
        const auto t = hn::And(hn::Ge(hn::Set(d, receivers.t_high[bundle]), row(projected.t_low)),
                               hn::Ge(row(projected.t_high), hn::Set(d, receivers.t_low[bundle])));
        near |= bits_of(d, hn::And(s, t)) << lane;
    }
    return near;
}

/// Tests the rays of a bundle against a leaf's triangles. Bit i of `rays` is the bundle's receiver
/// i; clears those that are blocked for certain, and returns those that are in doubt.
template<class D>
std::uint32_t test_bundle(D d, const TriangleTree::Leaf& leaf, const ProjectedLeaf& projected,
                          const Direction& direction, const GroupOrigins& origins,
                          const ProjectedReceivers& receivers, std::size_t bundle,
                          std::uint32_t& rays) {
    using Vector = hn::Vec<D>;
    std::uint32_t near = triangles_near(d, projected, receivers, bundle);
    const std::size_t first = bundle * hn::Lanes(d);
    const Vector origin[3] = {hn::Load(d, receivers.origin[0] + first),
                              hn::Load(d, receivers.origin[1] + first),
                              hn::Load(d, receivers.origin[2] + first)};
    const Vector origin_s = hn::Load(d, receivers.s.data() + first);
    const Vector origin_t = hn::Load(d, receivers.t.data() + first);
    std::uint32_t doubts = 0;
    for (near &= (1u << leaf.size) - 1; near != 0; near &= near - 1) {
        const auto triangle = static_cast<std::size_t>(std::countr_zero(near));
        const auto all = [&](const ProjectedLeaf::Row& values) {
            return hn::Set(d, values[triangle]);
        };
        Vector side = all(projected.height);
        for (std::size_t a = 0; a < 3; ++a)
            side = hn::NegMulAdd(all(projected.normal[a]), origin[a], side);
        const auto edge_function = [&](std::size_t k) {
            const Vector e = hn::MulAdd(
                all(projected.edge_s[k]), origin_t,
                hn::NegMulAdd(all(projected.edge_t[k]), origin_s, all(projected.constant[k])));
            return hn::Xor(
                e, hn::And(side, hn::SignBit(d))); // turned so that a hit's are all positive
        };
        const Vector e0 = edge_function(0);
        const Vector e1 = edge_function(1);
        const Vector e2 = edge_function(2);
        const Vector least = hn::Min(hn::Min(e0, e1), e2);
        const Vector certain = all(projected.certain);
        const auto maybe = hn::Ge(least, hn::Neg(certain));
        const auto edge_on = hn::Not(hn::Gt(hn::Abs(side), all(projected.side_certain)));
        if (hn::AllFalse(d, hn::Or(maybe, edge_on)))
            continue;
        const std::uint32_t hits = bits_of(d, hn::AndNot(edge_on, hn::Gt(least, certain)));
        // Seen from near its plane, a triangle is missed for certain only where its line is from
        // both sides.
        const Vector most = hn::Max(hn::Max(e0, e1), e2);
        const auto unsure = hn::Or(maybe, hn::And(edge_on, hn::Le(most, certain)));
        rays &= ~hits;
        for (std::uint32_t rest = bits_of(d, unsure) & rays; rest != 0; rest &= rest - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(rest));
            const Verdict verdict = judge(leaf, triangle, origins.all[first + i], direction.unit);
            if (verdict == Verdict::Hit)
                rays &= ~(1u << i);
            else if (verdict == Verdict::Doubt)
                doubts |= 1u << i;
        }
        if (rays == 0)
            return 0;
    }
    return doubts & rays;
}

/// Tests a leaf with all bundles of receivers whose own shafts it reaches into.
template<class D>
void test_bundles(D d, const TriangleTree::Leaf& leaf, const ShaftLeaves::Found& found,
                  const Direction& direction, const GroupOrigins& origins,
                  ProjectedReceivers& receivers, ReceiverBits& lit, ReceiverBits& doubtful) {
    const std::size_t num_lanes = hn::Lanes(d);
    const std::size_t num_bundles = ReceiverGroup::MaxSize / num_lanes;
    const std::uint64_t lanes = (std::uint64_t{1} << num_lanes) - 1;
    bool is_projected = false;
    ProjectedLeaf projected;
    for (std::size_t first_bundle = 0; first_bundle < num_bundles; first_bundle += num_lanes) {
        auto inside = hn::FirstN(d, num_bundles - first_bundle);
        for (std::size_t k = 0; k < Shaft::NumPlanes; ++k)
            inside =
                hn::And(inside, hn::Le(hn::LoadU(d, receivers.offsets[k].data() + first_bundle),
                                       hn::Set(d, found.supports[k])));
        for (std::uint32_t bits = bits_of(d, inside); bits != 0; bits &= bits - 1) {
            if (!is_projected)
                project(d, leaf, direction, origins, projected);
            is_projected = true;
            const std::size_t bundle =
                first_bundle + static_cast<std::size_t>(std::countr_zero(bits));
            const std::size_t word = bundle * num_lanes / WordSize;
            const std::size_t shift = bundle * num_lanes % WordSize;
            const auto asked = static_cast<std::uint32_t>(lit[word] >> shift & lanes);
            std::uint32_t rays = asked;
            const std::uint64_t doubts =
                test_bundle(d, leaf, projected, direction, origins, receivers, bundle, rays);
            lit[word] &= ~(std::uint64_t{asked & ~rays} << shift);
            doubtful[word] |= doubts << shift;
            if (rays == 0) // it needs no more leaves
                receivers.offsets[0][bundle] = std::numeric_limits<float>::infinity();
        }
    }
}

/// The rays of a group in one direction.
struct ParallelRays {
    static constexpr hn::CappedTag<float, TriangleTree::Width> Floats{};

    Direction direction;
    Shaft shaft;
    ProjectedReceivers receivers;

    ParallelRays(const PatchDirection& of_patch, const GroupOrigins& origins,
                 const ReceiverBits& active) {
        const PatchPlane& patch = of_patch.plane;
        const std::size_t j = of_patch.index;
        const auto axis = static_cast<std::size_t>(patch.axis);
        direction = {.axes = {axis, (axis + 1) % 3, (axis + 2) % 3},
                     .sign = patch.sign,
                     .s = patch.s[j],
                     .t = patch.t[j],
                     .unit = of_patch.patch.direction(j)};
        shaft = shaft_of({.axis = patch.axis,
                          .sign = patch.sign,
                          .s0 = patch.s[j] - DirectionSlack,
                          .s1 = patch.s[j] + DirectionSlack,
                          .t0 = patch.t[j] - DirectionSlack,
                          .t1 = patch.t[j] + DirectionSlack},
                         origins.mean_normal, origins.reach);
        project(Floats, direction, origins, active, shaft, receivers);
    }
    /// Collects the leaves in the shaft (prt::find_leaves()). False: there are too many, and all
    /// rays are in doubt.
    [[nodiscard]] bool find_leaves(const TriangleTree& tree, ShaftLeaves& leaves) const {
        return prt::find_leaves(tree, shaft, MostLeaves, leaves);
    }
};

std::size_t num_leaves_along(const TriangleTree& tree, const PatchDirection& of_patch,
                             const GroupOrigins& origins, const ReceiverBits& active) {
    const ParallelRays rays(of_patch, origins, active);
    thread_local ShaftLeaves leaves;
    static_cast<void>(rays.find_leaves(tree, leaves));
    return leaves.found.size();
}

ParallelResult test_parallel_rays(const TriangleTree& tree, const PatchDirection& of_patch,
                                  const GroupOrigins& origins, const ReceiverBits& active) {
    ParallelRays rays(of_patch, origins, active);
    thread_local ShaftLeaves leaves;
    if (!rays.find_leaves(tree, leaves))
        return {.blocked = {}, .doubtful = active, .num_leaves = leaves.found.size()};
    ReceiverBits lit = active;
    ReceiverBits doubtful{};
    for (const std::uint32_t i : leaves.order) {
        const ShaftLeaves::Found& found = leaves.found[i];
        test_bundles(ParallelRays::Floats, tree.leaves[static_cast<std::size_t>(found.leaf)], found,
                     rays.direction, origins, rays.receivers, lit, doubtful);
    }
    ParallelResult result{.num_leaves = leaves.found.size()};
    for (std::size_t i = 0; i < lit.size(); ++i) {
        result.blocked[i] = active[i] & ~lit[i];
        result.doubtful[i] = doubtful[i] & lit[i];
    }
    return result;
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

namespace {
HWY_EXPORT(num_leaves_along);
HWY_EXPORT(test_parallel_rays);
} // namespace

std::size_t num_leaves_along(const TriangleTree& tree, const PatchDirection& of_patch,
                             const GroupOrigins& origins, const ReceiverBits& active) {
    return HWY_DYNAMIC_DISPATCH(num_leaves_along)(tree, of_patch, origins, active);
}

ParallelResult test_parallel_rays(const TriangleTree& tree, const PatchDirection& of_patch,
                                  const GroupOrigins& origins, const ReceiverBits& active) {
    return HWY_DYNAMIC_DISPATCH(test_parallel_rays)(tree, of_patch, origins, active);
}

} // namespace relumine::prt
#endif // HWY_ONCE
