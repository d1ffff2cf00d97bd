#include "relight/sharp/traced_light.h"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

#include "files/large_vector.h"
#include "files/parallel.h"
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

std::size_t TracedLight::trace(std::span<const SharpLight> lights) {
    if (rays_.blockers == nullptr)
        return 0;
    // What a light reaches depends on its direction in float, and on whether clusters answer for
    // it.
    ReachedBlocks reached;
    std::vector<FreshPatch> fresh;
    std::size_t num_fresh = 0;
    std::vector<Reached*> of_light;
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
        of_light.push_back(place->second.get());
    }
    reached_ = std::move(reached);
    of_light_.assign(of_light.begin(), of_light.end());
    rays_.blockers->prepare(std::uint64_t{num_fresh} * transfer_.num_receivers());

    constexpr std::size_t BlocksPerGroup = prt::ReceiverGroup::MaxSize / prt::BlockSize;
    const std::size_t num_groups = (diffuse_.size() + BlocksPerGroup - 1) / BlocksPerGroup;
    files::parallel_for(std::size_t{0}, num_groups, [&](std::size_t index) {
        const std::size_t first = index * prt::ReceiverGroup::MaxSize;
        const std::size_t size =
            std::min(prt::ReceiverGroup::MaxSize, transfer_.num_receivers() - first);
        std::array<glm::vec3, prt::ReceiverGroup::MaxSize> origins;
        glm::vec3 mean_normal(0.0f);
        const std::vector<BlockNormals> normals =
            block_normals(std::span(transfer_.normals).subspan(first, size));
        for (std::size_t i = 0; i < size && !fresh.empty(); ++i) {
            const glm::vec3& normal = transfer_.normals[first + i];
            origins[i] =
                prt::ray_origin(rays_.positions[transfer_.order[first + i]], normal, rays_.bias);
            mean_normal += normal;
        }
        for (const FreshPatch& patch : fresh)
            find_reached(patch, first, {std::span(origins).first(size), mean_normal}, normals);
        for (std::size_t i = 0; i < normals.size(); ++i) {
            const std::size_t block = index * BlocksPerGroup + i;
            if (transfer_.glossy)
                light_glossy_block(lights, of_light, block);
            else
                light_block(lights, of_light, normals[i], block);
        }
    });
    return num_fresh;
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

void TracedLight::choose_rays(const FreshPatch& patch, std::size_t direction, std::size_t first,
                              std::span<const BlockNormals> normals,
                              std::span<std::uint64_t> rays) const {
    const prt::VisibleCounts& counts = transfer_.counts;
    const glm::vec3 towards = patch.directions.direction(direction);
    const std::optional<std::uint32_t> cluster = patch.cluster[direction];
    for (std::size_t begin = 0; begin < rays.size(); begin += prt::BlockSize) {
        const std::size_t block = (first + begin) / prt::BlockSize;
        bool is_mixed = true;
        if (cluster) {
            const std::size_t word = counts.word(block, *cluster / 64);
            const std::uint64_t bit = std::uint64_t{1} << *cluster % 64;
            is_mixed = (counts.mixed[word] & bit) != 0;
            if (!is_mixed && (counts.visible[word] & bit) == 0)
                continue;
        }
        const std::size_t size = std::min(prt::BlockSize, rays.size() - begin);
        const std::size_t num_points =
            std::min(size, transfer_.num_points - std::min(transfer_.num_points, first + begin));
        const std::uint32_t above =
            lanes_above(normals[begin / prt::BlockSize], towards) | ((1u << num_points) - 1);
        if (!is_mixed)
            (*patch.reached[direction])[block] = static_cast<std::uint16_t>(above);
        for (std::size_t i = 0; is_mixed && i < size; ++i)
            rays[begin + i] |= std::uint64_t{above >> i & 1u} << direction;
    }
}

/// Traces the rays of neighbouring receivers, the first one at place `first`, through a patch.
void TracedLight::find_reached(const FreshPatch& patch, std::size_t first,
                               const prt::ReceiverGroup& group,
                               std::span<const BlockNormals> normals) const {
    std::array<std::uint64_t, prt::ReceiverGroup::MaxSize> rays{}; // a bit per direction
    const std::span<std::uint64_t> of_group(rays.data(), group.origins.size());
    const std::size_t num_directions = patch.directions.num_directions;
    std::uint64_t any = 0;
    for (std::size_t j = 0; j < num_directions; ++j)
        choose_rays(patch, j, first, normals, of_group);
    for (const std::uint64_t bits : of_group)
        any |= bits;
    if (any == 0)
        return;
    rays_.blockers->clear_blocked(group, patch.directions, of_group);
    for (std::size_t i = 0; i < of_group.size(); ++i) {
        const std::size_t place = first + i;
        for (std::uint64_t bits = of_group[i]; bits != 0; bits &= bits - 1)
            (*patch.reached[static_cast<std::size_t>(std::countr_zero(bits))])[place /
                                                                               prt::BlockSize] |=
                static_cast<std::uint16_t>(1u << place % prt::BlockSize);
    }
}

void TracedLight::light_block(std::span<const SharpLight> lights,
                              std::span<Reached* const> of_light, const BlockNormals& normals,
                              std::size_t block) {
    std::vector<ReachingLight> reaching;
    reaching.reserve(lights.size());
    for (std::size_t light = 0; light < lights.size(); ++light)
        if (const std::uint16_t reached = (*of_light[light])[block]; reached != 0)
            reaching.push_back({&lights[light].irradiance, reached});
    diffuse_[block] = traced_radiance(normals, reaching);
}

void TracedLight::light_glossy_block(std::span<const SharpLight> lights,
                                     std::span<Reached* const> of_light, std::size_t block) {
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
                  (*of_light[light])[block], std::span(lobes).first(size));
    for (std::size_t i = 0; i < size; ++i) {
        for (int channel = 0; channel < 3; ++channel)
            diffuse_[block].channels[static_cast<std::size_t>(channel)][i] =
                lobes[i].diffuse[channel];
        highlights_[begin + i] = prt::converted<glm::vec3>(lobes[i]);
        highlights_[begin + i].diffuse = glm::vec3(0.0f);
    }
}

} // namespace relumine::relight
