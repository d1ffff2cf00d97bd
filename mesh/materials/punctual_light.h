// Lights without a surface: KHR_lights_punctual of glTF.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <glm/vec3.hpp>

namespace relumine::mesh {

/// A light that a mesh's file places in its scene. Nothing shows it.
struct PunctualLight {
    enum class Kind : std::uint8_t { Point, Spot, Directional };

    std::string name = {};
    Kind kind = Kind::Point;
    /// Radiant intensity of points and spots, irradiance of directional ones across their beam: in
    /// the unit of an environment's radiance, times sr.
    glm::vec3 intensity{1.0f};
    /// The place of points and spots.
    glm::vec3 position{0.0f};
    /// The way that the light of spots and directional ones goes, of unit length.
    glm::vec3 direction{0.0f, 0.0f, -1.0f};
    /// The distance beyond which points and spots give no light.
    float range = std::numeric_limits<float>::infinity();
    /// Half angles of a spot's cones in radians. Light falls off between them.
    float inner_cone = 0.0f;
    float outer_cone = 0.785398163f;

    bool operator==(const PunctualLight&) const = default;
};

} // namespace relumine::mesh
