// The light transfer of points in a few directions: enough to tell where it changes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/receivers/receivers.h"
#include "prt/steps.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// The texels of a cube map of 6 x 16 x 16, each with its solid angle. A patch of 8 x 8 texels is
/// traced as a beam. Where an environment is given, its brightest texels become patches of their
/// own: 64 directions each, where their light is.
class CoarseDirections {
public:
    static constexpr std::uint32_t Resolution = 16;
    static constexpr std::size_t NumEvenPatches = 24, MostBrightPatches = 8;
    /// Bits of one point: a word for each patch, a bit for each direction whose light reaches it.
    using Bits = std::array<std::uint64_t, NumEvenPatches + MostBrightPatches>;
    /// A point that fewer directions reach is hidden, in a solid or under one.
    static constexpr int FewestDirections = 16;
    [[nodiscard]] static int num_lit(const Bits& bits);
    [[nodiscard]] static bool is_hidden(const Bits& bits) {
        return num_lit(bits) < FewestDirections;
    }

    /// `light` is the environment that matters most, or null.
    explicit CoarseDirections(const cubemap::CubeMap* light = nullptr);

    /// What reaches two points on either side of a receiver; null where nothing is known.
    struct Neighbours {
        const Bits* low = nullptr;
        const Bits* high = nullptr;
    };

    /// Finds the directions whose light reaches each receiver: those above its horizon that are not
    /// blocked. Rays start as in precompute(). Where the neighbours of a receiver agree on a
    /// direction above its horizon, the receiver agrees with them, and no ray is traced.
    ///
    /// Shape:   the result is [receivers.size()]; `neighbours` too, or it is empty.
    /// Throws:  Cancelled when `progress` says so.
    [[nodiscard]] std::vector<Bits> trace(const Receivers& receivers, const Blockers& blockers,
                                          float bias, const Progress& progress,
                                          std::span<const Neighbours> neighbours = {}) const;

    /// A point with a normal and what reaches it. `weight` is its part of what stands between
    /// points, `lamps` what lamps give to it, where 1 is what they give on the mean.
    struct Point {
        glm::vec3 normal{0.0f};
        const Bits* lit = nullptr;
        float weight = 1.0f;
        float lamps = 0.0f;
    };

    /// Whether what some directions lose may make up for what others gain.
    enum class Signs { Kept, Dropped };

    /// Returns how much D = T - (w_1 T_1 + w_2 T_2 + ...) matters, where T is V max(n.w, 0) / pi
    /// and w_i the weights of the others, in 1/sr: the root of
    ///
    ///     mean of D^2                       the error under a small light, wherever it is,
    ///     + 20 (mean of D)^2                under even light from all sides,
    ///     + 4 (mean of D, by light)^2       under the environment, if there is one,
    ///     + 4 (d / (1 + l) pi)^2            under lamps,
    ///
    /// over all directions of the sphere; d is the difference of the lamps' light, l the larger of
    /// both sides. Without signs the means are those of |D|.
    [[nodiscard]] float difference(const Point& point, std::span<const Point> others,
                                   Signs signs = Signs::Kept) const;

    [[nodiscard]] std::span<const DirectionPatch> patches() const { return patches_; }

private:
    void add_light(const cubemap::CubeMap& light, std::span<const std::size_t> texels);
    bool add_bright_patch(const cubemap::CubeMap& light, std::span<const double> angles,
                          std::size_t texel, double weight);

    std::vector<DirectionPatch> patches_;
    /// By patch, then direction: the share of the sphere, and of the environment's light.
    std::vector<float> shares_, lights_;
};

} // namespace relumine::prt
