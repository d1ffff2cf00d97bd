// A mesh with its transfer and bounces, for tests.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/bounces/bounce_precompute.h"
#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relight/bounces/bounce_light.h"
#include "relight/probe_lights.h"
#include "tests/prt/all_bounces.h"

namespace relumine::relight {

/// A mesh with its transfer and bounces.
struct BouncingScene {
    explicit BouncingScene(const mesh::TriangleMesh& given, float tolerance = 0.01f,
                           float transfer_tolerance = 0.01f)
        : mesh(given), receivers(prt::vertex_receivers(mesh)), rays(mesh),
          bias(prt::automatic_bias(mesh)),
          transfer(prt::precompute(
              receivers, prt::BeamScene(mesh, rays),
              {.tolerance = transfer_tolerance, .face_resolution = 256, .bias = bias})),
          matrix(prt::precompute_bounces(mesh, receivers, transfer, probe_radiance(transfer), rays,
                                         {.tolerance = tolerance, .bias = bias}, {}, &statistics)) {
    }

    /// Returns one bounce of the emitters' radiance, [num_vertices].
    [[nodiscard]] std::vector<float> bounce(const std::vector<float>& radiance) const {
        BounceLight light(matrix, transfer);
        std::vector<glm::vec3> albedo, direct;
        for (const float value : radiance) {
            albedo.emplace_back(value > 0.0f ? 0.5f : 0.0f);
            direct.emplace_back(2.0f * value);
        }
        light.set_albedo(albedo);
        light.solve(direct, {.num_bounces = 1});
        std::vector<float> result;
        for (const glm::vec3& value : light.indirect())
            result.push_back(value.g);
        return result;
    }

    mesh::TriangleMesh mesh;
    prt::Receivers receivers;
    prt::RayScene rays;
    float bias;
    prt::Transfer transfer;
    prt::BounceStatistics statistics;
    prt::BounceMatrix matrix;
};

} // namespace relumine::relight
