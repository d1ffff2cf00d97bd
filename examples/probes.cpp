// Probes for a moving object: a grid of points around a mesh, lit once, lights whatever moves
// through it.
//   probes MESH ENVIRONMENT OUTPUT.json
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <span>
#include <vector>

#include "relumine/relight/harmonics/harmonics.h"
#include "relumine/relumine.h"

using namespace relumine;

namespace {

constexpr std::size_t Count = 9; // order 3

/// The light at a place: that of the eight probes around it, by how near they are.
std::array<glm::vec3, Count> light_at(const prt::GridLayout& grid, std::span<const glm::vec3> light,
                                      const glm::vec3& place) {
    const std::array<std::uint32_t, 3> counts = {grid.nx, grid.ny, grid.nz};
    std::array<std::uint32_t, 3> low{};
    std::array<float, 3> part{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        const auto count = static_cast<float>(counts[i]);
        // Probes stand in the middles of their cells. Outside of the outermost ones theirs holds.
        const float at = std::clamp(
            (place[axis] - grid.low[axis]) / (grid.high[axis] - grid.low[axis]) * count - 0.5f,
            0.0f, count - 1.0f);
        low[i] = std::min(static_cast<std::uint32_t>(at), counts[i] - std::min(2u, counts[i]));
        part[i] = at - static_cast<float>(low[i]);
    }
    std::array<glm::vec3, Count> sum{};
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
        float weight = 1.0f;
        std::array<std::uint32_t, 3> cell{};
        for (std::size_t i = 0; i < 3; ++i) {
            const bool is_high = (corner >> i & 1u) != 0;
            cell[i] = std::min(low[i] + (is_high ? 1u : 0u), counts[i] - 1);
            weight *= is_high ? part[i] : 1.0f - part[i];
        }
        const std::size_t probe = (std::size_t{cell[2]} * grid.ny + cell[1]) * grid.nx + cell[0];
        for (std::size_t k = 0; k < Count; ++k)
            sum[k] += weight * light[probe * Count + k];
    }
    return sum;
}

int walk(const char* mesh, const char* environment, const char* output) {
    const mesh::Bounds box{.min = {-3.0f, 0.0f, -3.0f}, .max = {3.0f, 3.0f, 3.0f}};
    const PrecomputeOptions options{.receivers = Grid{.nx = 8, .ny = 4, .nz = 8, .box = box}};
    LitScene lit(precompute(load_mesh(mesh, {.floor_vertices = 33}), options), {.harmonics = 3});
    lit.light(load_environment(environment));
    save_harmonics(lit, output);

    // An object that moves needs no rays: nine coefficients a place, and a polynomial a normal.
    const std::vector<glm::vec3> light = lit.harmonics();
    const auto& grid = std::get<prt::GridLayout>(lit.scene().layout);
    for (int step = 0; step <= 6; ++step) {
        const glm::vec3 place(-2.4f + 0.8f * static_cast<float>(step), 0.6f, 1.2f);
        const std::array<glm::vec3, Count> here = light_at(grid, light, place);
        const glm::dvec3 up = relight::irradiance(here, {0.0f, 1.0f, 0.0f});
        const glm::dvec3 down = relight::irradiance(here, {0.0f, -1.0f, 0.0f});
        std::printf("at x = %+.1f: irradiance from above %.3f, from below %.3f\n",
                    static_cast<double>(place.x), up.g, down.g);
    }

    // At a probe's own place the light is the probe's.
    const std::size_t middle = (std::size_t{4} * grid.ny + 2) * grid.nx + 4;
    const std::array<glm::vec3, Count> own =
        light_at(grid, light, lit.scene().receivers.places()[middle]);
    const float error = std::abs(own[0].g - light[middle * Count].g);
    return error <= 1e-4f * light[middle * Count].g ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fprintf(stderr, "probes MESH ENVIRONMENT OUTPUT.json\n");
        return 2;
    }
    try {
        return walk(argv[1], argv[2], argv[3]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
