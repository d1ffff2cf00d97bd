// Rays from a point, spread as a lobe is: sixteen at a time. Vectorised with run-time dispatch.
//
// Based on: E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018.
#pragma once

#include <array>
#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "prt/visibility/blockers.h"

namespace relumine::relight {

/// Which rays a fan has.
struct RayFan {
    /// Unit length. The eye is above the normal.
    glm::vec3 normal, to_eye;
    /// Of a GGX lobe; 0: rays are as dense everywhere above the surface.
    float alpha;
    std::uint32_t num_rays;
    /// Of hammersley()
    glm::vec2 shift;
};

/// Some rays of a fan.
struct FanRays {
    prt::DirectionPacket directions;
    /// Of rays around each: mirrored_density(), or 1 / 2 pi.
    alignas(64) std::array<float, prt::PacketSize> densities;
    /// Bit i is set where ray i is above the surface. Rays are mirrored at visible_half() and may
    /// be below it.
    std::uint32_t above = 0;
};

/// Returns up to 16 rays of a fan, from ray `first` on. Lanes behind the last ray repeat it.
[[nodiscard]] FanRays fan_rays(const RayFan& fan, std::uint32_t first);

} // namespace relumine::relight
