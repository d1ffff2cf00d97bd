// The rays of a group of receivers through a patch of directions: a rectangle before the receivers,
// and six planes around the rays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// Rounding to the nearest float is off by at most this part of the result.
inline constexpr float Rounding = 0x1p-24f;

/// The rectangle around a patch of directions on a plane before the receivers. Each direction is a
/// multiple of sign * axis + s * axis_s + t * axis_t.
struct PatchRectangle {
    /// The axis that all directions go along. axis_s is (axis + 1) % 3, axis_t is (axis + 2) % 3.
    int axis = 0;
    float sign = 1.0f;
    float s0 = 0.0f, s1 = 0.0f, t0 = 0.0f, t1 = 0.0f;
};

/// The directions of a patch in their rectangle. Direction j is at s[j], t[j]; from num_directions
/// on, the first one again.
struct PatchPlane : PatchRectangle {
    /// All directions have a positive component along the axis, and lie in a small rectangle.
    bool narrow = false;
    alignas(64) std::array<float, DirectionPatch::Size> s{}, t{};
    std::size_t num_directions = 0;

    /// The rectangle is cut into columns along s and rows along t. Directions lie in all but the
    /// first and the last, which stand for what is beside the rectangle.
    static constexpr std::size_t NumBins = 16;
    struct Bins {
        /// Its last bits are the integer next to what is added.
        static constexpr float ToInteger = 0x1p23f;
        template<class T>
        using Row = std::array<T, NumBins>;

        float begin = 0.0f, per_unit = 0.0f;
        /// For each column or row, the directions up to it (until) and from it on (from), itself
        /// included: bit j of half h is direction 32 h + j.
        alignas(64) std::array<Row<std::uint32_t>, 2> until{}, from{};
        /// The greatest place of the directions up to it, and the least of those from it on.
        Row<float> greatest_until{}, least_from{};

        /// Kernels do the same step by step, so that rounding keeps the order of places.
        [[nodiscard]] std::size_t bin(float place) const;
    };
    Bins columns, rows;
};

/// Half-spaces normal . x >= offset that hold all rays of a group through a patch, in the tree's
/// coordinates: normal . w >= 0 for all directions w, and normal . o >= offset for all origins o.
struct Shaft {
    static constexpr std::size_t NumPlanes = 6;
    std::array<glm::vec3, NumPlanes> normals;
    std::array<float, NumPlanes> offsets;
    /// Bounds of the error of normal . (x - o) in float.
    std::array<float, NumPlanes> margins;
    /// Corners of the patch's rectangle. Every direction is a sum of them with positive factors.
    std::array<glm::vec3, 4> corners;
    /// A box around the origins, in the mesh's coordinates.
    glm::vec3 origins_low{0.0f}, origins_high{0.0f};
    /// Largest coordinate of leaves and origins, in the tree's coordinates.
    float reach = 0.0f;
    int axis = 0;
    float sign = 1.0f;
};

/// Returns the rectangle of a patch. Where the directions share no axis, `narrow` is false and the
/// other fields mean nothing.
[[nodiscard]] PatchPlane patch_plane(const DirectionPatch& patch);

/// Returns the planes around a rectangle before the origins are known: all offsets are at infinity.
/// `mean_normal` is a hint where the receivers face. `reach` is the largest coordinate of triangles
/// and origins.
[[nodiscard]] Shaft shaft_of(const PatchRectangle& patch, const glm::vec3& mean_normal,
                             float reach);

} // namespace relumine::prt
