// Cube maps of functions of the direction.
#pragma once

#include <algorithm>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "files/parallel.h"

namespace relumine::data_gen {

/// Returns a cube map whose texels are means over num_sub(texel)^2 evenly spread directions,
/// weighted with their solid angles. One thread writes each row, so the result does not depend on
/// the number of threads.
template<typename Radiance, typename NumSub>
cubemap::CubeMap sampled(std::uint32_t resolution, const Radiance& radiance,
                         const NumSub& num_sub) {
    cubemap::CubeMap map(resolution);
    const double texel = 1.0 / resolution;
    files::parallel_for(std::uint32_t{0}, 6 * resolution, [&](std::uint32_t row) {
        const cubemap::Face face = cubemap::AllFaces[row / resolution];
        const std::uint32_t y = row % resolution;
        for (std::uint32_t x = 0; x < resolution; ++x) {
            const int n = num_sub(face, x * texel, y * texel, texel);
            glm::dvec3 sum(0.0);
            double weights = 0.0;
            for (int sample = 0; sample < n * n; ++sample) {
                const int column = sample % n;
                const int line = sample / n;
                const double s = (x + (column + 0.5) / n) * texel;
                const double t = (y + (line + 0.5) / n) * texel;
                const glm::dvec3 point = cubemap::cube_point(face, s, t);
                const double length = glm::length(point);
                const double weight = 1.0 / (length * length * length);
                sum += weight * radiance(point / length);
                weights += weight;
            }
            map.at(face, x, y) = glm::vec3(sum / weights);
        }
    });
    return map;
}

/// Returns enough samples for functions that are smooth over 1/512 of a face.
inline int num_smooth_samples(std::uint32_t resolution) {
    return std::clamp(static_cast<int>(512 / std::max(resolution, 1u)), 1, 16);
}

/// 0 below 0, 1 above 1, smooth between.
inline double smooth_step(double t) {
    const double c = std::clamp(t, 0.0, 1.0);
    return c * c * (3.0 - 2.0 * c);
}

} // namespace relumine::data_gen
