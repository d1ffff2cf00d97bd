// Light that reaches the receivers from sharp lights. They are traced, not looked up in clusters.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/glossy/brdf.h"
#include "prt/transfer/transfer.h"
#include "relight/kernels/block_kernels.h"
#include "relight/kernels/block_normals.h"
#include "relight/sharp/shadow_rays.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::prt {
struct SceneDifference;
} // namespace relumine::prt

namespace relumine::relight {

/// Keeps the part of each receiver's radiance that comes from sharp lights. Without blockers
/// nothing is traced and nothing is kept.
class TracedLight {
public:
    /// The transfer must outlive this object.
    ///
    /// Throws:  std::invalid_argument unless there is a position per receiver, or no blockers.
    TracedLight(const prt::Transfer& transfer, const ShadowRays& rays);

    /// Takes new lights in place of all before; parallel. Returns how many directions were traced.
    ///
    /// Where a block of receivers sees all or nothing of a light's cluster, in 16 times nine
    /// samples, it sees all or nothing of the light. Lights of a list are traced everywhere.
    ///
    /// Cost:    a shadow ray for each receiver that faces a light and sees its cluster in part.
    ///          Lights that stand where a light stood before need none, however bright they are
    ///          now.
    /// Memory:  a bit for each receiver and light.
    std::size_t trace(std::span<const SharpLight> lights);
    /// Takes what a move changed in the transfer and before the lights, which are those of the last
    /// trace(). Only rays that may meet what moved, and those of blocks in `changed`, are traced.
    ///
    /// changed: as prt::changed_blocks(); gets the blocks that lights reach otherwise than before.
    void follow(std::span<const SharpLight> lights, const prt::SceneDifference& difference,
                std::span<std::uint64_t> changed);

    /// Returns a block's radiance for albedo 1, or null where nothing is traced.
    [[nodiscard]] const TracedRadiance* diffuse(std::size_t block) const {
        return diffuse_.empty() ? nullptr : &diffuse_[block];
    }
    /// Whether lights are traced at all.
    [[nodiscard]] bool is_traced() const { return rays_.blockers != nullptr; }
    /// Returns which receivers of a block a light of the last trace() reaches: bit i for receiver
    /// i.
    [[nodiscard]] std::uint16_t reached(std::size_t light, std::size_t block) const {
        return (*of_light_[light])[block];
    }
    /// Returns a receiver's radiance through all lobes but the diffuse one, which stays 0.
    [[nodiscard]] prt::Lobes<glm::vec3> highlights(std::size_t place) const {
        return highlights_.empty() ? prt::Lobes<glm::vec3>() : highlights_[place];
    }

    /// Returns which receivers one of the present lights reaches, above their horizons or not:
    /// [num_blocks], bit i stands for the block's receiver i.
    [[nodiscard]] std::span<const std::uint16_t> reached(const SharpLight& light) const;

private:
    /// [num_blocks] bit i is set where a light reaches the block's receiver i.
    using Reached = std::vector<std::uint16_t>;
    /// A light's direction, and whether it is of a list.
    using Key = std::pair<std::array<float, 3>, bool>;
    using ReachedBlocks = std::map<Key, std::unique_ptr<Reached>>;

    /// New lights side by side in the sky, and what they reach.
    struct FreshPatch {
        prt::DirectionPatch directions;
        std::array<Reached*, prt::DirectionPatch::Size> reached{};
        /// The cluster that answers for a light in part; none for lights of a list.
        std::array<std::optional<std::uint32_t>, prt::DirectionPatch::Size> cluster{};
    };
    static Key key_of(const SharpLight& light);
    static void add(std::vector<FreshPatch>& patches, const SharpLight& light, Reached* reached);

    /// Blocks of a group, a bit each.
    using BlockBits = std::uint8_t;
    static constexpr BlockBits AllBlocks = 0xff;
    /// Receivers that are traced together.
    struct Group;

    [[nodiscard]] std::size_t num_groups() const;
    [[nodiscard]] Group group_at(std::size_t index, bool has_origins) const;
    /// Sets the bit of a direction for the receivers of some blocks that must ask it, and what
    /// others see of it.
    void choose_rays(const FreshPatch& patch, std::size_t direction, const Group& group,
                     BlockBits blocks, std::span<std::uint64_t> rays) const;
    /// `blocks`: of each direction.
    void find_reached(const FreshPatch& patch, const Group& group,
                      std::span<const BlockBits> blocks) const;
    BlockBits follow(std::span<const SharpLight> lights, std::span<const FreshPatch> patches,
                     const Group& group, const prt::SceneDifference& difference, BlockBits changed);
    void light(std::span<const SharpLight> lights, const BlockNormals& normals, std::size_t block);
    void light_block(std::span<const SharpLight> lights, const BlockNormals& normals,
                     std::size_t block);
    void light_glossy_block(std::span<const SharpLight> lights, std::size_t block);

    const prt::Transfer& transfer_;
    ShadowRays rays_;
    /// What each of the present lights reaches.
    ReachedBlocks reached_;
    /// By light.
    std::vector<const Reached*> of_light_;
    /// [num_blocks]; empty where nothing is traced.
    std::vector<TracedRadiance> diffuse_;
    /// [num_receivers] by place; empty without traced highlights.
    std::vector<prt::Lobes<glm::vec3>> highlights_;
};

} // namespace relumine::relight
