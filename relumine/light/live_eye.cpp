#include "relumine/light/live_eye.h"

#include <algorithm>
#include <stdexcept>

#include "prt/glossy/lobe_list.h"
#include "prt/glossy/surface_sampling.h"

namespace relumine {

namespace {

bool is_shiny(const prt::Surface& surface) {
    return prt::facts_of(surface.highlight).is_roughness;
}

/// The surfaces with the highlights that the scene's own have not; without coat, sheen and film,
/// and round.
std::vector<prt::Surface> shiny_surfaces(const LitScene& lit) {
    const Scene& scene = lit.scene();
    if (!has_live_highlights(scene))
        throw std::invalid_argument("expected vertices with glossy materials and no --view");
    if (scene.transfer.num_receivers() != scene.receivers.size())
        throw std::invalid_argument("expected a scene with all of its receivers in one process");
    std::vector<prt::Surface> surfaces = prt::vertex_surfaces(scene.mesh);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (!is_shiny(surfaces[i]))
            surfaces[i] = scene.receivers.surfaces[i];
        surfaces[i].coat = 0.0f;
        surfaces[i].sheen = glm::vec3(0.0f);
        surfaces[i].film = surfaces[i].anisotropy = 0.0f;
    }
    return surfaces;
}

} // namespace

bool has_live_highlights(const Scene& scene) {
    const mesh::TriangleMesh& mesh = scene.mesh;
    return prt::on_vertices(scene.layout) && scene.receivers.to_eye.empty() &&
           !scene.receivers.surfaces.empty() && has_clusters(scene) &&
           std::any_of(mesh.triangle_materials.begin(), mesh.triangle_materials.end(),
                       [&](std::uint32_t material) { return has_ggx(mesh.materials[material]); });
}

LiveEye::LiveEye(const LitScene& lit)
    : lit_(lit), surfaces_(shiny_surfaces(lit)),
      eye_(lit.scene().transfer, lit.scene().receivers.positions, surfaces_,
           lit.scene().mesh.triangles) {
    take_light();
}

void LiveEye::take_light() {
    eye_.set_light(lit_.relighter());
}

void LiveEye::take_surfaces() {
    surfaces_ = shiny_surfaces(lit_);
    if (eye_.set_surfaces(surfaces_))
        take_light();
}

float LiveEye::mean_roughness() const {
    double sum = 0.0, count = 0.0;
    for (const prt::Surface& surface : surfaces_)
        if (is_shiny(surface)) {
            sum += static_cast<double>(surface.roughness_or_exponent);
            count += 1.0;
        }
    return static_cast<float>(sum / count);
}

std::size_t LiveEye::num_too_smooth() const {
    return static_cast<std::size_t>(
        std::count_if(surfaces_.begin(), surfaces_.end(), [](const prt::Surface& surface) {
            return is_shiny(surface) &&
                   surface.roughness_or_exponent < relight::NarrowestLiveRoughness;
        }));
}

} // namespace relumine
