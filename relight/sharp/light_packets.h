// Distant lights arranged for tracing: a shadow ray for each, sixteen at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "lights/light_list.h"
#include "prt/glossy/brdf.h"
#include "prt/glossy/lobe_kernel.h"
#include "prt/visibility/blockers.h"
#include "relight/kernels/cluster_lights.h"
#include "relight/sharp/shadow_rays.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::relight {

/// Whether a light is traced with those of a patch: there is room, and it lies within 8 degrees of
/// the first one. So wide a patch makes a shaft that few triangles lie in.
[[nodiscard]] bool fits(const prt::DirectionPatch& patch, const SharpLight& light);

/// Lights ready to be traced. Fastest when neighbours in the list lie close together.
class LightPackets {
public:
    explicit LightPackets(std::span<const SharpLight> lights);
    explicit LightPackets(std::span<const lights::DistantLight> lights);

    /// Returns the radiance (albedo 1) of a receiver: one shadow ray for each light above its
    /// horizon.
    [[nodiscard]] glm::dvec3 radiance(const glm::vec3& position, const glm::vec3& normal,
                                      const ShadowRays& rays) const;

    [[nodiscard]] std::size_t num_packets() const { return packets_.size(); }

    /// Finds the lights of a packet that reach a point: bit i is set for light 16 packet + i.
    [[nodiscard]] std::uint32_t visible(std::size_t packet, const glm::vec3& position,
                                        const glm::vec3& normal, const ShadowRays& rays) const;

    /// Finds all lights that reach a point: lanes[p] are those of packet p.
    ///
    /// Shape:   lanes is [num_packets()].
    void visible(const glm::vec3& position, const glm::vec3& normal, const ShadowRays& rays,
                 std::span<std::uint16_t> lanes) const;

    /// Returns the irradiance of these lights, for surfaces that they all stand above.
    [[nodiscard]] VectorIrradiance irradiance(std::span<const std::uint16_t> lanes) const;

    /// Computes the radiance through each lobe, without colours, of a block of up to 16 receivers
    /// with highlights. A light is a point.
    ///
    /// Shape:   lanes is [receivers x num_packets()] of visible(); normals and sums have one
    ///          element per receiver.
    void light_block(const prt::BlockSurfaces& surfaces, std::span<const glm::vec3> normals,
                     std::span<const std::uint16_t> lanes,
                     std::span<prt::Lobes<glm::dvec3>> sums) const;

private:
    void add(const glm::dvec3& direction, const VectorIrradiance& irradiance);

    struct Packet {
        prt::DirectionPacket directions;
        std::array<VectorIrradiance, prt::PacketSize> irradiance{};
    };
    std::vector<Packet> packets_;
};

/// Adds the radiance through each lobe that a light gives to some receivers of a block: bit i of
/// `reached` stands for receiver i.
///
/// Shape:   normals and sums have one element per receiver.
void add_light(const prt::BlockSurfaces& surfaces, std::span<const glm::vec3> normals,
               const glm::vec3& direction, const VectorIrradiance& irradiance,
               std::uint32_t reached, std::span<prt::Lobes<glm::dvec3>> sums);

/// Returns a distant light's irradiance as a vector.
[[nodiscard]] VectorIrradiance vector_irradiance(const lights::DistantLight& light);

} // namespace relumine::relight
