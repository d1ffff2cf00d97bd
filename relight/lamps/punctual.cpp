#include "relight/lamps/punctual.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>

namespace relumine::relight {

Arriving arriving(const mesh::PunctualLight& light, const glm::dvec3& place) {
    const glm::dvec3 intensity(light.intensity), forward(light.direction);
    if (light.kind == mesh::PunctualLight::Kind::Directional)
        return {.direction = -forward, .irradiance = intensity};
    const glm::dvec3 way = glm::dvec3(light.position) - place;
    const double distance = glm::length(way);
    if (!(distance > 0.0))
        return {};
    Arriving result{.direction = way / distance, .distance = distance};
    double part = std::clamp(1.0 - std::pow(distance / double{light.range}, 4.0), 0.0, 1.0);
    if (light.kind == mesh::PunctualLight::Kind::Spot) {
        constexpr double LeastDifference = 0.001;
        const double outer = std::cos(double{light.outer_cone});
        const double scale =
            1.0 / std::max(LeastDifference, std::cos(double{light.inner_cone}) - outer);
        const double inside =
            std::clamp((-glm::dot(result.direction, forward) - outer) * scale, 0.0, 1.0);
        part *= inside * inside;
    } else if (light.kind == mesh::PunctualLight::Kind::Profile) {
        const double along = -glm::dot(result.direction, forward);
        const glm::dvec2 across(-glm::dot(result.direction, glm::dvec3(light.right)),
                                -glm::dot(result.direction, glm::dvec3(light.up)));
        part *= light.profile.at(glm::degrees(std::atan2(glm::length(across), along)),
                                 glm::degrees(std::atan2(across.y, across.x)));
    }
    result.irradiance = intensity * part / (distance * distance);
    return result;
}

glm::dvec3 punctual_light(const mesh::PunctualLight& light, const glm::vec3& origin,
                          const glm::dvec3& normal, const prt::RayScene& rays) {
    const Arriving from = arriving(light, glm::dvec3(origin));
    const double cosine = glm::dot(normal, from.direction);
    if (!(cosine > 0.0) || from.irradiance == glm::dvec3(0.0) ||
        rays.occluded(origin, glm::vec3(from.direction), static_cast<float>(from.distance)))
        return glm::dvec3(0.0);
    return from.irradiance * cosine / std::numbers::pi;
}

} // namespace relumine::relight
