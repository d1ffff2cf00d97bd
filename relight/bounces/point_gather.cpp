#include "relight/bounces/point_gather.h"

#include <algorithm>
#include <numbers>

#include "files/parallel.h"

namespace relumine::relight {

PointBasis::PointBasis(const prt::PointRows& rows) : rows_(rows) {
    values_.reserve(rows.num_directions);
    for (const glm::dvec3& direction : prt::even_directions(rows.num_directions)) {
        const std::array<double, MaxHarmonics> basis = harmonics(direction);
        std::array<float, MaxHarmonics>& values = values_.emplace_back();
        for (std::size_t k = 0; k < MaxHarmonics; ++k)
            values[k] = static_cast<float>(basis[k] * 4.0 * std::numbers::pi / rows.num_directions);
    }
}

std::vector<glm::vec3> PointBasis::gathered(std::span<const PaddedRgb> sent,
                                            std::uint32_t order) const {
    const std::size_t width = num_harmonics(order);
    std::vector<glm::vec3> result(rows_.num_points() * width);
    files::parallel_for(std::size_t{0}, rows_.num_points(), [&](std::size_t point) {
        std::array<glm::vec3, MaxHarmonics> sums{};
        const std::uint32_t* emitters = rows_.emitters.data() + point * rows_.num_directions;
        for (std::size_t i = 0; i < rows_.num_directions; ++i) {
            if (emitters[i] == prt::NoEmitter)
                continue;
            const PaddedRgb& light = sent[emitters[i]];
            const glm::vec3 rgb(light.rgb[0], light.rgb[1], light.rgb[2]);
            for (std::size_t k = 0; k < width; ++k)
                sums[k] += values_[i][k] * rgb;
        }
        std::copy_n(sums.begin(), width,
                    result.begin() + static_cast<std::ptrdiff_t>(point * width));
    });
    return result;
}

void PointBasis::scatter(std::span<const glm::dvec3> weights, std::uint32_t order,
                         std::span<glm::dvec3> by_sent) const {
    const std::size_t width = num_harmonics(order);
    for (std::size_t point = 0; point < rows_.num_points(); ++point) {
        const std::span<const glm::dvec3> own = weights.subspan(point * width, width);
        const std::uint32_t* emitters = rows_.emitters.data() + point * rows_.num_directions;
        for (std::size_t i = 0; i < rows_.num_directions; ++i) {
            if (emitters[i] == prt::NoEmitter)
                continue;
            for (std::size_t k = 0; k < width; ++k)
                by_sent[emitters[i]] += static_cast<double>(values_[i][k]) * own[k];
        }
    }
}

} // namespace relumine::relight
