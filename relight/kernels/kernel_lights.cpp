#include "relight/kernels/kernel_lights.h"

#include <algorithm>
#include <numbers>

#include <glm/geometric.hpp>

namespace relumine::relight {

ClusterLights::ClusterLights(std::size_t num_clusters)
    : vectors(num_clusters * Stride), directionals(num_clusters * DirectionalStride),
      spread((num_clusters + 63) / 64), prefix((spread.size() * 64 + 1) * Stride) {}

void ClusterLights::set(std::size_t cluster, const VectorIrradiance& irradiance) {
    constexpr double Scale = 1.0 / (16.0 * std::numbers::pi);
    const std::array<glm::vec3, 3> channels = {glm::vec3(irradiance.red * Scale),
                                               glm::vec3(irradiance.green * Scale),
                                               glm::vec3(irradiance.blue * Scale)};
    float* vector = vectors.data() + cluster * Stride;
    float* directional = directionals.data() + cluster * DirectionalStride;
    for (const glm::vec3& channel : channels)
        for (int axis = 0; axis < 3; ++axis)
            *vector++ = channel[axis];

    const glm::dvec3 luminance = irradiance.luminance();
    const double length = glm::length(luminance);
    const glm::vec3 direction = length > 0.0 ? glm::vec3(luminance / length) : glm::vec3(0.0f);
    const double per_square =
        length > 0.0 ? 1.0 / glm::dot(glm::dvec3(direction), glm::dvec3(direction)) : 0.0;
    double off = 0.0, all = 0.0;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 channel(channels[static_cast<std::size_t>(i)]);
        const double colour = glm::dot(channel, glm::dvec3(direction)) * per_square;
        const glm::dvec3 rest = channel - colour * glm::dvec3(direction);
        off += glm::dot(rest, rest);
        all += glm::dot(channel, channel);
        directional[i] = direction[i];
        directional[3 + i] = static_cast<float>(colour);
    }
    const std::uint64_t bit = std::uint64_t{1} << (cluster % 64);
    if (off > DirectionalTolerance * DirectionalTolerance * all)
        spread[cluster / 64] |= bit;
    else
        spread[cluster / 64] &= ~bit;
}

void ClusterLights::sum_prefix() {
    for (std::size_t i = 0; i < vectors.size(); ++i)
        prefix[i + Stride] = prefix[i] + static_cast<double>(vectors[i]);
}

void LightChanges::clear() {
    words.clear();
    vectors.clear();
    directionals_before.resize(1);
    directionals.clear();
}

void LightChanges::set(ClusterLights& lights, std::size_t cluster,
                       const VectorIrradiance& irradiance) {
    struct Light {
        std::array<float, ClusterLights::Stride> vector;
        std::array<float, ClusterLights::DirectionalStride> directional;
        bool is_spread;
        bool operator==(const Light&) const = default;

        Light(const ClusterLights& all, std::size_t c) : is_spread(all.is_spread(c)) {
            std::copy_n(all.vectors.begin() + static_cast<std::ptrdiff_t>(c * vector.size()),
                        vector.size(), vector.begin());
            std::copy_n(all.directionals.begin() +
                            static_cast<std::ptrdiff_t>(c * directional.size()),
                        directional.size(), directional.begin());
        }
    };
    const Light before(lights, cluster);
    lights.set(cluster, irradiance);
    const Light after(lights, cluster);
    if (before == after)
        return;

    if (words.empty() || words.back().word != cluster / 64)
        words.push_back({.word = static_cast<std::uint32_t>(cluster / 64),
                         .first = static_cast<std::uint32_t>(vectors.size())});
    words.back().clusters |= std::uint64_t{1} << (cluster % 64);
    std::array<double, ClusterLights::Stride>& change = vectors.emplace_back();
    for (std::size_t i = 0; i < change.size(); ++i) {
        change[i] = static_cast<double>(after.vector[i]) - static_cast<double>(before.vector[i]);
        words.back().vector[i] += change[i];
    }

    const auto add = [&](const Light& light, double sign) {
        const auto& v = light.vector;
        if (light.is_spread) {
            directionals.push_back({.direction = {v[0], v[1], v[2]}, .colour = {sign, 0.0, 0.0}});
            directionals.push_back({.direction = {v[3], v[4], v[5]}, .colour = {0.0, sign, 0.0}});
            directionals.push_back({.direction = {v[6], v[7], v[8]}, .colour = {0.0, 0.0, sign}});
        } else {
            directionals.push_back(
                {.direction = {light.directional[0], light.directional[1], light.directional[2]},
                 .colour = {sign * static_cast<double>(light.directional[3]),
                            sign * static_cast<double>(light.directional[4]),
                            sign * static_cast<double>(light.directional[5])}});
        }
    };
    add(before, -1.0);
    add(after, 1.0);
    // One directional light instead of two where only the colour changes.
    DirectionalChange& last = directionals.back();
    if (!before.is_spread && !after.is_spread &&
        directionals.end()[-2].direction == last.direction) {
        for (std::size_t i = 0; i < 3; ++i)
            last.colour[i] += directionals.end()[-2].colour[i];
        directionals.erase(directionals.end() - 2);
    }
    directionals_before.push_back(static_cast<std::uint32_t>(directionals.size()));
}

} // namespace relumine::relight
