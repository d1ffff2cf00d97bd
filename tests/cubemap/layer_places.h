// Regions in many places with closed forms, and random layers, for the tests of light layers.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <variant>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

constexpr double Pi = std::numbers::pi;

inline double radians(double degrees) {
    return degrees * Pi / 180.0;
}

/// Middles, edges and corners of faces, just beside them, and anywhere.
inline const std::vector<glm::dvec3> Places = {
    {0, 0, 1},     {-1, 0, 0},       {0, -1, 0},         {1, 1, 0},
    {0, -1, 1},    {1, 1, 1},        {-1, 1, -1},        {1, 0.9999, 0},
    {1, 1, 0.998}, {0.3, 0.8, -0.4}, {-0.77, 0.1, 0.61}, {0.01, -1, 0.02}};

/// A place's direction with two across it.
struct Frame {
    explicit Frame(const glm::dvec3& direction)
        : forward(glm::normalize(direction)),
          right(glm::normalize(glm::cross(forward, {0.31, 0.52, 0.17}))),
          up(glm::cross(forward, right)) {}
    /// The direction at an angle from the middle, at a position angle around it.
    [[nodiscard]] glm::dvec3 at(double angle, double around) const {
        return forward * std::cos(angle) +
               (right * std::cos(around) + up * std::sin(around)) * std::sin(angle);
    }
    glm::dvec3 forward, right, up;
};

/// A polygon with corners at these angles from the middle, evenly around it.
inline Lasso lasso_around(const glm::dvec3& direction, const std::vector<double>& angles) {
    const Frame frame(direction);
    Lasso lasso;
    for (std::size_t i = 0; i < angles.size(); ++i)
        lasso.points.push_back(frame.at(angles[i], 2.0 * Pi * (static_cast<double>(i) + 0.3) /
                                                       static_cast<double>(angles.size())));
    return lasso;
}

/// A layer of any kind, place and size.
inline LightLayer random_layer(std::mt19937& generator) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(generator);
    };
    const auto colour = [&] {
        return glm::vec3(glm::dvec3(uniform(0.0, 2.0), uniform(0.0, 2.0), uniform(0.0, 2.0)));
    };
    glm::dvec3 direction = Places[static_cast<std::size_t>(uniform(0.0, 11.99))];
    if (uniform(0.0, 1.0) < 0.5)
        direction = glm::dvec3(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)) +
                    glm::dvec3(1e-3);
    const double size = std::exp(uniform(std::log(0.01), std::log(80.0)));
    const double softness = uniform(0.0, 1.0) < 0.4 ? 0.0 : uniform(0.0, 1.0);
    LightLayer layer{.name = "random", .gain_ev = uniform(-2.0, 2.0)};
    static_assert(std::variant_size_v<Region> == 4, "a case for each shape");
    switch (static_cast<int>(uniform(0.0, 3.99))) {
    case 0:
        layer.region = Disc{direction, size, softness};
        break;
    case 1:
        layer.region = Rectangle{direction, 2.0 * size, uniform(0.01, 2.0) * size,
                                 uniform(0.0, 360.0), softness};
        break;
    case 2: {
        std::vector<double> angles(static_cast<std::size_t>(uniform(3.0, 12.0)));
        for (double& angle : angles)
            angle = radians(uniform(0.2, 0.7) * size);
        Lasso lasso = lasso_around(direction, angles);
        lasso.softness_degrees = 0.5 * softness * size;
        layer.region = lasso;
        break;
    }
    default: {
        const Frame frame(direction);
        Stroke stroke{{}, 0.3 + 0.3 * size, softness};
        for (int i = static_cast<int>(uniform(1.0, 6.0)); i > 0; --i)
            stroke.points.push_back(frame.at(uniform(0.0, 1.0), uniform(0.0, 6.0)));
        layer.region = stroke;
        break;
    }
    }
    if (uniform(0.0, 1.0) < 0.5)
        layer.effect = Gain{static_cast<float>(uniform(0.0, 3.0)), colour()};
    else
        layer.effect = Emit{colour()};
    return layer;
}

} // namespace relumine::cubemap
