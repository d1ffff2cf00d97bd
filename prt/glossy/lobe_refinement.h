// One lobe of one block of receivers, cut into cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/glossy/lobe_kernel.h"
#include "prt/transfer.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// A block of receivers, all that its lobes share.
struct BlockToRefine {
    BlockSurfaces surfaces = {};
    std::span<const glm::vec3> origins = {};   ///< [1..16] where the receivers' rays start
    std::array<glm::vec3, BlockSize> mirror{}; ///< the eye's direction mirrored at each receiver's normal
    std::array<float, BlockSize>
        narrowness{}; ///< angle over which each receiver's highlight changes, radians; 0 where it has none
    std::size_t block = 0; ///< of the transfer
};

/// A cell of a block's cut and the lobe's mean over it, visibility included, for each receiver.
struct CutCell {
    Cell cell;
    BlockSurfaces::Floats mean{};
};

struct LobeCut {
    std::vector<CutCell> cells; ///< along the Z curve; without those that transfer nothing
    double power = 0.0;         ///< sum over receivers of the integral of the lobe's square, nothing blocked
    std::uint64_t num_rays = 0;
};

struct RefinementLimits {
    float tolerance = 0.02f;      ///< GlossyOptions::tolerance
    std::uint32_t max_level = 10; ///< of a single texel
    double reference_power = 0.0; ///< what the tolerance is a part of; 0: the lobe's own power
};

/// Cuts the lobe of a block as precompute_glossy() says.
[[nodiscard]] LobeCut refine_lobe(const BlockToRefine& block, GlossyLobe lobe, const Transfer& transfer,
                                  const Blockers& blockers, const RefinementLimits& limits);

} // namespace relumine::prt
