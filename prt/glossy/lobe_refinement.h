// One lobe of one block of receivers, cut into cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/glossy/lobe_kernel.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// Where highlights are.
struct Mirrors {
    /// The eye's direction mirrored at each receiver's normal.
    std::array<glm::vec3, BlockSize> mirror{};
    /// The angle over which each receiver's highlight changes, radians; 0 without a highlight.
    std::array<float, BlockSize> narrowness{};
};

/// A block of receivers, with everything that its lobes share.
struct BlockToRefine {
    BlockSurfaces surfaces = {};
    /// [1..16] starts of the receivers' rays.
    std::span<const glm::vec3> origins = {};
    Mirrors of_base = {}, of_coat = {};

    /// Returns where a lobe's highlights are. Sheen has no narrow highlight.
    [[nodiscard]] Mirrors mirrors(GlossyLobe lobe) const {
        return lobe == GlossyLobe::Coat ? of_coat
               : lobe == GlossyLobe::Sheen || (lobe == GlossyLobe::DiffuseGrazing && !has_colors())
                   ? Mirrors()
                   : of_base;
    }
    /// Whether some receivers have a lobe for each colour.
    [[nodiscard]] bool has_colors() const {
        return surfaces.film_lanes != 0 ||
               surfaces.lanes[static_cast<std::size_t>(Highlight::Measured)] != 0;
    }
    /// Index of the block in the transfer.
    std::size_t block = 0;
};

/// A cell of a block's cut, and the mean of the lobe over it for each receiver, visibility
/// included.
struct CutCell {
    Cell cell;
    BlockSurfaces::Floats mean{};
};

struct LobeCut {
    /// Along the Z curve, without cells that transfer nothing.
    std::vector<CutCell> cells;
    /// Sum over receivers of the integral of the lobe's square, nothing blocked.
    double power = 0.0;
    std::uint64_t num_rays = 0;
};

struct RefinementLimits {
    /// The error that is allowed, relative to the lobe without blockers (GlossyOptions::tolerance).
    float tolerance = 0.02f;
    /// The level of single texels.
    std::uint32_t max_level = 10;
    /// The power that the tolerance is relative to; 0: the lobe's own power.
    double reference_power = 0.0;
    /// Without it: power beside the lobe, of the Lambertian part of measured surfaces.
    double added_power = 0.0;
};

/// Cuts the lobe of a block as precompute_glossy() says.
[[nodiscard]] LobeCut refine_lobe(const BlockToRefine& block, GlossyLobe lobe,
                                  const Transfer& transfer, const Blockers& blockers,
                                  const RefinementLimits& limits);

} // namespace relumine::prt
