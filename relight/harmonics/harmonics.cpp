#include "relight/harmonics/harmonics.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace relumine::relight {

std::array<double, MaxHarmonics> harmonics(const glm::dvec3& d) {
    const double pi = std::numbers::pi;
    const double c0 = 0.5 / std::sqrt(pi);
    const double c1 = std::sqrt(3.0 / (4.0 * pi));
    const double c2 = 0.5 * std::sqrt(15.0 / pi);
    return {c0,
            c1 * d.y,
            c1 * d.z,
            c1 * d.x,
            c2 * d.x * d.y,
            c2 * d.y * d.z,
            0.25 * std::sqrt(5.0 / pi) * (3.0 * d.z * d.z - 1.0),
            c2 * d.x * d.z,
            0.5 * c2 * (d.x * d.x - d.y * d.y)};
}

std::array<double, MaxHarmonics> irradiance_harmonics(const glm::vec3& normal) {
    std::array<double, MaxHarmonics> values = harmonics(glm::dvec3(normal));
    for (std::size_t k = 0; k < values.size(); ++k)
        values[k] *= IrradianceFactors[band_of(k)];
    return values;
}

glm::dvec3 irradiance(std::span<const glm::vec3> light, const glm::vec3& normal) {
    const std::array<double, MaxHarmonics> values = irradiance_harmonics(normal);
    glm::dvec3 sum(0.0);
    for (std::size_t k = 0; k < light.size(); ++k)
        sum += values[k] * glm::dvec3(light[k]);
    return sum;
}

void bind_irradiance(std::span<glm::vec3> light, const glm::vec3& normal, const glm::dvec3& known) {
    if (normal == glm::vec3(0.0f))
        return;
    const std::array<double, MaxHarmonics> values = irradiance_harmonics(normal);
    double squares = 0.0;
    for (std::size_t k = 0; k < light.size(); ++k)
        squares += values[k] * values[k];
    const glm::dvec3 missing = (known - irradiance(light, normal)) / squares;
    for (std::size_t k = 0; k < light.size(); ++k)
        light[k] += glm::vec3(values[k] * missing);
}

void require_order(std::uint32_t order) {
    if (order != 2 && order != 3)
        throw std::invalid_argument(
            fmt::format("expected harmonics of order 2 or 3 (4 or 9 coefficients), got {}", order));
}

} // namespace relumine::relight
