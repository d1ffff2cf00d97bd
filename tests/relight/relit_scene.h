// A scene with hard and soft shadows, precomputed, for the tests of relighting.
#pragma once

#include <utility>

#include "mesh/triangle_mesh.h"
#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/ray_scene.h"
#include "relight/sharp/shadow_rays.h"
#include "tests/prt/scenes.h"

namespace relumine::scenes {

struct RelitScene {
    mesh::TriangleMesh mesh;
    prt::Receivers receivers = prt::vertex_receivers(mesh);
    prt::RayScene rays{mesh};
    prt::PrecomputeOptions options;
    prt::Transfer transfer;

    explicit RelitScene(float tolerance = 0.02f, std::uint32_t face_resolution = 64,
                        mesh::TriangleMesh of = sphere_and_box_on_floor())
        : mesh(std::move(of)), options{.tolerance = tolerance,
                                       .face_resolution = face_resolution,
                                       .bias = prt::automatic_bias(mesh)},
          transfer(prt::precompute(receivers, rays, options)) {}

    [[nodiscard]] relight::ShadowRays shadow_rays() const {
        return {.blockers = &rays,
                .positions = receivers.positions,
                .bias = options.bias,
                .tolerance = options.tolerance};
    }
};

/// One for all tests that only read it.
[[nodiscard]] inline const RelitScene& relit_scene() {
    static const RelitScene scene;
    return scene;
}

/// A floor of several tiles with a box on it: the whole sky lights many tiles alike.
[[nodiscard]] inline const RelitScene& relit_floor() {
    static const RelitScene scene(
        0.05f, 32, joined(floor_grid(70, 8.0f), box({0.5f, 0.0f, 0.5f}, {1.0f, 1.0f, 1.5f})));
    return scene;
}

} // namespace relumine::scenes
