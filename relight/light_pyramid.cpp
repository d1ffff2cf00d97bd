#include "relight/light_pyramid.h"

#include <algorithm>
#include <array>

#include <glm/geometric.hpp>

#include "files/parallel.h"

namespace relumine::relight {

namespace {

constexpr std::size_t NumChannels = 3;

/// Rows of deepest cells of one task.
constexpr std::size_t RowsPerTask = 8;

/// Returns the sum of L dw over k x k texels.
glm::dvec3 sum_of_texels(const cubemap::CubeMap& environment, std::span<const double> solid_angles,
                         const prt::Cell& cell, std::uint32_t k) {
    const std::uint32_t r = environment.resolution;
    glm::dvec3 sum(0.0);
    for (std::uint32_t y = cell.y * k; y < (cell.y + 1) * k; ++y)
        for (std::uint32_t x = cell.x * k; x < (cell.x + 1) * k; ++x)
            sum +=
                glm::dvec3(environment.at(cell.face, x, y)) * solid_angles[std::size_t{y} * r + x];
    return sum;
}

} // namespace

LightPyramid::LightPyramid(std::uint32_t deepest_level)
    : deepest_level_(deepest_level),
      light_(std::size_t{prt::num_cells_above(deepest_level + 1)} * NumChannels) {}

void LightPyramid::set(const cubemap::CubeMap& environment, const LightBinning& binning,
                       std::span<const SharpLight> without) {
    set_deepest(environment, binning);
    for (const SharpLight& sharp : without)
        remove(sharp);
    sum_levels();
}

void LightPyramid::set_lights(std::span<const lights::DistantLight> lights) {
    std::fill(light_.begin(), light_.end(), 0.0f);
    const std::uint32_t n = 1u << deepest_level_;
    for (const lights::DistantLight& light : lights) {
        const cubemap::FacePoint point = cubemap::face_point(light.direction);
        const prt::Cell cell{.face = point.face,
                             .level = static_cast<std::uint8_t>(deepest_level_),
                             .x = std::min(static_cast<std::uint32_t>(point.s * n), n - 1),
                             .y = std::min(static_cast<std::uint32_t>(point.t * n), n - 1)};
        for (int channel = 0; channel < 3; ++channel)
            light_[std::size_t{prt::cell_index(cell)} * NumChannels +
                   static_cast<std::size_t>(channel)] +=
                static_cast<float>(light.irradiance[channel]);
    }
    sum_levels();
}

void LightPyramid::sum_levels() {
    // Children of a cell follow each other.
    for (std::uint32_t level = deepest_level_; level-- > 0;) {
        float* parents = light_.data() + std::size_t{prt::num_cells_above(level)} * NumChannels;
        const float* children =
            light_.data() + std::size_t{prt::num_cells_above(level + 1)} * NumChannels;
        const std::size_t num_parents =
            prt::num_cells_above(level + 1) - prt::num_cells_above(level);
        files::parallel_for(
            files::IndexRange<std::size_t>(0, num_parents, 4096), [&](const auto& some) {
                for (std::size_t i = some.begin() * NumChannels; i < some.end() * NumChannels;
                     ++i) {
                    const float* child =
                        children + i / NumChannels * (4 * NumChannels) + i % NumChannels;
                    parents[i] = (child[0] + child[3]) + (child[6] + child[9]);
                }
            });
    }
}

void LightPyramid::set_deepest(const cubemap::CubeMap& environment, const LightBinning& binning) {
    const std::uint32_t r = environment.resolution;
    const std::uint32_t n = 1u << deepest_level_;
    const std::uint32_t finer = std::max(r, n);
    const bool fits = finer % std::min(r, n) == 0;
    if (fits && resolution_ != finer) {
        solid_angles_ = cubemap::texel_solid_angles(finer);
        resolution_ = finer;
    }
    float* deepest =
        light_.data() + std::size_t{prt::num_cells_above(deepest_level_)} * NumChannels;
    const auto set_row = [&](std::size_t row) {
        prt::Cell cell{.face = cubemap::AllFaces[row / n],
                       .level = static_cast<std::uint8_t>(deepest_level_),
                       .y = static_cast<std::uint32_t>(row % n)};
        for (cell.x = 0; cell.x < n; ++cell.x) {
            glm::dvec3 light;
            if (fits && r >= n) {
                light = sum_of_texels(environment, solid_angles_, cell, r / n);
            } else if (fits) {
                light = glm::dvec3(environment.at(cell.face, cell.x / (n / r), cell.y / (n / r))) *
                        solid_angles_[std::size_t{cell.y} * n + cell.x];
            } else {
                // The vector of so small a cell is as long as its light is strong.
                const VectorIrradiance sum = binning.sum(environment, cell);
                light = {glm::length(sum.red), glm::length(sum.green), glm::length(sum.blue)};
            }
            float* place = deepest + std::size_t{prt::place_in_level(cell)} * NumChannels;
            for (int channel = 0; channel < 3; ++channel)
                place[channel] = static_cast<float>(light[channel]);
        }
    };
    files::parallel_for(
        files::IndexRange<std::size_t>(0, std::size_t{n} * cubemap::NumFaces, RowsPerTask),
        [&](const auto& rows) {
            for (std::size_t row = rows.begin(); row < rows.end(); ++row)
                set_row(row);
        });
}

/// Removes a sharp light, which is the whole light of its cell: the light of all deepest cells in
/// it, or a part of the deepest cell that holds it.
void LightPyramid::remove(const SharpLight& sharp) {
    float* deepest =
        light_.data() + std::size_t{prt::num_cells_above(deepest_level_)} * NumChannels;
    if (sharp.cell.level <= deepest_level_) {
        const std::uint32_t shift = 2u * (deepest_level_ - sharp.cell.level);
        const std::size_t first = std::size_t{prt::place_in_level(sharp.cell)} << shift;
        std::fill_n(deepest + first * NumChannels, (std::size_t{1} << shift) * NumChannels, 0.0f);
        return;
    }
    const std::size_t place =
        prt::place_in_level(sharp.cell) >> 2u * (sharp.cell.level - deepest_level_);
    const std::array<const glm::dvec3*, NumChannels> vectors = {
        &sharp.irradiance.red, &sharp.irradiance.green, &sharp.irradiance.blue};
    for (std::size_t channel = 0; channel < NumChannels; ++channel) {
        float& light = deepest[place * NumChannels + channel];
        light = static_cast<float>(
            std::max(0.0, static_cast<double>(light) - glm::length(*vectors[channel])));
    }
}

} // namespace relumine::relight
