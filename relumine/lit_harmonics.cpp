// What LitScene tells of the light for any normal.
#include <numbers>
#include <stdexcept>

#include "relight/harmonics/harmonics.h"
#include "relumine/gathered.h"
#include "relumine/lit_scene.h"

namespace relumine {

std::vector<glm::vec3> LitScene::harmonics() const {
    if (!is_lit_ || harmonics_ == 0)
        throw std::logic_error("expected a scene that is lit, with LightOptions::harmonics");
    std::vector<glm::vec3> result = relighter().harmonics();
    for (std::size_t i = 0; i < added_.harmonics.size(); ++i)
        result[i] += added_.harmonics[i];
    const prt::Transfer& transfer = relighter().transfer();
    const std::size_t width = relight::num_harmonics(harmonics_);
    if (!bounces_.bounced().empty() || !lamps_.direct().empty()) {
        std::vector<glm::vec3> bounced(transfer.num_receivers(), glm::vec3(0.0f));
        add_surfaces(bounced);
        for (std::size_t place = 0; place < transfer.num_receivers(); ++place) {
            const std::uint32_t receiver = transfer.order[place];
            glm::dvec3 arriving(bounced[receiver]);
            // What surfaces send on, before their colours.
            for (int channel = 0; channel < 3 && !transfer.surfaces.empty(); ++channel) {
                const float albedo = transfer.surfaces[place].albedo[channel];
                arriving[channel] = albedo > 0.0f ? arriving[channel] / albedo : 0.0;
            }
            const std::span<glm::vec3> light = std::span(result).subspan(receiver * width, width);
            const glm::vec3& normal = transfer.normals[place];
            relight::bind_irradiance(
                light, normal, relight::irradiance(light, normal) + std::numbers::pi * arriving);
        }
    }
    return team_->has_others() ? gathered(*team_, scene_->transfer.order, result, width) : result;
}

} // namespace relumine
