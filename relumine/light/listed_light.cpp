#include "relumine/light/listed_light.h"

#include <numbers>

#include "relight/receiver_light.h"
#include "relight/sharp/light_packets.h"
#include "relight/sharp/shadow_rays.h"

namespace relumine {

namespace {

glm::dvec3 open_floor(std::span<const lights::DistantLight> lights) {
    glm::dvec3 sum(0.0);
    for (const lights::DistantLight& light : lights)
        sum += relight::vector_irradiance(light).on({0.0f, 1.0f, 0.0f}) / std::numbers::pi;
    return sum;
}

} // namespace

ListedLight listed_light(std::span<const lights::DistantLight> lights,
                         relight::Relighter& relighter, bool has_harmonics) {
    const auto copy = [](std::span<const glm::vec3> values) {
        return std::vector<glm::vec3>(values.begin(), values.end());
    };
    relighter.set_lights(lights);
    ListedLight result{.radiance = copy(relighter.radiance()),
                       .diffuse = copy(relighter.diffuse_radiance()),
                       .open_floor = open_floor(lights),
                       .lights = relight::picture_lights(relighter)};
    if (has_harmonics)
        result.harmonics = relighter.harmonics();
    if (!result.lights.empty())
        result.soft = relighter.receiver_light().soft_radiance();
    return result;
}

ListedLight listed_light(std::span<const lights::DistantLight> lights,
                         std::span<const glm::vec3> normals, const relight::ShadowRays& rays) {
    ListedLight result{.radiance = relight::radiance_under(lights, normals, rays),
                       .soft = std::vector<glm::vec3>(normals.size()),
                       .open_floor = open_floor(lights)};
    for (const lights::DistantLight& light : lights)
        result.lights.push_back({.cluster = 0,
                                 .cell = {},
                                 .direction = light.direction,
                                 .irradiance = {.red = light.irradiance.r * light.direction,
                                                .green = light.irradiance.g * light.direction,
                                                .blue = light.irradiance.b * light.direction},
                                 .is_of_list = true});
    return result;
}

} // namespace relumine
