// The two inner loops of BeamScene: finding the leaves in a shaft, and testing rays against their triangles. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/blockers.h"
#include "prt/triangle_tree.h"

namespace relumine::prt {

/// Roundings to the nearest float are off by at most this part of the result.
inline constexpr float Rounding = 0x1p-24f;

/// A patch of directions on a plane before the receivers: direction j is a multiple of sign * axis + s[j] * axis_s + t[j] * axis_t.
struct PatchPlane {
    int axis = 0; ///< along which all directions go; the other two are (axis + 1) % 3 and (axis + 2) % 3
    float sign = 1.0f;
    bool narrow =
        false; ///< all directions have a positive component along the axis, and lie in a small rectangle
    alignas(64) std::array<float, DirectionPatch::Size> s{}, t{};
    float s0 = 0.0f, s1 = 0.0f, t0 = 0.0f, t1 = 0.0f; ///< a rectangle that holds all of them

    /// The rectangle in columns and rows; for each, the directions in it or before it, in it or after it.
    static constexpr int NumBins = 32;
    float bins_per_s = 0.0f, bins_per_t = 0.0f;
    std::array<std::uint64_t, NumBins> until_s{}, from_s{}, until_t{}, from_t{};
};

/// Half-spaces normal . x >= offset that hold all rays of a block through a patch, in the tree's coordinates: normal . w >= 0 for all
/// directions w, and normal . o >= offset for all origins o.
struct Shaft {
    static constexpr std::size_t NumPlanes = 6;
    static constexpr std::size_t BackPlane = 4; ///< its normal is the patch's axis
    std::array<glm::vec3, NumPlanes> normals;
    std::array<float, NumPlanes> offsets;
    std::array<float, NumPlanes> margins; ///< bounds of the error of normal . (x - o) in float
    std::array<glm::vec3, 4>
        corners; ///< of the patch's rectangle: all directions are sums of these with positive factors
    glm::vec3 origins_low{0.0f}, origins_high{0.0f}; ///< a box around the origins, in the mesh's coordinates
    float reach = 0.0f; ///< largest coordinate of leaves and origins, in the tree's
    int axis = 0;
    float sign = 1.0f;
};

/// The leaves in a shaft, from near to far. Kept from shaft to shaft for its memory.
struct ShaftLeaves {
    static constexpr std::size_t MaxSize = 2048;
    static constexpr std::size_t Padding = 16;
    using Row = std::array<float, MaxSize + Padding>;

    std::size_t size = 0;
    /// max over a leaf's triangles of normal . x, for each plane; [size], then lanes that are outside of everything
    std::array<Row, Shaft::NumPlanes> supports;
    /// the boxes in the patch's axes: low and high along `axis` (times its sign), along s, along t
    std::array<Row, 6> boxes;
    std::array<std::int32_t, MaxSize + Padding> leaves;

    struct Found {
        float near = 0.0f;
        std::int32_t node = 0;
        std::uint32_t lane = 0;
    };
    std::vector<Found> found;
    std::vector<std::int32_t> stack;
};

/// Finds the leaves that are not wholly outside of one of the planes. False when they are more than MaxSize.
[[nodiscard]] bool find_leaves(const TriangleTree& tree, const Shaft& shaft, ShaftLeaves& leaves);

/// Clears the rays of one receiver that a triangle blocks for certain. Returns those of the rest that are not certain to miss all of them.
/// `origin` is in the mesh's coordinates.
[[nodiscard]] std::uint64_t clear_certain(const TriangleTree& tree, const PatchPlane& patch,
                                          const Shaft& shaft, const ShaftLeaves& leaves,
                                          const glm::vec3& origin, std::uint64_t& rays);

} // namespace relumine::prt
