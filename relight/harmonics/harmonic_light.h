// The light that arrives at receivers from all directions, as spherical harmonics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/transfer/transfer.h"
#include "relight/harmonics/cluster_harmonics.h"
#include "relight/harmonics/harmonic_kernels.h"
#include "relight/harmonics/harmonics.h"
#include "relight/kernels/block_kernels.h"
#include "relight/sharp/cluster_sums.h"
#include "relight/sharp/traced_light.h"

namespace relumine::relight {

/// Keeps the coefficients of all receivers: for each basis function Y, the integral of L V Y over
/// the directions above the receiver's horizon; over the sphere for points without a surface.
///
/// Accuracy: as radiance. Updates add differences in double, and a block that dims much is summed
///           anew, as ReceiverLight does.
/// Memory:   26 bytes a coefficient and receiver, and 24 more under sharp lights.
class HarmonicLight {
public:
    /// The transfer must outlive this object. `order` is 1, 2 or 3.
    HarmonicLight(const prt::Transfer& transfer, std::uint32_t order);

    [[nodiscard]] std::uint32_t order() const { return lights_.order(); }
    [[nodiscard]] const ClusterHarmonics& lights() const { return lights_; }

    /// Takes the sharp lights that TracedLight traced last.
    void take_traced(std::span<const SharpLight> lights, const TracedLight& traced);
    /// Sums all clusters.
    void sum(const BlockScene& scene, const ClusterSums& sums);
    /// Updates the coefficients for the clusters in `changed`, which ascend. Returns the number of
    /// blocks that see any of them.
    std::size_t update(const BlockScene& scene, const ClusterSums& sums,
                       std::span<const std::uint32_t> changed);

    /// Returns the coefficients of a receiver by its place: [order^2].
    void read(std::size_t place, std::span<glm::vec3> light, bool with_sharp_lights = true) const;
    /// Returns the mean radiance over the sphere at a place.
    [[nodiscard]] glm::vec3 mean(std::size_t place, bool with_sharp_lights = true) const;
    /// Returns the part of mean() that comes from a cluster that counts 1.
    [[nodiscard]] glm::dvec3 mean_from_cluster(std::size_t cluster) const;

private:
    [[nodiscard]] HarmonicBlocks blocks();
    [[nodiscard]] double value(std::size_t place, std::size_t number, bool with_sharp) const;
    /// The largest first coefficient of either part of a block.
    [[nodiscard]] double brightness(std::size_t block) const;

    const prt::Transfer& transfer_;
    ClusterHarmonics lights_;
    /// The sums that HarmonicBlocks points to: [num_blocks * stride], and 16 times as many.
    std::vector<double> visible_, mixed_;
    /// [num_blocks * stride * 16] of sharp lights; empty: there are none.
    std::vector<double> traced_;
    std::vector<BlockBrightness> brightness_;
    /// Scratch.
    HarmonicChanges changes_;
    std::vector<std::uint64_t> dimmed_;
};

} // namespace relumine::relight
