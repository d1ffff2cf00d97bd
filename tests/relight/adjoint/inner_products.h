// What tests of adjoints share: random weights, and the products of both sides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace relumine::scenes {

inline std::vector<glm::vec3> random_weights(std::size_t count, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> weight(-0.5f, 1.0f);
    std::vector<glm::vec3> weights(count);
    for (glm::vec3& value : weights)
        value = {weight(random), weight(random), weight(random)};
    return weights;
}

inline double inner(std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += glm::dot(glm::dvec3(a[i]), glm::dvec3(b[i]));
    return sum;
}

} // namespace relumine::scenes
