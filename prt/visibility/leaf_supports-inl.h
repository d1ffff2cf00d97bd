// How far the triangles of a leaf reach into a shaft. Compiled once per instruction set, inside a
// Highway block.
#if defined(RELUMINE_PRT_LEAF_SUPPORTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_PRT_LEAF_SUPPORTS_INL_H
#undef RELUMINE_PRT_LEAF_SUPPORTS_INL_H
#else
#define RELUMINE_PRT_LEAF_SUPPORTS_INL_H
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <hwy/highway.h>

#include "prt/visibility/shaft.h"
#include "prt/visibility/triangle_tree.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Rounding errors and their bounds: docs/error-bounds.md, rows S4 and S5.
inline constexpr double HeightRoundings = 64.0;
inline constexpr double AwayRoundings = 32.0;

/// Whether all rays of the shaft run away from the triangle's plane, which then says more than a
/// large triangle's box does.
inline bool leaves_plane(const TriangleTree::Leaf& leaf, std::size_t lane, const Shaft& shaft) {
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

inline bool leaves_planes(const TriangleTree::Leaf& leaf, const Shaft& shaft) {
    constexpr std::uint32_t FewTriangles = 4; // more are rarely large
    if (leaf.size > FewTriangles)
        return false;
    for (std::size_t lane = 0; lane < leaf.size; ++lane)
        if (!leaves_plane(leaf, lane, shaft))
            return false;
    return true;
}

/// Writes the largest lane of each of four vectors: four reductions for the steps of one and a
/// half.
template<class D, class V = hn::Vec<D>>
HWY_INLINE void store_largest(D d, V a, V b, V c, V e, float* largest) {
#if HWY_TARGET == HWY_SCALAR
    const V all[4] = {a, b, c, e};
    for (std::size_t i = 0; i < 4; ++i)
        largest[i] = hn::GetLane(hn::MaxOfLanes(d, all[i]));
#else
    const hn::Repartition<double, D> pairs;
    const auto ab =
        hn::BitCast(pairs, hn::Max(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b)));
    const auto ce =
        hn::BitCast(pairs, hn::Max(hn::InterleaveLower(d, c, e), hn::InterleaveUpper(d, c, e)));
    V all = hn::Max(hn::BitCast(d, hn::InterleaveLower(pairs, ab, ce)),
                    hn::BitCast(d, hn::InterleaveUpper(pairs, ab, ce)));
    if constexpr (hn::MaxLanes(D()) == 16)
        all = hn::Max(all, hn::ReverseBlocks(d, all));
    if constexpr (hn::MaxLanes(D()) >= 8)
        all = hn::Max(all, hn::SwapAdjacentBlocks(all));
    alignas(64) std::array<float, TriangleTree::Width> lanes;
    hn::Store(all, d, lanes.data());
    std::copy_n(lanes.begin(), 4, largest);
#endif
}

/// Writes the supports of a leaf's triangles, which are much closer than those of its box where a
/// surface runs along a plane. False where one says that the leaf is outside.
inline bool supports_inside(const TriangleTree::Leaf& leaf, const glm::vec3& centre,
                            const Shaft& shaft, std::array<float, 8>& supports) {
    static_assert(Shaft::NumPlanes <= 8);
    const hn::CappedTag<float, TriangleTree::Width> d;
    using Vector = hn::Vec<decltype(d)>;
    Vector most[Shaft::NumPlanes];
    for (std::size_t lane = 0; lane < TriangleTree::Width; lane += hn::Lanes(d)) {
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
    store_largest(d, most[0], most[1], most[2], most[3], supports.data());
    store_largest(d, most[4], most[5], most[5], most[5], supports.data() + 4);
    bool inside = true;
    for (std::size_t k = 0; k < Shaft::NumPlanes; ++k)
        inside = inside && supports[k] >= shaft.offsets[k];
    return inside;
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif // toggle
