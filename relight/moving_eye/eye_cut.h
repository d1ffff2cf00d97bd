// Which cells of the sky a block of receivers is lit from through its highlight: a cut of the
// quadtree, made while the eye moves.
//
// Based on: R. Ng, R. Ramamoorthi, P. Hanrahan, "Triple Product Wavelet Integrals for All-Frequency
// Relighting", SIGGRAPH 2004: light, visibility and BRDF apart. Differs: in cells, not in wavelets,
// so that each block stops where the product needs nothing finer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/moving_eye/eye_kernel.h"
#include "relight/moving_eye/sky_cells.h"
#include "relight/moving_eye/visibility_pyramid.h"

namespace relumine::relight {

/// The lobes of a block's receivers as one.
struct BlockLobe {
    /// Means, unit length.
    glm::vec3 normal, to_eye;
    float n_v = 0.0f;
    /// Of the narrowest lobe.
    float alpha2 = 1.0f;
    /// How far the receivers' half vectors are from the mean's, seen from their normals.
    float spread = 0.0f;
    /// Factor on the lobe in radiance.
    float weight = 0.0f;
};

/// Returns the lobe of the receivers that face the eye; nothing where none has a highlight and
/// does.
///
/// Shape:   surfaces has one element per receiver of the block.
[[nodiscard]] std::optional<BlockLobe> lobe_of(const prt::BlockSurfaces& block,
                                               std::span<const prt::Surface> surfaces);

/// Finds cuts. For one thread.
class EyeCut {
public:
    /// Both must outlive this object. A cell stays whole where its share of a block's radiance is
    /// off by no more than `error`.
    EyeCut(const VisibilityPyramid& visibility, const SkyCells& sky, float error)
        : visibility_(visibility), sky_(sky), error_(error) {}

    /// Appends the cells that light a block through a lobe.
    void find(std::size_t block, const BlockLobe& lobe, std::vector<LitCell>& cells);

private:
    using Sight = VisibilityPyramid::Sight;
    /// A cell that is yet to be looked at. Below the clusters it has the cluster's node.
    struct Pending {
        std::uint32_t node, place, level;
    };

    [[nodiscard]] bool is_fine(const SkyCell& cell, const BlockLobe& lobe, bool may_differ) const;
    void add(const Pending& at, Sight sight, std::size_t block, std::vector<LitCell>& cells) const;

    const VisibilityPyramid& visibility_;
    const SkyCells& sky_;
    float error_;
    std::vector<Pending> pending_;
};

} // namespace relumine::relight
