#include "relight/moving_eye/sky_cells.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "cubemap/face.h"
#include "cubemap/luminance.h"
#include "files/parallel.h"

namespace relumine::relight {

namespace {

constexpr std::size_t CellsPerTask = 4096;

glm::dvec3 middle_of(const prt::Cell& cell) {
    const double size = cell.size();
    return cubemap::direction(cell.face, (cell.x + 0.5) * size, (cell.y + 0.5) * size);
}

} // namespace

SkyCells::SkyCells(std::uint32_t deepest_level)
    : deepest_level_(deepest_level), light_(deepest_level),
      cells_(prt::num_cells_above(deepest_level + 1)) {
    files::parallel_for(
        files::IndexRange<std::size_t>(0, cells_.size(), CellsPerTask), [&](const auto& some) {
            for (std::size_t i = some.begin(); i < some.end(); ++i) {
                const prt::Cell cell = prt::cell_of_index(static_cast<std::uint32_t>(i));
                const double size = cell.size(), s = cell.x * size, t = cell.y * size;
                cells_[i].direction = middle_of(cell);
                cells_[i].size =
                    static_cast<float>(std::sqrt(cubemap::solid_angle(s, t, s + size, t + size)));
            }
        });
}

void SkyCells::set(const Relighter& relighter, std::span<const SharpLight> without) {
    if (relighter.binning() != nullptr && relighter.environment().resolution != 0)
        light_.set(relighter.environment(), *relighter.binning(), without);
    else
        light_.set_lights({});
    for (std::uint32_t level = deepest_level_ + 1; level-- > 0;)
        set_level(level);
}

/// Sets the cells of a level from those below it, or from their light where there are none.
void SkyCells::set_level(std::uint32_t level) {
    const std::size_t first = prt::num_cells_above(level);
    const std::size_t count = prt::num_cells_above(level + 1) - first;
    const bool is_deepest = level == deepest_level_;
    above_.resize(count);
    squares_above_.resize(count);
    const auto set = [&](std::size_t place) {
        SkyCell& cell = cells_[first + place];
        const float* rgb = light().data() + 3 * (first + place);
        const double power = cubemap::luminance(glm::dvec3(rgb[0], rgb[1], rgb[2]));
        const double solid_angle = double{cell.size} * double{cell.size};
        glm::dvec3 vector(0.0);
        double squares = 0.0;
        if (is_deepest) {
            // A square of evenly spread light has this variance, and so short a vector.
            vector = power * (1.0 - solid_angle / 12.0) * glm::dvec3(cell.direction);
            squares = power * power / solid_angle;
        } else {
            for (std::size_t i = 4 * place; i < 4 * place + 4; ++i) {
                vector += vectors_[i];
                squares += squares_[i];
            }
        }
        above_[place] = vector;
        squares_above_[place] = squares;
        cell.power = static_cast<float>(power);
        const double length = glm::length(vector);
        if (!(power > 0.0 && length > 0.0))
            return;
        if (!is_deepest)
            cell.direction = vector / length;
        cell.variance = static_cast<float>(std::max(1.0 - length / power, 0.0));
        cell.contrast = static_cast<float>(
            std::sqrt(std::max(squares * solid_angle / (power * power) - 1.0, 0.0)));
    };
    files::parallel_for(files::IndexRange<std::size_t>(0, count, CellsPerTask),
                        [&](const auto& some) {
                            for (std::size_t place = some.begin(); place < some.end(); ++place)
                                set(place);
                        });
    std::swap(vectors_, above_);
    std::swap(squares_, squares_above_);
}

} // namespace relumine::relight
