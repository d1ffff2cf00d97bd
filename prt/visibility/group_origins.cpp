#include "prt/visibility/group_origins.h"

#include <algorithm>
#include <cstddef>
#include <limits>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/visibility/group_origins.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float Infinity = std::numeric_limits<float>::infinity();

/// Writes row - from to `relative` and returns its largest absolute value.
float subtract(const ReceiverRow& row, float from, ReceiverRow& relative) {
    const hn::CappedTag<float, TriangleTree::Width> d;
    auto farthest = hn::Zero(d);
    for (std::size_t i = 0; i < ReceiverGroup::MaxSize; i += hn::Lanes(d)) {
        const auto difference = hn::Sub(hn::Load(d, row.data() + i), hn::Set(d, from));
        hn::Store(difference, d, relative.data() + i);
        farthest = hn::Max(farthest, hn::Abs(difference));
    }
    return hn::GetLane(hn::MaxOfLanes(d, farthest));
}

void fill(const glm::vec3& centre, GroupOrigins& origins) {
    const hn::CappedTag<float, TriangleTree::Width> d;
    for (std::size_t i = 0; i < ReceiverGroup::MaxSize; ++i) {
        const glm::vec3& origin = origins.all[i < origins.all.size() ? i : 0];
        for (std::size_t axis = 0; axis < 3; ++axis)
            origins.rows[axis][i] = origin[static_cast<int>(axis)];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<int>(axis);
        const ReceiverRow& row = origins.rows[axis];
        auto low = hn::Load(d, row.data());
        auto high = low;
        for (std::size_t i = hn::Lanes(d); i < ReceiverGroup::MaxSize; i += hn::Lanes(d)) {
            low = hn::Min(low, hn::Load(d, row.data() + i));
            high = hn::Max(high, hn::Load(d, row.data() + i));
        }
        origins.low[a] = hn::GetLane(hn::MinOfLanes(d, low));
        origins.high[a] = hn::GetLane(hn::MaxOfLanes(d, high));
        origins.middle[a] = 0.5f * (origins.low[a] + origins.high[a]);
        origins.reach =
            std::max(origins.reach, subtract(row, centre[a], origins.from_centre[axis]));
        origins.radius =
            std::max(origins.radius, subtract(row, origins.middle[a], origins.from_middle[axis]));
    }
}

ReceiverCones place_shaft(const GroupOrigins& origins, std::span<const std::uint64_t> rays,
                          Shaft& shaft) {
    const hn::CappedTag<float, TriangleTree::Width> d;
    alignas(64) ReceiverRow absent; // infinite without rays, otherwise zero
    absent.fill(Infinity);
    for (std::size_t i = 0; i < rays.size(); ++i)
        absent[i] = rays[i] == 0 ? Infinity : 0.0f;
    ReceiverCones cones;
    for (std::size_t k = 0; k < Shaft::NumPlanes; ++k) {
        const auto margin = hn::Set(d, shaft.margins[k]);
        for (std::size_t i = 0; i < ReceiverGroup::MaxSize; i += hn::Lanes(d)) {
            auto along = hn::Load(d, absent.data() + i);
            for (std::size_t axis = 0; axis < 3; ++axis)
                along = hn::MulAdd(hn::Set(d, shaft.normals[k][static_cast<int>(axis)]),
                                   hn::Load(d, origins.from_centre[axis].data() + i), along);
            hn::Store(hn::Sub(along, margin), d, cones.offsets[k].data() + i);
        }
        shaft.offsets[k] = Infinity;
        for (std::size_t bundle = 0; bundle < ReceiverCones::NumBundles; ++bundle) {
            auto least = hn::Set(d, Infinity);
            for (std::size_t i = 0; i < ReceiverCones::BundleSize; i += hn::Lanes(d))
                least = hn::Min(least, hn::Load(d, cones.offsets[k].data() +
                                                       bundle * ReceiverCones::BundleSize + i));
            cones.of_bundles[k][bundle] = hn::GetLane(hn::MinOfLanes(d, least));
            shaft.offsets[k] = std::min(shaft.offsets[k], cones.of_bundles[k][bundle]);
        }
    }
    shaft.origins_low = origins.low;
    shaft.origins_high = origins.high;
    return cones;
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

namespace {
HWY_EXPORT(fill);
HWY_EXPORT(place_shaft);
} // namespace

GroupOrigins::GroupOrigins(const ReceiverGroup& group, const TriangleTree& tree)
    : all(group.origins), mean_normal(group.mean_normal), reach(tree.extent) {
    HWY_DYNAMIC_DISPATCH(fill)(tree.centre, *this);
}

ReceiverCones place_shaft(const GroupOrigins& origins, std::span<const std::uint64_t> rays,
                          Shaft& shaft) {
    return HWY_DYNAMIC_DISPATCH(place_shaft)(origins, rays, shaft);
}

} // namespace relumine::prt
#endif // HWY_ONCE
