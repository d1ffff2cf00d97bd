#include "relight/sharp/traced_light.h"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

#include "files/large_vector.h"
#include "files/parallel.h"
#include "prt/moves/met_boxes.h"
#include "prt/moves/scene_change.h"
#include "relight/sharp/light_packets.h"
#include "relight/sharp/traced_kernel.h"

namespace relumine::relight {

TracedLight::TracedLight(const prt::Transfer& transfer, const ShadowRays& rays)
    : transfer_(transfer), rays_(rays) {
    if (rays.blockers == nullptr)
        return;
    if (rays.positions.size() != transfer.num_receivers())
        throw std::invalid_argument("expected one position per receiver");
    diffuse_ = files::large_vector<TracedRadiance>(transfer.counts.num_blocks());
    if (transfer.glossy)
        highlights_.resize(transfer.num_receivers());
}

struct TracedLight::Group {
    static constexpr std::size_t MaxBlocks = prt::ReceiverGroup::MaxSize / prt::BlockSize;
    /// Its first place, and its receivers
    std::size_t first = 0, size = 0;
    std::vector<BlockNormals> normals;
    /// Where rays begin, unless there are none
    std::array<glm::vec3, prt::ReceiverGroup::MaxSize> origins;
    glm::vec3 mean_normal{0.0f};

