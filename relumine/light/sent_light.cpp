#include "relumine/light/sent_light.h"

#include "prt/glossy/brdf.h"
#include "relight/pictures/framing.h"

namespace relumine {

namespace {

/// Returns a over b, 0 where b is 0.
glm::vec3 ratio(const glm::vec3& a, const glm::vec3& b) {
    glm::vec3 result(0.0f);
    for (int channel = 0; channel < 3; ++channel)
        if (b[channel] > 0.0f)
            result[channel] = a[channel] / b[channel];
    return result;
}

} // namespace

void add_sent_light(const Scene& scene, const SceneBounces& bounces,
                    std::span<const glm::vec3> gathered, Lighting& lighting) {
    const std::vector<prt::Surface>& surfaces = scene.receivers.surfaces;
    const std::vector<prt::EyeCosines> cosines = prt::eye_cosines(scene.receivers);
    lighting.sent.assign(lighting.radiance.begin(), lighting.radiance.end());
    lighting.replaced.assign(gathered.begin(), gathered.end());
    for (std::size_t i = 0; i < gathered.size(); ++i) {
        const glm::vec3 own = surfaces.empty() ? glm::vec3(1.0f) : surfaces[i].albedo;
        lighting.sent[i] *= ratio(bounces.surfaces().albedo[i], own);
        if (!surfaces.empty())
            lighting.replaced[i] = ratio(gathered[i], prt::diffuse_albedo(surfaces[i], cosines[i]));
    }
}

bool is_gathered(const Scene& scene) {
    return prt::on_vertices(scene.layout) && !scene.settings.view && scene.bounces &&
           relight::inside_room(scene.mesh).has_value();
}

} // namespace relumine
