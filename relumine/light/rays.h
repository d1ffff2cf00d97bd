// What traces the rays of a scene.
#pragma once

#include <memory>

#include "prt/visibility/lazy_beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relumine/in/scene.h"

namespace relumine {

/// The ray accelerators of a scene, which must outlive them.
class SceneRays {
public:
    /// Cost:    O(n log n).
    explicit SceneRays(const Scene& scene)
        : of_mesh_(scene.mesh),
          others_(scene.blockers ? std::make_unique<const prt::RayScene>(*scene.blockers)
                                 : nullptr),
          moving_(scene.blocking_mesh(), blockers()) {}
    SceneRays(const SceneRays&) = delete;
    SceneRays& operator=(const SceneRays&) = delete;

    /// Against the mesh, as pictures show it.
    [[nodiscard]] const prt::RayScene& of_mesh() const { return of_mesh_; }
    /// What blocks the light: the mesh, or Scene::blockers.
    [[nodiscard]] const prt::RayScene& blockers() const { return others_ ? *others_ : of_mesh_; }
    /// What blocks sharp lights, which may move with every frame: the mesh, or Scene::blockers.
    [[nodiscard]] const prt::Blockers& for_moving_lights() const { return moving_; }

private:
    prt::RayScene of_mesh_;
    std::unique_ptr<const prt::RayScene> others_;
    prt::LazyBeamScene moving_;
};

} // namespace relumine