    [[nodiscard]] std::size_t first_block() const { return first / prt::BlockSize; }
    [[nodiscard]] prt::ReceiverGroup receivers() const {
        return {std::span(origins).first(size), mean_normal};
    }
};

std::size_t TracedLight::num_groups() const {
    return (diffuse_.size() + Group::MaxBlocks - 1) / Group::MaxBlocks;
}

TracedLight::Group TracedLight::group_at(std::size_t index, bool has_origins) const {
    Group group;
    group.first = index * prt::ReceiverGroup::MaxSize;
    group.size = std::min(prt::ReceiverGroup::MaxSize, transfer_.num_receivers() - group.first);
    group.normals = block_normals(std::span(transfer_.normals).subspan(group.first, group.size));
    for (std::size_t i = 0; i < group.size && has_origins; ++i) {
        const glm::vec3& normal = transfer_.normals[group.first + i];
        group.origins[i] =
            prt::ray_origin(rays_.positions[transfer_.order[group.first + i]], normal, rays_.bias);
        group.mean_normal += normal;
    }
    return group;
}

std::size_t TracedLight::trace(std::span<const SharpLight> lights) {
    if (rays_.blockers == nullptr)
        return 0;
    // What a light reaches depends on its direction in float, and on whether clusters answer for
    // it.
    ReachedBlocks reached;
    std::vector<FreshPatch> fresh;
    std::size_t num_fresh = 0;
    of_light_.clear();
    for (const SharpLight& light : lights) {
        const auto [place, is_new] = reached.try_emplace(key_of(light), nullptr);
        if (is_new) {
            if (const auto before = reached_.find(place->first); before != reached_.end()) {
                place->second = std::move(before->second);
            } else {
                place->second = std::make_unique<Reached>(diffuse_.size());
                add(fresh, light, place->second.get());
                ++num_fresh;
            }
        }
        of_light_.push_back(place->second.get());
    }
    reached_ = std::move(reached);
    rays_.blockers->prepare(std::uint64_t{num_fresh} * transfer_.num_receivers());

    constexpr auto All = [] {
        std::array<BlockBits, prt::DirectionPatch::Size> all{};
        all.fill(AllBlocks);
        return all;
    }();
    files::parallel_for(std::size_t{0}, num_groups(), [&](std::size_t index) {
        const Group group = group_at(index, !fresh.empty());
        for (const FreshPatch& patch : fresh)
            find_reached(patch, group, All);
        for (std::size_t i = 0; i < group.normals.size(); ++i)
            light(lights, group.normals[i], group.first_block() + i);
    });
    return num_fresh;
}

void TracedLight::follow(std::span<const SharpLight> lights, const prt::SceneDifference& difference,
                         std::span<std::uint64_t> changed) {
    if (rays_.blockers == nullptr)
        return;
    std::vector<FreshPatch> patches;
    std::vector<const Reached*> taken;
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (std::find(taken.begin(), taken.end(), of_light_[i]) == taken.end()) {
            taken.push_back(of_light_[i]);
            add(patches, lights[i], reached_.at(key_of(lights[i])).get());
        }
    // A tile has whole groups, so each word has one writer.
    constexpr std::size_t GroupsPerTile = prt::VisibleCounts::TileBlocks / Group::MaxBlocks;
    files::parallel_for(std::size_t{0}, changed.size(), [&](std::size_t tile) {
        const std::size_t end = std::min((tile + 1) * GroupsPerTile, num_groups());
        for (std::size_t index = tile * GroupsPerTile; index < end; ++index)
            changed[tile] |=
                std::uint64_t{follow(lights, patches, group_at(index, true), difference,
                                     static_cast<BlockBits>(changed[tile] >> index % GroupsPerTile *
                                                                                 Group::MaxBlocks))}
                << index % GroupsPerTile * Group::MaxBlocks;
    });
}

/// Returns the blocks of a group that lights reach otherwise than before, and those in `changed`.
TracedLight::BlockBits TracedLight::follow(std::span<const SharpLight> lights,
                                           std::span<const FreshPatch> patches, const Group& group,
                                           const prt::SceneDifference& difference,
                                           BlockBits changed) {
    std::vector<prt::MetBoxes> boxes;
    for (std::size_t i = 0; i < group.normals.size(); ++i) {
        mesh::Bounds places = prt::no_box();
        const std::size_t begin = i * prt::BlockSize;
        for (std::size_t k = begin; k < std::min(begin + prt::BlockSize, group.size); ++k)
            prt::include(places, group.origins[k]);
        boxes.emplace_back(difference.boxes, places);
    }
    for (const FreshPatch& patch : patches) {
        std::array<BlockBits, prt::DirectionPatch::Size> asked{};
        std::array<std::array<std::uint16_t, Group::MaxBlocks>, prt::DirectionPatch::Size> before{};
        const auto for_asked = [&](const auto& visit) {
            for (std::size_t j = 0; j < patch.directions.num_directions; ++j)
                for (std::size_t i = 0; i < group.normals.size(); ++i)
                    if ((asked[j] >> i & 1u) != 0)
                        visit(j, i, (*patch.reached[j])[group.first_block() + i]);
        };
        for (std::size_t j = 0; j < patch.directions.num_directions; ++j) {
            asked[j] = changed;
            const glm::vec3 inverse = prt::inverse(patch.directions.direction(j));
            for (std::size_t i = 0; i < boxes.size(); ++i)
                if (boxes[i].meets(inverse))
                    asked[j] |= static_cast<BlockBits>(1u << i);
        }
        for_asked([&](std::size_t j, std::size_t i, std::uint16_t& reached) {
            before[j][i] = std::exchange(reached, std::uint16_t{0});
        });
        find_reached(patch, group, asked);
        for_asked([&](std::size_t j, std::size_t i, const std::uint16_t& reached) {
            if (reached != before[j][i])
                changed |= static_cast<BlockBits>(1u << i);
        });
    }
    for (std::size_t i = 0; i < group.normals.size(); ++i)
        if ((changed >> i & 1u) != 0)
            light(lights, group.normals[i], group.first_block() + i);
    return changed;
}

void TracedLight::light(std::span<const SharpLight> lights, const BlockNormals& normals,
                        std::size_t block) {
    if (transfer_.glossy)
        light_glossy_block(lights, block);
    else
        light_block(lights, normals, block);
}

std::span<const std::uint16_t> TracedLight::reached(const SharpLight& light) const {
    return *reached_.at(key_of(light));
}

TracedLight::Key TracedLight::key_of(const SharpLight& light) {
    const glm::vec3 direction(light.direction);
    return {{direction.x, direction.y, direction.z}, light.is_of_list};
}

/// Lights of neighbouring clusters follow each other.
void TracedLight::add(std::vector<FreshPatch>& patches, const SharpLight& light, Reached* reached) {
    if (patches.empty() || !fits(patches.back().directions, light))
        patches.emplace_back();
    FreshPatch& patch = patches.back();
    patch.reached[patch.directions.num_directions] = reached;
    if (!light.is_of_list)
        patch.cluster[patch.directions.num_directions] = light.cluster;
    patch.directions.add(glm::vec3(light.direction));
}

void TracedLight::choose_rays(const FreshPatch& patch, std::size_t direction, const Group& group,
                              BlockBits blocks, std::span<std::uint64_t> rays) const {
    const prt::VisibleCounts& counts = transfer_.counts;
    const glm::vec3 towards = patch.directions.direction(direction);
    const std::optional<std::uint32_t> cluster = patch.cluster[direction];
    for (std::size_t begin = 0; begin < rays.size(); begin += prt::BlockSize) {
        if ((blocks >> begin / prt::BlockSize & 1u) == 0)
            continue;
        const std::size_t block = (group.first + begin) / prt::BlockSize;
        bool is_mixed = true;
        if (cluster) {
            const std::size_t word = counts.word(block, *cluster / 64);
            const std::uint64_t bit = std::uint64_t{1} << *cluster % 64;
            is_mixed = (counts.mixed[word] & bit) != 0;
            if (!is_mixed && (counts.visible[word] & bit) == 0)
                continue;
        }
        const std::size_t size = std::min(prt::BlockSize, rays.size() - begin);
        const std::size_t num_points = std::min(
            size, transfer_.num_points - std::min(transfer_.num_points, group.first + begin));
        const std::uint32_t above =
            lanes_above(group.normals[begin / prt::BlockSize], towards) | ((1u << num_points) - 1);
        if (!is_mixed)
            (*patch.reached[direction])[block] = static_cast<std::uint16_t>(above);
        for (std::size_t i = 0; is_mixed && i < size; ++i)
            rays[begin + i] |= std::uint64_t{above >> i & 1u} << direction;
    }
}

/// Traces the rays of neighbouring receivers through a patch.
void TracedLight::find_reached(const FreshPatch& patch, const Group& group,
                               std::span<const BlockBits> blocks) const {
    std::array<std::uint64_t, prt::ReceiverGroup::MaxSize> rays{}; // a bit per direction
    const std::span<std::uint64_t> of_group(rays.data(), group.size);
    const std::size_t num_directions = patch.directions.num_directions;
    std::uint64_t any = 0;
    for (std::size_t j = 0; j < num_directions; ++j)
        choose_rays(patch, j, group, blocks[j], of_group);
    for (const std::uint64_t bits : of_group)
        any |= bits;
    if (any == 0)
        return;
    rays_.blockers->clear_blocked(group.receivers(), patch.directions, of_group);
    for (std::size_t i = 0; i < of_group.size(); ++i) {
        const std::size_t place = group.first + i;
        for (std::uint64_t bits = of_group[i]; bits != 0; bits &= bits - 1)
            (*patch.reached[static_cast<std::size_t>(std::countr_zero(bits))])[place /
                                                                               prt::BlockSize] |=
                static_cast<std::uint16_t>(1u << place % prt::BlockSize);
    }
}

void TracedLight::light_block(std::span<const SharpLight> lights, const BlockNormals& normals,
                              std::size_t block) {
    std::vector<ReachingLight> reaching;
    reaching.reserve(lights.size());
    for (std::size_t light = 0; light < lights.size(); ++light)
        if (const std::uint16_t reached = this->reached(light, block); reached != 0)
            reaching.push_back({&lights[light].irradiance, reached});
    diffuse_[block] = traced_radiance(normals, reaching);
}

void TracedLight::light_glossy_block(std::span<const SharpLight> lights, std::size_t block) {
    const std::size_t begin = block * prt::BlockSize;
    const std::size_t size = std::min(prt::BlockSize, transfer_.num_receivers() - begin);
    prt::BlockSurfaces surfaces;
    for (std::size_t i = 0; i < size; ++i)
        surfaces.set(i, transfer_.surfaces[begin + i], transfer_.normals[begin + i],
                     transfer_.glossy->to_eye[begin + i]);
    const std::span<const glm::vec3> normals = std::span(transfer_.normals).subspan(begin, size);
    std::array<prt::Lobes<glm::dvec3>, prt::BlockSize> lobes;
    for (std::size_t light = 0; light < lights.size(); ++light)
        add_light(surfaces, normals, glm::vec3(lights[light].direction), lights[light].irradiance,
                  reached(light, block), std::span(lobes).first(size));
    for (std::size_t i = 0; i < size; ++i) {
        for (int channel = 0; channel < 3; ++channel)
            diffuse_[block].channels[static_cast<std::size_t>(channel)][i] =
                lobes[i].diffuse[channel];
        highlights_[begin + i] = prt::converted<glm::vec3>(lobes[i]);
        highlights_[begin + i].diffuse = glm::vec3(0.0f);
    }
}

} // namespace relumine::relight
