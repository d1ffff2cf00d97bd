// The light of a scene's own lamps: what reaches its receivers without a bounce.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/lamps/lamps.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::relight {

/// The receivers of lamps, and what stands between.
struct LampReceivers {
    /// [num_receivers]
    std::span<const glm::vec3> positions;
    /// [num_receivers]; zero: the receiver gets no light.
    std::span<const glm::vec3> normals;
    const prt::RayScene& rays;
    /// Lift of the rays' origins, as in prt::PrecomputeOptions.
    float bias = 0.0f;
    /// Backs glow as fronts do.
    bool two_sided = false;
};

/// Returns the radiance, for albedo 1, that lamps give to receivers without a bounce.
///
/// The light of a surface is Lambert's formula for polygons, or that of a point where it is far
/// away, times the part of it that rays reach [Heitz et al. 2018, "Combining Analytic Direct
/// Illumination and Stochastic Shadows"]. So only half-shadows have noise: 16 rays for each
/// receiver, and 128 more where some of them are blocked. Other lamps have one ray each.
///
/// Shape:   `emitters` and `lights` are lamps of the mesh; the result is [num_receivers].
/// Threads: parallel; the same bits for any number of threads.
[[nodiscard]] std::vector<glm::vec3> lamp_light(const mesh::TriangleMesh& mesh,
                                                std::span<const prt::Emitter> emitters,
                                                std::span<const mesh::PunctualLight> lights,
                                                const LampReceivers& receivers);

} // namespace relumine::relight
