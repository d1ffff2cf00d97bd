#include "relumine/in/scene_rays.h"

#include <algorithm>

namespace relumine {

namespace {

prt::RayScene rays_of(const mesh::TriangleMesh& mesh, const Scene& scene) {
    using Groups = prt::RayScene::Groups;
    return prt::RayScene(mesh, prt::RayScene::Packets::Narrow,
                         scene.settings.is_movable ? Groups::Move : Groups::Stay);
}

} // namespace

SceneRays::SceneRays(const Scene& scene)
    : scene_(scene), of_mesh_(rays_of(scene.mesh, scene)),
      others_(scene.blockers ? std::make_unique<prt::RayScene>(rays_of(*scene.blockers, scene))
                             : nullptr),
      moving_(scene.blocking_mesh(), blockers()) {}

void SceneRays::follow(std::uint32_t group) {
    of_mesh_.follow(scene_.mesh, group);
    std::uint32_t of_blockers = group;
    if (others_) {
        const std::vector<std::string>& names = scene_.blockers->groups;
        of_blockers = static_cast<std::uint32_t>(
            std::ranges::find(names, scene_.mesh.groups[group]) - names.begin());
        others_->follow(*scene_.blockers, of_blockers);
    }
    moving_.follow(of_blockers);
}

} // namespace relumine
