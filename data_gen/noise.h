// Noise that is the same on every machine and in every run.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

namespace relumine::data_gen {

/// Returns gradient noise, roughly in [-1, 1]. It is zero at integer points and twice continuously
/// differentiable; its features are about 1 wide.
/// Based on: Perlin, "Improving noise", 2002, with an integer hash in place of the table.
[[nodiscard]] double gradient_noise(const glm::dvec3& point, std::uint32_t seed = 0);

/// The octaves of fractal_noise().
struct FractalOptions {
    int num_octaves = 6;
    /// Strength of an octave over the strength of the octave before.
    double gain = 0.5;
    std::uint32_t seed = 0;
};

/// Returns a sum of octaves of gradient noise. Each octave is twice as fine as the one before; the
/// first has strength 1.
[[nodiscard]] double fractal_noise(const glm::dvec3& point, const FractalOptions& options = {});

} // namespace relumine::data_gen
