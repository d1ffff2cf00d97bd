// What traces the rays of a scene.
#pragma once

#include <cstdint>
#include <memory>

#include "prt/visibility/lazy_beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relumine/in/scene.h"

namespace relumine {

/// The ray accelerators of a scene, which must outlive them.
class SceneRays {
public:
    /// Groups of a scene that was precomputed with PrecomputeOptions::movable may move.
    ///
    /// Cost:    O(n log n).
    explicit SceneRays(const Scene& scene);
    SceneRays(const SceneRays&) = delete;
    SceneRays& operator=(const SceneRays&) = delete;

    /// Takes a group of the scene's mesh as it stands there, while nobody asks.
    void follow(std::uint32_t group);

    /// Against the mesh, as pictures show it.
    [[nodiscard]] const prt::RayScene& of_mesh() const { return of_mesh_; }
    /// What blocks the light: the mesh, or Scene::blockers.
    [[nodiscard]] const prt::RayScene& blockers() const { return others_ ? *others_ : of_mesh_; }
    /// What blocks sharp lights, which may move with every frame: the mesh, or Scene::blockers.
    [[nodiscard]] const prt::Blockers& for_moving_lights() const { return moving_; }
    /// What blocks sharp lights, prepared for many rays.
    [[nodiscard]] const prt::BeamScene& beams() const { return moving_.beams(); }

private:
    const Scene& scene_;
    prt::RayScene of_mesh_;
    std::unique_ptr<prt::RayScene> others_;
    prt::LazyBeamScene moving_;
};

} // namespace relumine
