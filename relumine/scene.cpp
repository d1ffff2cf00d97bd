#include "relumine/scene.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <glm/geometric.hpp>

#include "prt/tolerance.h"
#include "prt/visibility/ray_scene.h"

namespace relumine {

Scene unclustered_scene(Mesh mesh) {
    Scene scene;
    scene.mesh = std::move(mesh.geometry);
    scene.receivers = prt::vertex_receivers(scene.mesh);
    scene.settings.bias = prt::automatic_bias(scene.mesh);
    return scene;
}

float rms_tolerance(const Scene& scene) {
    return prt::rms_tolerance(scene.settings.tolerance, scene.settings.epsilon,
                              scene.transfer.num_receivers());
}

void set_colors(Scene& scene, const SurfaceColors& colors) {
    if (scene.receivers.surfaces.empty())
        throw std::invalid_argument("expected a scene with materials, got one without");
    for (prt::Surface& surface : scene.receivers.surfaces) {
        surface.albedo = colors.albedo.value_or(surface.albedo);
        surface.specular = colors.specular.value_or(surface.specular);
    }
    if (colors.albedo) // textures, too, give way to it
        scene.mesh.triangle_materials.clear();
    prt::set_surfaces(scene.transfer, scene.receivers);
}

Camera camera_of(const Scene& scene, const relight::PictureOptions& size, float fov_degrees) {
    return scene.settings.view ? *scene.settings.view
                               : relight::automatic_camera(scene.mesh, size, fov_degrees);
}

std::uint32_t nearest_receiver(const Scene& scene, const glm::vec3& position) {
    const std::vector<glm::vec3>& positions = scene.receivers.positions;
    const auto nearest =
        std::min_element(positions.begin(), positions.end(), [&](const auto& a, const auto& b) {
            return glm::dot(a - position, a - position) < glm::dot(b - position, b - position);
        });
    return static_cast<std::uint32_t>(nearest - positions.begin());
}

} // namespace relumine
