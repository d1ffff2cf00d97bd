// Light that reaches the receivers from sharp lights, which are traced and not looked up in
// clusters.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/glossy/brdf.h"
#include "prt/transfer.h"
#include "relight/block_kernels.h"
#include "relight/light_packets.h"
#include "relight/sharp_lights.h"

namespace relumine::relight {

/// Keeps, per receiver, what the sharp lights make of its radiance. Without blockers there is
/// nothing to trace with and nothing is kept.
class TracedLight {
public:
    /// Throws std::invalid_argument unless there is a position per receiver, or no blockers. The
    /// transfer must outlive this.
    TracedLight(const prt::Transfer& transfer, const ShadowRays& rays);

    /// Traces them all anew: a shadow ray per light and receiver that faces it; parallel.
    void trace(std::span<const SharpLight> lights);

    /// Radiance for albedo 1 of a block, or null where nothing is traced.
    [[nodiscard]] const TracedRadiance* diffuse(std::size_t block) const {
        return diffuse_.empty() ? nullptr : &diffuse_[block];
    }
    /// Radiance through the lobes of a receiver but the diffuse one, which is left 0.
    [[nodiscard]] prt::Lobes<glm::vec3> highlights(std::size_t place) const {
        return highlights_.empty() ? prt::Lobes<glm::vec3>() : highlights_[place];
    }

private:
    void trace_block(const LightPackets& packets, std::size_t block);
    void trace_glossy_block(const LightPackets& packets, std::size_t block);

    const prt::Transfer& transfer_;
    ShadowRays rays_;
    /// [num_blocks], or none
    std::vector<TracedRadiance> diffuse_;
    /// [num_receivers] by place, or none
    std::vector<prt::Lobes<glm::vec3>> highlights_;
};

} // namespace relumine::relight
