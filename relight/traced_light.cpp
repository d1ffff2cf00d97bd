#include "relight/traced_light.h"

#include <algorithm>
#include <bit>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace relumine::relight {

namespace {

/// Blocks of one task: about 50 microseconds of work, well above the cost of starting a task.
constexpr std::size_t BlocksPerTask = 4;

void set(TracedRadiance& radiance, std::size_t receiver, const glm::dvec3& value) {
    for (int channel = 0; channel < 3; ++channel)
        radiance.channels[static_cast<std::size_t>(channel)][receiver] = value[channel];
}

/// Calls visit(receiver) for the set bits.
template<class Visit>
void for_receivers(std::uint32_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1)
        visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

} // namespace

TracedLight::TracedLight(const prt::Transfer& transfer, const ShadowRays& rays)
    : transfer_(transfer), rays_(rays) {
    if (rays.blockers == nullptr)
        return;
    if (rays.positions.size() != transfer.num_receivers())
        throw std::invalid_argument("expected one position per receiver");
    diffuse_.resize(transfer.counts.num_blocks());
    if (transfer.glossy)
        highlights_.resize(transfer.num_receivers());
}

std::size_t TracedLight::trace(std::span<const SharpLight> lights) {
    if (rays_.blockers == nullptr)
        return 0;
    // What a ray meets depends on its direction in float alone.
    ReachedBlocks reached;
    std::vector<SharpLight> fresh;
    std::vector<Reached*> of_fresh, of_light;
    for (const SharpLight& light : lights) {
        const glm::vec3 direction(light.direction);
        const auto [place, is_new] =
            reached.try_emplace({direction.x, direction.y, direction.z}, nullptr);
        if (is_new) {
            if (const auto before = reached_.find(place->first); before != reached_.end()) {
                place->second = std::move(before->second);
            } else {
                place->second = std::make_unique<Reached>(diffuse_.size());
                fresh.push_back(light);
                of_fresh.push_back(place->second.get());
            }
        }
        of_light.push_back(place->second.get());
    }
    reached_ = std::move(reached);

    const LightPackets packets(fresh);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, diffuse_.size(), BlocksPerTask),
                      [&](const auto& blocks) {
                          for (std::size_t block = blocks.begin(); block < blocks.end(); ++block) {
                              find_reached(packets, block, of_fresh);
                              if (transfer_.glossy)
                                  light_glossy_block(lights, of_light, block);
                              else
                                  light_block(lights, of_light, block);
                          }
                      });
    return fresh.size();
}

/// Traces the fresh lights' rays from a block.
void TracedLight::find_reached(const LightPackets& packets, std::size_t block,
                               std::span<Reached* const> of_fresh) const {
    const std::size_t begin = block * prt::BlockSize;
    const std::size_t size = std::min(prt::BlockSize, transfer_.num_receivers() - begin);
    for (std::size_t i = 0; i < size; ++i) {
        const glm::vec3& position = rays_.positions[transfer_.order[begin + i]];
        for (std::size_t p = 0; p < packets.num_packets(); ++p)
            for_receivers(packets.visible(p, position, transfer_.normals[begin + i], rays_),
                          [&](std::size_t lane) {
                              (*of_fresh[p * prt::PacketSize + lane])[block] |=
                                  static_cast<std::uint16_t>(1u << i);
                          });
    }
}

void TracedLight::light_block(std::span<const SharpLight> lights,
                              std::span<Reached* const> of_light, std::size_t block) {
    const std::size_t begin = block * prt::BlockSize;
    std::array<glm::dvec3, prt::BlockSize> irradiance{};
    for (std::size_t light = 0; light < lights.size(); ++light)
        for_receivers((*of_light[light])[block], [&](std::size_t i) {
            irradiance[i] += lights[light].irradiance.on(transfer_.normals[begin + i]);
        });
    for (std::size_t i = 0; i < irradiance.size(); ++i)
        set(diffuse_[block], i, irradiance[i] / std::numbers::pi);
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
        set(diffuse_[block], i, lobes[i].diffuse);
        highlights_[begin + i] = {.diffuse_grazing = glm::vec3(lobes[i].diffuse_grazing),
                                  .specular = glm::vec3(lobes[i].specular),
                                  .specular_grazing = glm::vec3(lobes[i].specular_grazing)};
    }
}

} // namespace relumine::relight
