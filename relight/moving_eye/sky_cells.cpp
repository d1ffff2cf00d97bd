#include "relight/moving_eye/sky_cells.h"

#include <algorithm>
#include <bit>
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

/// Rounded up: what cells are judged by is no smaller than it is.
std::uint32_t upper_half(float value) {
    return (std::bit_cast<std::uint32_t>(value) + 0xffffu) >> 16u;
}

} // namespace

void SisterCells::set_direction(std::size_t i, const glm::vec3& direction) {
    at(X, i) = direction.x;
    at(Y, i) = direction.y;
    at(Z, i) = direction.z;
}
void SisterCells::set_light(std::size_t i, const glm::vec3& light) {
    at(Red, i) = light.r;
    at(Green, i) = light.g;
    at(Blue, i) = light.b;
}
void SisterCells::set_size(std::size_t i, float size) {
    size_and_contrast[i] = upper_half(size) << 16u | (size_and_contrast[i] & 0xffffu);
}
void SisterCells::set_contrast(std::size_t i, float contrast) {
    size_and_contrast[i] = (size_and_contrast[i] & 0xffff0000u) | upper_half(contrast);
}

bool SisterCells::is_alike(std::size_t i, const SisterCells& other) const {
    bool is_black = true, is_same = true;
    for (std::size_t row = 0; row < NumRows; ++row)
        is_same = is_same && rows[row * Stride + i] == other.rows[row * Stride + i];
    for (const Row color : {Red, Green, Blue})
        is_black =
            is_black && rows[color * Stride + i] == 0.0f && other.rows[color * Stride + i] == 0.0f;
    return is_black || (is_same && size_and_contrast[i] == other.size_and_contrast[i]);
}

SkyCells::SkyCells(std::uint32_t deepest_level)
    : deepest_level_(deepest_level), light_(deepest_level),
      sisters_(prt::num_cells_above(deepest_level)), changed_(sisters_.size()),
      solid_angles_(prt::num_cells_above(deepest_level + 1)) {
    files::parallel_for(
        files::IndexRange<std::size_t>(0, sisters_.size(), CellsPerTask / 4),
        [&](const auto& some) {
            for (std::size_t parent = some.begin(); parent < some.end(); ++parent)
                for (std::uint32_t i = 0; i < 4; ++i) {
                    const std::uint32_t index = first_child(static_cast<std::uint32_t>(parent)) + i;
                    const prt::Cell cell = prt::cell_of_index(index);
                    const double size = cell.size(), s = cell.x * size, t = cell.y * size;
                    const glm::vec3 middle = middle_of(cell);
                    sisters_[parent].set_direction(i, middle);
                    solid_angles_[index] =
                        static_cast<float>(cubemap::solid_angle(s, t, s + size, t + size));
                    sisters_[parent].set_size(i, std::sqrt(solid_angles_[index]));
                }
        });
    before_ = sisters_;
}

void SkyCells::set(const Relighter& relighter, std::span<const SharpLight> without) {
    if (relighter.binning() != nullptr && relighter.environment().resolution != 0)
        light_.set(relighter.environment(), *relighter.binning(), without);
    else
        light_.set_lights({});
    ++version_;
    std::swap(sisters_, before_);
    // Faces are always split, so nothing is kept of them.
    for (std::uint32_t level = deepest_level_; level > 0; --level)
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
        SisterCells& sisters = sisters_[(first + place - cubemap::NumFaces) / 4];
        const std::size_t i = place % 4;
        const float* rgb = light_.light().data() + 3 * (first + place);
        sisters.set_light(i, {rgb[0], rgb[1], rgb[2]});
        const double power = cubemap::luminance(glm::dvec3(rgb[0], rgb[1], rgb[2]));
        const double solid_angle{solid_angles_[first + place]};
        glm::dvec3 vector(0.0);
        double squares = 0.0;
        if (is_deepest) {
            // A square of evenly spread light has this variance, and so short a vector.
            vector = power * (1.0 - solid_angle / 12.0) *
                     glm::dvec3(sisters.at(SisterCells::X, i), sisters.at(SisterCells::Y, i),
                                sisters.at(SisterCells::Z, i));
            squares = power * power / solid_angle;
        } else {
            for (std::size_t child = 4 * place; child < 4 * place + 4; ++child) {
                vector += vectors_[child];
                squares += squares_[child];
            }
        }
        above_[place] = vector;
        squares_above_[place] = squares;
        const double length = glm::length(vector);
        if (!(power > 0.0 && length > 0.0))
            return;
        if (!is_deepest)
            sisters.set_direction(i, vector / length);
        sisters.at(SisterCells::Variance, i) =
            static_cast<float>(std::max(1.0 - length / power, 0.0));
        sisters.set_contrast(
            i, static_cast<float>(std::min(
                   std::sqrt(std::max(squares * solid_angle / (power * power) - 1.0, 0.0)), 1.0)));
    };
    files::parallel_for(
        files::IndexRange<std::size_t>(0, count / 4, CellsPerTask / 4), [&](const auto& some) {
            for (std::size_t group = some.begin(); group < some.end(); ++group) {
                const std::size_t parent = (first - cubemap::NumFaces) / 4 + group;
                for (std::size_t i = 0; i < 4; ++i)
                    set(4 * group + i);
                unsigned changed = 0;
                if (sisters_[parent] != before_[parent])
                    for (unsigned i = 0; i < 4; ++i)
                        changed |= sisters_[parent].is_alike(i, before_[parent]) ? 0 : 1u << i;
                changed_[parent] = static_cast<std::uint8_t>(changed);
            }
        });
    std::swap(vectors_, above_);
    std::swap(squares_, squares_above_);
}

} // namespace relumine::relight
