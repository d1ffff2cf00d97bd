// Places that fill the unit square evenly, as many of them as are taken.
//
// Based on: M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// One over the plastic number, and over its square.
inline constexpr double R2StepS = 0.7548776662466927, R2StepT = 0.5698402909980532;

/// Returns place i of the R2 sequence, in [0, 1)^2, shifted.
[[nodiscard]] inline glm::dvec2 r2_place(std::uint64_t i, const glm::dvec2& shift = {0.0, 0.0}) {
    return glm::fract(shift + static_cast<double>(i) * glm::dvec2(R2StepS, R2StepT));
}

/// Returns the direction for a place: even places make cosine-distributed directions around the
/// third axis of a frame (cubemap/frame.h).
[[nodiscard]] inline glm::dvec3 cosine_direction(const glm::dmat3& frame, const glm::dvec2& place) {
    const double radius = std::sqrt(place.x);
    const double angle = 2.0 * std::numbers::pi * place.y;
    return frame *
           glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1.0 - place.x));
}

} // namespace relumine::cubemap
