// Based on: Snyder, "Area light sources for real-time graphics", 1996, the integral of the cosine
// over a spherical cap that the horizon cuts. The same integral is known from the view factors of
// spheres in heat transfer.
#include "tests/lights/disc_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace relumine::lights {

namespace {

constexpr double Pi = std::numbers::pi;

/// Returns the integral of max(n.w, 0) over a cap, divided by pi sin^2(radius). The cap has the
/// angular radius `radius` (at most pi / 2) and lies at `angle` to n. The result is the cosine of
/// `angle` if the horizon does not cut the cap.
double cap_cosine(double angle, double radius) {
    if (angle <= 0.5 * Pi - radius)
        return std::cos(angle);
    if (angle >= 0.5 * Pi + radius)
        return 0.0;
    const double cosine = std::cos(angle), sine = std::sin(angle);
    const double sine_radius = std::sin(radius), cosine_radius = std::cos(radius);
    const double gamma = std::asin(std::clamp(cosine_radius / sine, -1.0, 1.0));
    const double cosine_gamma = std::cos(gamma);
    const double G = -2.0 * sine * cosine_radius * cosine_gamma + 0.5 * Pi - gamma +
                     std::sin(gamma) * cosine_gamma;
    const double H =
        cosine *
        (cosine_gamma *
             std::sqrt(std::max(0.0, sine_radius * sine_radius - cosine_gamma * cosine_gamma)) +
         sine_radius * sine_radius * std::asin(std::clamp(cosine_gamma / sine_radius, -1.0, 1.0)));
    const double whole = Pi * sine_radius * sine_radius;
    const double integral = angle < 0.5 * Pi ? whole * cosine + G - H : G + H;
    return std::max(0.0, integral / whole);
}

} // namespace

glm::dvec3 irradiance(const DistantLight& light, const glm::dvec3& normal) {
    const double cosine = std::clamp(glm::dot(light.direction, normal), -1.0, 1.0);
    // Below a ten-thousandth of a degree the closed form loses its digits, and the disc cannot be
    // told from a point.
    constexpr double Point = 1e-11;
    if (light.solid_angle < Point)
        return light.irradiance * std::max(cosine, 0.0);
    // A little less than a hemisphere, where the closed form fails.
    constexpr double MaxRadius = 0.5 * Pi - 1e-6;
    const double share = std::min(light.solid_angle / (4.0 * Pi), 0.5);
    const double radius = std::min(2.0 * std::asin(std::sqrt(share)), MaxRadius);
    return light.irradiance * cap_cosine(std::acos(cosine), radius);
}

} // namespace relumine::lights
