// Rays from a point, spread as a lobe is: sixteen at a time. Vectorised with run-time dispatch.
//
// Based on: E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "prt/visibility/blockers.h"

namespace relumine::relight {

/// Which rays a fan has.
struct RayFan {
    /// Unit length. The eye is above the normal.
    glm::vec3 normal, to_eye;
    /// Alpha of a GGX lobe; 0: rays are as dense everywhere above the surface.
    float alpha;
    std::uint32_t num_rays;
    /// Shifts rays around their columns and around the height of the square.
    glm::vec2 shift;
    /// Alpha along the tangent, where the lobe is stretched. 0: the lobe is round.
    float alpha_along = 0.0f;
    glm::vec3 tangent{0.0f};
    /// The number of one ray that is sent alone.
    std::optional<std::uint32_t> only = std::nullopt;
};

/// Into how many columns the points of a fan, which are Hammersley's, part the unit square from the
/// middle of a lobe to its tail. Each ray keeps its column. Of 2^n rays each column has as many
/// rows with one ray, or half.
[[nodiscard]] constexpr std::uint32_t fan_columns(std::uint32_t num_rays) {
    return 1u << std::bit_width(num_rays) / 2;
}

/// What all rays of a fan share. Coordinates are along two axes across the normal, and along it.
struct FanFrame {
    glm::mat3 axes;
    /// Alpha along the first axis and the second.
    glm::vec2 alphas;
    glm::vec3 to_eye;
    /// The eye where the lobe is stretched until its facets are spread evenly, and two axes across.
    glm::vec3 stretched_eye, t1{1.0f, 0.0f, 0.0f}, t2;

    explicit FanFrame(const RayFan& fan);
};

/// Some rays of a fan.
struct FanRays {
    prt::DirectionPacket directions;
    /// Density of the fan's rays around each, 1/sr: mirrored_density(), or 1 / 2 pi.
    alignas(64) std::array<float, prt::PacketSize> densities;
    /// Bit i is set where ray i is above the surface. Rays are mirrored at visible_half() and may
    /// be below it.
    std::uint32_t above = 0;
};

/// Returns up to 16 rays of a fan, from ray `first` on; one where one is sent alone. Lanes behind
/// the last ray repeat it.
[[nodiscard]] FanRays fan_rays(const RayFan& fan, const FanFrame& frame, std::uint32_t first);

/// Returns 16 directions spread over the part of the lobe that one ray of a fan of 2^n stands for.
/// The parts of all its rays are the whole lobe. The densities are those of the fan's rays.
[[nodiscard]] FanRays fan_part(const RayFan& fan, const FanFrame& frame, std::uint32_t ray);

} // namespace relumine::relight
