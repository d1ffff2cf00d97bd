// The inner loop of highlights for an eye that moves: light of cells times visible part times lobe,
// 16 receivers at a time. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "prt/glossy/lobe_kernel.h"
#include "relight/kernels/block_kernels.h"

namespace relumine::relight {

/// A cell of a block's cut, or a light that is traced.
struct LitCell {
    /// Unit length.
    glm::vec3 direction;
    /// Is added to the lobe's alpha^2: as much as the light is spread.
    float widening = 0.0f;
    /// Radiance times sr of visible part 1.
    glm::vec3 light;
    /// What each receiver sees.
    std::array<std::uint8_t, prt::BlockSize> parts;
};

/// Light through the lobes S and Sc (prt/glossy/brdf.h) of a block of receivers.
struct EyeLight {
    BlockRadiance all, grazing;
};

/// Sums cells through the GGX lobes of a block, whose receivers have no other highlights.
///
/// Accuracy: 1e-3 of the peak for the narrowest lobe, 1e-5 from roughness 0.3 on.
void sum_cells(const prt::BlockSurfaces& surfaces, std::span<const LitCell> cells, EyeLight& light);

} // namespace relumine::relight
