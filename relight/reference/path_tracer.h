// Bounced light by path tracing: the reference for the matrix of bounces, of which it shares
// nothing but the rays.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "mesh/triangle_mesh.h"
#include "prt/lamps/lamps.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/ray_scene.h"
#include "prt/work.h"

namespace relumine::relight {

struct PathTracerOptions {
    /// Paths of each receiver.
    std::uint32_t num_paths = 1024;
    /// Bounces of a path; empty: until Russian roulette ends it.
    std::optional<std::uint32_t> num_bounces = {};
    std::uint64_t seed = 1;
    /// What glows, by triangle in ascending order; of the mesh's lamps, what has no surface. Light
    /// of lamps counts from the start of a path on, so it has one bounce fewer than that of the
    /// sky.
    std::span<const prt::Emitter> emitters = {};
    std::span<const mesh::PunctualLight> lights = {};
    /// Backs send the light that their fronts do; otherwise they are black.
    bool two_sided = false;
    /// Lift of the rays' origins, as in prt::PrecomputeOptions.
    float bias = 0.0f;
};

/// A mean over paths and how sure it is.
struct TracedBounces {
    /// Radiance that other surfaces and lamps add, for albedo 1.
    glm::dvec3 radiance{0.0};
    /// Standard error of the mean.
    glm::dvec3 standard_error{0.0};
};

/// Returns what other surfaces and lamps add to the environment's direct light of the chosen
/// receivers. Every surface is Lambert. The direct light of each point of a path is one sample of
/// the environment, one of what glows and one of the hemisphere, joined by the balance heuristic
/// [Veach and Guibas 1995].
///
/// Shape:   `albedo` is [num_vertices], interpolated; the result [receiver_indices.size()].
/// Cost:    some four rays per path and bounce.
/// Threads: parallel over receivers. A receiver's paths depend on the seed and its index only.
/// Throws:  std::invalid_argument for indices or sizes that do not fit, an environment without
///          texels, no paths; prt::Cancelled when stopped.
[[nodiscard]] std::vector<TracedBounces>
trace_bounces(const mesh::TriangleMesh& mesh, std::span<const glm::vec3> albedo,
              const prt::Receivers& receivers, std::span<const std::uint32_t> receiver_indices,
              const prt::RayScene& rays, const cubemap::CubeMap& environment,
              const PathTracerOptions& options = {}, const prt::Work& work = {});

} // namespace relumine::relight
