// A mapped normal that mirrors the eye's ray to the outside of the surface.
#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace relumine::prt {

/// Turns a mapped normal as little as it takes for a mirror to reflect the eye's ray to the outside
/// of the surface, whose normal is given: a steeper facet would hide behind others.
///
/// Based on: Blender's Cycles, ensure_valid_specular_reflection() (the equation).
[[nodiscard]] inline glm::vec3 reflecting_outwards(const glm::vec3& mapped, const glm::vec3& normal,
                                                   const glm::vec3& to_eye) {
    const float eye_z = glm::dot(to_eye, normal);
    const float least = std::min(0.9f * eye_z, 0.1f);
    const glm::vec3 mirrored = 2.0f * glm::dot(mapped, to_eye) * mapped - to_eye;
    const glm::vec3 across = mapped - glm::dot(mapped, normal) * normal;
    const float tilt = glm::length(across);
    if (!(eye_z > 0.0f) || !(tilt > 0.0f) || glm::dot(normal, mirrored) >= least)
        return mapped;
    // In the plane of both normals, a normal (x, z) mirrors the eye to the height 2 z (x eye_x + z
    // eye_z) - eye_z, which shall be `least`: an equation of second degree for z^2.
    const glm::vec3 axis = across / tilt;
    const float eye_x = glm::dot(to_eye, axis);
    const float a = eye_x * eye_x + eye_z * eye_z, b = 2.0f * (a + eye_z * least);
    const float c = (least + eye_z) * (least + eye_z);
    const float root = std::sqrt(std::max(b * b - 4.0f * a * c, 0.0f));
    const float z2 = std::clamp(0.25f * (eye_x < 0.0f ? b + root : b - root) / a, 0.0f, 1.0f);
    return std::sqrt(1.0f - z2) * axis + std::sqrt(z2) * normal;
}

} // namespace relumine::prt
