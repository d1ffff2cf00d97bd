// Lights without a surface: KHR_lights_punctual and EXT_lights_ies of glTF.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <glm/vec3.hpp>

#include "mesh/materials/light_profile.h"

namespace relumine::mesh {

/// A light that a mesh's file places in its scene. Nothing shows it.
struct PunctualLight {
    /// Profile: a point whose intensity depends on the direction as a profile says.
    enum class Kind : std::uint8_t { Point, Spot, Directional, Profile };

    std::string name = {};
    Kind kind = Kind::Point;
    /// Radiant intensity of points and spots, irradiance of directional ones across their beam: in
    /// the unit of an environment's radiance, times sr. A factor on the profile's candela.
    glm::vec3 intensity{1.0f};
    /// The place, but for directional ones.
    glm::vec3 position{0.0f};
    /// The way that the light of spots and directional ones goes, of unit length; the vertical
    /// angle 0 of a profile.
    glm::vec3 direction{0.0f, 0.0f, -1.0f};
    /// The distance beyond which points and spots give no light.
    float range = std::numeric_limits<float>::infinity();
    /// Half angles of a spot's cones in radians. Light falls off between them.
    float inner_cone = 0.0f;
    float outer_cone = 0.785398163f;
    LightProfile profile = {};
    /// The horizontal angles 0 and 90 of the profile, of unit length, across the direction.
    glm::vec3 right{1.0f, 0.0f, 0.0f};
    glm::vec3 up{0.0f, 1.0f, 0.0f};

    bool operator==(const PunctualLight&) const = default;
};

} // namespace relumine::mesh
