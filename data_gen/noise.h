// Noise that is the same everywhere and always.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

namespace relumine::data_gen {

/// Gradient noise, roughly in [-1, 1], zero at integer points, features about 1 wide, twice
/// continuously differentiable. Based on: Perlin, "Improving noise", 2002, with an integer hash in
/// place of the table.
[[nodiscard]] double gradient_noise(const glm::dvec3& point, std::uint32_t seed = 0);

struct FractalOptions {
    int num_octaves = 6;
    /// Strength of an octave, times that of the one before
    double gain = 0.5;
    std::uint32_t seed = 0;
};

/// Sum of octaves of gradient noise, each twice as fine as the one before; the first has
/// strength 1.
[[nodiscard]] double fractal_noise(const glm::dvec3& point, const FractalOptions& options = {});

} // namespace relumine::data_gen
