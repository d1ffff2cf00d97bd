// The light of receivers under the light of clusters, traced lights and the cells of highlights.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/transfer/transfer.h"
#include "relight/harmonics/harmonic_light.h"
#include "relight/kernels/block_kernels.h"
#include "relight/kernels/block_normals.h"
#include "relight/kernels/cluster_lights.h"
#include "relight/kernels/glossy_kernels.h"
#include "relight/kernels/kernel_lights.h"
#include "relight/kernels/tile_words.h"
#include "relight/light_pyramid.h"
#include "relight/sharp/cluster_sums.h"
#include "relight/sharp/shadow_rays.h"
#include "relight/sharp/sharp_lights.h"
#include "relight/sharp/traced_light.h"

namespace relumine::prt {
struct SceneChange;
} // namespace relumine::prt

namespace relumine::relight {

/// Keeps the radiance of a Relighter's receivers, and what it is summed from.
class ReceiverLight {
public:
    /// Arguments and errors as Relighter.
    ReceiverLight(const prt::Transfer& transfer, const ShadowRays& rays, std::uint32_t harmonics);

    /// Traces these lights in place of all before (TracedLight::trace()). sum() or update() put the
    /// result into the radiance.
    std::size_t trace(std::span<const SharpLight> lights);
    /// The light of highlights; null where there are none.
    [[nodiscard]] LightPyramid* pyramid() { return pyramid_ ? &*pyramid_ : nullptr; }

    /// Sums all clusters [JN, Eq. 8].
    void sum(const ClusterSums& sums);
    /// Takes what a move changed in the transfer and before the sharp lights, which are those of
    /// the last trace(). The radiance is then that of sum() with these.
    void follow(const ClusterSums& sums, const prt::SceneChange& change);
    /// Updates the radiance for the clusters in `changed`, which ascend and whose sums are new.
    /// Returns the number of receivers that see any of them.
    std::size_t update(const ClusterSums& sums, std::span<const std::uint32_t> changed,
                       bool sharp_changed);

    // The light of all receivers, which Relighter documents.
    [[nodiscard]] std::span<const glm::vec3> radiance() const { return radiance_; }
    [[nodiscard]] std::span<const glm::vec3> diffuse_radiance() const {
        return diffuse_.empty() ? radiance_ : diffuse_;
    }
    /// Returns the radiance without what the sharp lights give, for pictures that trace them
    /// themselves. Black under Relighter::set_lights() with shadow rays.
    ///
    /// Shape:   [num_receivers], as radiance().
    /// Cost:    O(receivers).
    [[nodiscard]] std::vector<glm::vec3> soft_radiance() const;
    /// Returns the light of receivers with surfaces through each lobe, without colours, all of it
    /// or without what the sharp lights give: reflect() makes radiance() or soft_radiance() of it.
    ///
    /// Shape:   [num_receivers], as radiance().
    [[nodiscard]] std::vector<prt::Lobes<glm::vec3>> lobes(bool with_sharp_lights) const;
    /// Returns what a point in space has from one cluster of which it counts 1, without its sharp
    /// lights.
    [[nodiscard]] glm::dvec3 mean_from_cluster(std::size_t cluster) const;
    /// Returns the arriving light as it was summed, not bound, all of it or without what the sharp
    /// lights give.
    ///
    /// Shape:   [num_receivers][order^2], in the receivers' own order.
    [[nodiscard]] std::vector<glm::vec3> harmonics(bool with_sharp_lights) const;
    /// 0: none are kept. Points have at least 1.
    [[nodiscard]] std::uint32_t harmonic_order() const {
        return harmonics_ ? harmonics_->order() : 0;
    }

    // What the radiance is summed from.
    [[nodiscard]] BlockScene block_scene() const {
        return {.counts = transfer_.counts, .words = words_, .normals = normals_};
    }
    /// Sharp lights left out.
    [[nodiscard]] const ClusterLights& cluster_lights() const { return lights_; }
    /// Null: no harmonics are kept.
    [[nodiscard]] const HarmonicLight* harmonic_light() const {
        return harmonics_ ? &*harmonics_ : nullptr;
    }
    [[nodiscard]] const TracedLight& traced() const { return traced_; }

private:
    /// Sums all clusters of some blocks, a bit each in the word of their tile.
    void light_blocks(std::span<const std::uint64_t> blocks);
    void light_glossy(std::size_t block);
    [[nodiscard]] bool has_surfaces() const { return transfer_.num_points < radiance_.size(); }
    /// The radiance of points without a surface.
    void write_points();
    void write_means(bool with_sharp_lights, std::span<glm::vec3> radiance) const;
    /// Returns the block's brightness.
    double write_radiance(std::size_t block);
    /// Writes the block's radiance, and that for albedo 1 into `diffuse` unless that is empty.
    /// Returns its brightness.
    double write_radiance(std::size_t block, bool with_sharp_lights, std::span<glm::vec3> radiance,
                          std::span<glm::vec3> diffuse) const;
    [[nodiscard]] prt::Lobes<glm::vec3> lobes_at(std::size_t place, const glm::vec3& diffuse,
                                                 bool with_sharp_lights) const;

    const prt::Transfer& transfer_;
    TracedLight traced_;
    /// Set where the transfer has a glossy part.
    std::optional<LightPyramid> pyramid_;
    /// Set where they are asked for, and for points without a surface.
    std::optional<HarmonicLight> harmonics_;
    /// [num_blocks]; empty without a glossy part.
    std::vector<GlossyLight> glossy_;
    /// [num_receivers] cosines between normal and eye; empty without a glossy part.
    std::vector<prt::EyeCosines> eye_cosines_;
    /// [num_blocks]
    std::vector<BlockNormals> normals_;
    /// From tile_words().
    TileWords words_;
    /// [num_blocks]
    std::vector<BlockLight> light_;
    ClusterLights lights_;
    std::vector<glm::vec3> radiance_;
    /// For albedo 1; empty without surfaces.
    std::vector<glm::vec3> diffuse_;
    /// Scratch: how clusters change.
    LightChanges changes_;
    /// Whether there were updates since the last sum of all.
    bool is_updated_ = false;
    /// Scratch, [num_tiles]: blocks that are summed anew after a change.
    std::vector<std::uint64_t> dimmed_;
};

} // namespace relumine::relight
