#include "relight/sharp/light_packets.h"

#include <algorithm>
#include <bit>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "files/parallel.h"

namespace relumine::relight {

namespace {

/// Receivers of one task: with a handful of lights about 50 microseconds of work.
constexpr std::size_t ReceiversPerPart = 64;

} // namespace

bool fits(const prt::DirectionPatch& patch, const SharpLight& light) {
    constexpr float CosineOfPatch = 0.9903f;
    return !patch.full() &&
           glm::dot(patch.direction(0), glm::vec3(light.direction)) >= CosineOfPatch;
}

LightPackets::LightPackets(std::span<const SharpLight> lights) {
    for (const SharpLight& light : lights)
        add(light.direction, light.irradiance);
}

LightPackets::LightPackets(std::span<const lights::DistantLight> lights) {
    for (const lights::DistantLight& light : lights)
        add(light.direction, vector_irradiance(light));
}

void LightPackets::add(const glm::dvec3& direction, const VectorIrradiance& irradiance) {
    if (packets_.empty() || packets_.back().directions.num_directions == prt::PacketSize)
        packets_.emplace_back();
    Packet& packet = packets_.back();
    const std::size_t lane = packet.directions.num_directions++;
    // Unused lanes repeat the packet's first direction.
    for (std::size_t k = lane; k < (lane == 0 ? prt::PacketSize : lane + 1); ++k)
        packet.directions.set(k, direction);
    packet.irradiance[lane] = irradiance;
}

std::uint32_t LightPackets::visible(std::size_t packet, const glm::vec3& position,
                                    const glm::vec3& normal, const ShadowRays& rays) const {
    const prt::DirectionPacket& directions = packets_[packet].directions;
    const std::uint32_t used = (1u << directions.num_directions) - 1;
    return prt::lit_lanes(*rays.blockers, prt::ray_origin(position, normal, rays.bias), normal,
                          directions, used);
}

glm::dvec3 LightPackets::radiance(const glm::vec3& position, const glm::vec3& normal,
                                  const ShadowRays& rays) const {
    glm::dvec3 irradiance(0.0);
    for (std::size_t p = 0; p < packets_.size(); ++p)
        for (std::uint32_t lights = visible(p, position, normal, rays); lights != 0;
             lights &= lights - 1)
            irradiance +=
                packets_[p].irradiance[static_cast<std::size_t>(std::countr_zero(lights))].on(
                    normal);
    return irradiance / std::numbers::pi;
}

void LightPackets::visible(const glm::vec3& position, const glm::vec3& normal,
                           const ShadowRays& rays, std::span<std::uint16_t> lanes) const {
    for (std::size_t p = 0; p < packets_.size(); ++p)
        lanes[p] = static_cast<std::uint16_t>(visible(p, position, normal, rays));
}

VectorIrradiance LightPackets::irradiance(std::span<const std::uint16_t> lanes) const {
    VectorIrradiance sum;
    for (std::size_t p = 0; p < packets_.size(); ++p)
        for (std::uint32_t lights = lanes[p]; lights != 0; lights &= lights - 1)
            sum += packets_[p].irradiance[static_cast<std::size_t>(std::countr_zero(lights))];
    return sum;
}

void LightPackets::light_block(const prt::BlockSurfaces& surfaces,
                               std::span<const glm::vec3> normals,
                               std::span<const std::uint16_t> lanes,
                               std::span<prt::Lobes<glm::dvec3>> sums) const {
    std::fill(sums.begin(), sums.end(), prt::Lobes<glm::dvec3>());
    for (std::size_t p = 0; p < packets_.size(); ++p) {
        const Packet& packet = packets_[p];
        // Transposed to lights, as the lobes are evaluated for a block at a time.
        std::array<std::uint32_t, prt::PacketSize> reached{};
        for (std::size_t i = 0; i < sums.size(); ++i)
            for (std::uint32_t lights = lanes[i * packets_.size() + p]; lights != 0;
                 lights &= lights - 1)
                reached[static_cast<std::size_t>(std::countr_zero(lights))] |= 1u << i;
        const prt::DirectionPacket& d = packet.directions;
        for (std::size_t light = 0; light < d.num_directions; ++light)
            add_light(surfaces, normals, {d.x[light], d.y[light], d.z[light]},
                      packet.irradiance[light], reached[light], sums);
    }
}

void add_light(const prt::BlockSurfaces& surfaces, std::span<const glm::vec3> normals,
               const glm::vec3& direction, const VectorIrradiance& irradiance,
               std::uint32_t reached, std::span<prt::Lobes<glm::dvec3>> sums) {
    if (reached == 0)
        return;
    std::array<prt::BlockSurfaces::Floats, prt::NumGlossyLobes> lobes;
    prt::evaluate_lobes(surfaces, direction, lobes);
    const glm::dvec3 strength(glm::length(irradiance.red), glm::length(irradiance.green),
                              glm::length(irradiance.blue));
    for (; reached != 0; reached &= reached - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(reached));
        prt::Lobes<glm::dvec3>& sum = sums[i];
        sum.diffuse += irradiance.on(normals[i]) / std::numbers::pi;
        for (std::size_t lobe = 0; lobe < prt::NumGlossyLobes; ++lobe)
            sum.*prt::GlossyParts<glm::dvec3>[lobe] +=
                strength * static_cast<double>(lobes[lobe][i]);
    }
}

VectorIrradiance vector_irradiance(const lights::DistantLight& light) {
    return {.red = light.irradiance.r * light.direction,
            .green = light.irradiance.g * light.direction,
            .blue = light.irradiance.b * light.direction};
}

std::vector<glm::dvec3> radiance_under(std::span<const lights::DistantLight> lights,
                                       std::span<const glm::vec3> normals,
                                       std::span<const std::uint32_t> receiver_indices,
                                       const ShadowRays& rays) {
    if (rays.blockers == nullptr || rays.positions.size() != normals.size())
        throw std::invalid_argument("expected shadow rays with one position per receiver");
    if (!std::all_of(receiver_indices.begin(), receiver_indices.end(),
                     [&](std::uint32_t receiver) { return receiver < normals.size(); }))
        throw std::invalid_argument("expected indices of receivers");
    const LightPackets packets(lights);
    std::vector<glm::dvec3> radiance(receiver_indices.size());
    files::parallel_for(files::IndexRange<std::size_t>(0, radiance.size(), ReceiversPerPart),
                        [&](const auto& some) {
                            for (std::size_t i = some.begin(); i < some.end(); ++i) {
                                const std::uint32_t receiver = receiver_indices[i];
                                radiance[i] = packets.radiance(rays.positions[receiver],
                                                               normals[receiver], rays);
                            }
                        });
    return radiance;
}

std::vector<glm::vec3> radiance_under(std::span<const lights::DistantLight> lights,
                                      std::span<const glm::vec3> normals, const ShadowRays& rays) {
    std::vector<std::uint32_t> all(normals.size());
    std::iota(all.begin(), all.end(), 0u);
    const std::vector<glm::dvec3> radiance = radiance_under(lights, normals, all, rays);
    return {radiance.begin(), radiance.end()};
}

} // namespace relumine::relight
