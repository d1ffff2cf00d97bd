// The light transfer of points in a few directions: enough to tell where it changes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/progress.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// The texels of a cube map of 6 x 16 x 16, each with its solid angle. A patch of 8 x 8 texels is
/// traced as a beam.
class CoarseDirections {
public:
    static constexpr std::uint32_t Resolution = 16;
    static constexpr std::size_t NumPatches = 24;
    /// Bits of one point: a word for each patch, a bit for each direction whose light reaches it.
    using Bits = std::array<std::uint64_t, NumPatches>;

    CoarseDirections();

    /// Finds the directions whose light reaches each receiver: those above its horizon that are not
    /// blocked. Rays start as in precompute().
    ///
    /// Shape:   the result is [receivers.size()].
    /// Throws:  Cancelled when `progress` says so.
    [[nodiscard]] std::vector<Bits> trace(const Receivers& receivers, const Blockers& blockers,
                                          float bias, const Progress& progress) const;

    /// A point with a normal and what reaches it.
    struct Point {
        glm::vec3 normal{0.0f};
        const Bits* lit = nullptr;
    };

    /// Returns the RMS over all directions of the sphere of T - sum of weight_i T_i, where T is
    /// V max(n.w, 0) / pi, in 1/sr.
    [[nodiscard]] float difference(const Point& point, std::span<const Point> others,
                                   float weight) const;

    [[nodiscard]] std::span<const DirectionPatch> patches() const { return patches_; }

private:
    std::vector<DirectionPatch> patches_;
    /// By patch, then direction: the share of the sphere.
    std::vector<float> shares_;
};

} // namespace relumine::prt
