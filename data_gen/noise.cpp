#include "data_gen/noise.h"

#include <array>
#include <cmath>

namespace relumine::data_gen {
namespace {

// Integer finaliser in the manner of MurmurHash3. Every input bit changes about half of the output
// bits.
std::uint32_t mixed(std::uint32_t value) {
    value ^= value >> 16;
    value *= 0x85ebca6bU;
    value ^= value >> 13;
    value *= 0xc2b2ae35U;
    return value ^ (value >> 16);
}

std::uint32_t lattice_hash(const glm::ivec3& point, std::uint32_t seed) {
    std::uint32_t hash = mixed(seed + 0x9e3779b9U);
    for (int axis = 0; axis < 3; ++axis) {
        hash = mixed(hash ^ static_cast<std::uint32_t>(point[axis]));
    }
    return hash;
}

// Dot product with one of the twelve directions to the middle of a cube's edges. Four of them occur
// twice.
double gradient_dot(std::uint32_t hash, const glm::dvec3& offset) {
    static constexpr std::array<std::array<int, 3>, 16> Gradients = {{{1, 1, 0},
                                                                      {-1, 1, 0},
                                                                      {1, -1, 0},
                                                                      {-1, -1, 0},
                                                                      {1, 0, 1},
                                                                      {-1, 0, 1},
                                                                      {1, 0, -1},
                                                                      {-1, 0, -1},
                                                                      {0, 1, 1},
                                                                      {0, -1, 1},
                                                                      {0, 1, -1},
                                                                      {0, -1, -1},
                                                                      {1, 1, 0},
                                                                      {-1, 1, 0},
                                                                      {0, -1, 1},
                                                                      {0, -1, -1}}};
    const auto& gradient = Gradients[hash & 15U];
    return gradient[0] * offset.x + gradient[1] * offset.y + gradient[2] * offset.z;
}

double faded(double t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

} // namespace

double gradient_noise(const glm::dvec3& point, std::uint32_t seed) {
    const glm::dvec3 corner(std::floor(point.x), std::floor(point.y), std::floor(point.z));
    const glm::ivec3 cell(corner);
    const glm::dvec3 local = point - corner;
    double sum = 0.0;
    for (int k = 0; k < 8; ++k) {
        const glm::ivec3 step(k & 1, (k >> 1) & 1, k >> 2);
        double weight = 1.0;
        for (int axis = 0; axis < 3; ++axis) {
            const double fade = faded(local[axis]);
            weight *= step[axis] == 1 ? fade : 1.0 - fade;
        }
        sum += weight * gradient_dot(lattice_hash(cell + step, seed), local - glm::dvec3(step));
    }
    return sum;
}

double fractal_noise(const glm::dvec3& point, const FractalOptions& options) {
    double sum = 0.0;
    double amplitude = 1.0;
    glm::dvec3 p = point;
    for (int octave = 0; octave < options.num_octaves; ++octave) {
        sum += amplitude * gradient_noise(p, options.seed + static_cast<std::uint32_t>(octave));
        amplitude *= options.gain;
        // The shift keeps lattice points of different octaves apart, where the noise is zero.
        p = 2.0 * p + glm::dvec3(0.37, 0.61, 0.23);
    }
    return sum;
}

} // namespace relumine::data_gen
