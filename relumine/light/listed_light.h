// The light of a list of distant lights, which comes on top of an environment's.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "lights/light_list.h"
#include "relight/relighter.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine {

/// Empty: there is none.
struct ListedLight {
    /// The lights that it, or the clusters' light, was made of
    std::vector<lights::DistantLight> made_of = {};
    /// [receivers of this process] radiance, that of surfaces without highlights, and that without
    /// the lights that are traced one by one
    std::vector<glm::vec3> radiance = {}, diffuse = {}, soft = {};
    /// [receivers of this process][order^2] what arrives, as spherical harmonics
    std::vector<glm::vec3> harmonics = {};
    /// The radiance, for albedo 1, of a level floor that nothing shades
    glm::dvec3 open_floor{0.0};
    /// The lights that are traced one by one
    std::vector<relight::SharpLight> lights = {};

    /// Returns what is added to light without the lights that are traced one by one.
    [[nodiscard]] std::span<const glm::vec3> without_traced() const {
        return lights.empty() ? radiance : soft;
    }
};

/// Lights a scene with a list to get its light. The Relighter keeps that light.
[[nodiscard]] ListedLight listed_light(std::span<const lights::DistantLight> lights,
                                       relight::Relighter& relighter, bool has_harmonics);
/// Lights surfaces of a scene without clusters.
[[nodiscard]] ListedLight listed_light(std::span<const lights::DistantLight> lights,
                                       std::span<const glm::vec3> normals,
                                       const relight::ShadowRays& rays);

} // namespace relumine
