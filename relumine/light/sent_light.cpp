#include "relumine/light/sent_light.h"

#include "prt/glossy/brdf.h"
#include "relight/pictures/framing.h"
#include "relight/surfaces/surface_colors.h"

namespace relumine {

void add_sent_light(const Scene& scene, const SceneBounces& bounces,
                    std::span<const glm::vec3> gathered, Lighting& lighting) {
    const std::vector<prt::Surface>& surfaces = scene.receivers.surfaces;
    const std::vector<prt::EyeCosines> cosines = prt::eye_cosines(scene.receivers);
    lighting.sent.assign(lighting.radiance.begin(), lighting.radiance.end());
    lighting.replaced.assign(gathered.begin(), gathered.end());
    for (std::size_t i = 0; i < gathered.size(); ++i) {
        const glm::vec3 own = surfaces.empty() ? glm::vec3(1.0f) : surfaces[i].albedo;
        lighting.sent[i] *= relight::before_color(bounces.surfaces().albedo[i], own);
        if (!surfaces.empty())
            lighting.replaced[i] =
                relight::before_color(gathered[i], prt::diffuse_albedo(surfaces[i], cosines[i]));
    }
}

bool is_gathered(const Scene& scene) {
    return prt::on_vertices(scene.layout) && !scene.settings.view && scene.bounces &&
           relight::inside_room(scene.mesh).has_value();
}

} // namespace relumine
