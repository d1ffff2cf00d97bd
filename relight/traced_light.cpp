#include "relight/traced_light.h"

#include <algorithm>
#include <stdexcept>

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

void TracedLight::trace(std::span<const SharpLight> lights) {
    const LightPackets packets(lights);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, diffuse_.size(), BlocksPerTask),
                      [&](const auto& blocks) {
                          for (std::size_t block = blocks.begin(); block < blocks.end(); ++block)
                              if (transfer_.glossy)
                                  trace_glossy_block(packets, block);
                              else
                                  trace_block(packets, block);
                      });
}

void TracedLight::trace_block(const LightPackets& packets, std::size_t block) {
    const std::size_t begin = block * prt::BlockSize;
    const std::size_t end = std::min(begin + prt::BlockSize, transfer_.num_receivers());
    for (std::size_t place = begin; place < end; ++place)
        set(diffuse_[block], place - begin,
            packets.radiance(rays_.positions[transfer_.order[place]], transfer_.normals[place],
                             rays_));
}

void TracedLight::trace_glossy_block(const LightPackets& packets, std::size_t block) {
    const std::size_t begin = block * prt::BlockSize;
    const std::size_t size = std::min(prt::BlockSize, transfer_.num_receivers() - begin);
    prt::BlockSurfaces surfaces;
    std::array<glm::vec3, prt::BlockSize> positions;
    for (std::size_t i = 0; i < size; ++i) {
        positions[i] = rays_.positions[transfer_.order[begin + i]];
        surfaces.set(i, transfer_.surfaces[begin + i], transfer_.normals[begin + i],
                     transfer_.glossy->to_eye[begin + i]);
    }
    std::array<prt::Lobes<glm::dvec3>, prt::BlockSize> lobes;
    packets.light_block(surfaces, std::span(positions).first(size),
                        std::span(transfer_.normals).subspan(begin, size), rays_,
                        std::span(lobes).first(size));
    for (std::size_t i = 0; i < size; ++i) {
        set(diffuse_[block], i, lobes[i].diffuse);
        highlights_[begin + i] = {.diffuse_grazing = glm::vec3(lobes[i].diffuse_grazing),
                                  .specular = glm::vec3(lobes[i].specular),
                                  .specular_grazing = glm::vec3(lobes[i].specular_grazing)};
    }
}

} // namespace relumine::relight
