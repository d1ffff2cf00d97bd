// The inner loop of highlights for an eye that moves: light of cells times visible part times lobe,
// 16 receivers at a time. Vectorised with run-time dispatch.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prt/glossy/lobe_kernel.h"
#include "relight/kernels/block_kernels.h"
#include "relight/moving_eye/sky_cells.h"

namespace relumine::relight {

/// One of four lights, by its first row (SisterCells). It outlives a look.
using CellLight = const float*;

/// A light that receivers see in part.
struct PartlyCell {
    CellLight light = nullptr;
    /// The unit of `parts`; negative for light that goes away.
    float unit = 0.0f;
    /// What each receiver sees.
    std::array<std::uint8_t, prt::BlockSize> parts{};
};

/// The cells of a block's cut, and lights that are traced.
struct LitCells {
    /// Those that all receivers see, for all that the cut knows.
    std::vector<CellLight> open;
    std::vector<PartlyCell> partly;

    void clear() {
        open.clear();
        partly.clear();
    }
    [[nodiscard]] std::size_t size() const { return open.size() + partly.size(); }
};

/// Light through the lobes S and Sc (prt/glossy/brdf.h) of a block of receivers.
struct EyeLight {
    BlockRadiance all, grazing;
};

/// Sums cells through the GGX lobes of a block, whose receivers have no other highlights.
///
/// Accuracy: 1e-3 of the peak for the narrowest lobe, 1e-5 from roughness 0.3 on.
void sum_cells(const prt::BlockSurfaces& surfaces, const LitCells& cells, EyeLight& light);

} // namespace relumine::relight
