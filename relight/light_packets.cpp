#include "relight/light_packets.h"

#include <bit>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace relumine::relight {

namespace {

/// Receivers of one task: with a handful of lights about 50 microseconds of work.
constexpr std::size_t ReceiversPerTask = 64;

} // namespace

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

template<typename Visit>
void LightPackets::for_visible(const glm::vec3& position, const glm::vec3& normal, const ShadowRays& rays,
                               const Visit& visit) const {
    const glm::vec3 origin = prt::ray_origin(position, normal, rays.bias);
    for (const Packet& packet : packets_) {
        std::uint32_t above = 0;
        for (std::uint32_t i = 0; i < packet.directions.num_directions; ++i) {
            const float cosine = normal.x * packet.directions.x[i] + normal.y * packet.directions.y[i] +
                                 normal.z * packet.directions.z[i];
            above |= static_cast<std::uint32_t>(cosine > 0.0f) << i;
        }
        if (above == 0)
            continue;
        std::uint32_t visible = above & ~rays.blockers->occluded(origin, packet.directions, above);
        for (; visible != 0; visible &= visible - 1)
            visit(packet, static_cast<std::size_t>(std::countr_zero(visible)));
    }
}

glm::dvec3 LightPackets::radiance(const glm::vec3& position, const glm::vec3& normal,
                                  const ShadowRays& rays) const {
    glm::dvec3 irradiance(0.0);
    for_visible(position, normal, rays, [&](const Packet& packet, std::size_t lane) {
        irradiance += packet.irradiance[lane].on(normal);
    });
    return irradiance / std::numbers::pi;
}

prt::Lobes<glm::dvec3> LightPackets::lobes(const glm::vec3& position, const glm::vec3& normal,
                                           const glm::vec3& to_eye, const prt::Surface& surface,
                                           const ShadowRays& rays) const {
    prt::Lobes<glm::dvec3> sums;
    for_visible(position, normal, rays, [&](const Packet& packet, std::size_t lane) {
        const prt::DirectionPacket& d = packet.directions;
        const VectorIrradiance& e = packet.irradiance[lane];
        const prt::Lobes<float> lobes =
            prt::evaluate_lobes(surface, normal, to_eye, {d.x[lane], d.y[lane], d.z[lane]});
        const glm::dvec3 light(glm::length(e.red), glm::length(e.green), glm::length(e.blue));
        sums.diffuse += e.on(normal) / std::numbers::pi;
        sums.diffuse_grazing += light * static_cast<double>(lobes.diffuse_grazing);
        sums.specular += light * static_cast<double>(lobes.specular);
        sums.specular_grazing += light * static_cast<double>(lobes.specular_grazing);
    });
    return sums;
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
    const LightPackets packets(lights);
    std::vector<glm::dvec3> radiance(receiver_indices.size());
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, radiance.size(), ReceiversPerTask), [&](const auto& some) {
            for (std::size_t i = some.begin(); i < some.end(); ++i) {
                const std::uint32_t receiver = receiver_indices[i];
                radiance[i] = packets.radiance(rays.positions[receiver], normals[receiver], rays);
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
