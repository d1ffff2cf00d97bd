#include "cubemap/resample/resize_lat_long.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/resample/axis_means.h"
#include "files/large_vector.h"
#include "files/parallel.h"

namespace relumine::cubemap {

bool keeps_vertical(const glm::dmat3& turn) {
    constexpr double Rounding = 1e-12;
    return std::abs(std::abs(turn[1][1]) - 1.0) < Rounding;
}

struct LatLongResize::Tables {
    ImageShape source, target;
    detail::AxisMeans columns, rows;
};

LatLongResize::LatLongResize(const ImageShape& source, const ImageShape& target,
                             const glm::dmat3& target_from_source) {
    constexpr double Pi = std::numbers::pi;
    // Longitude is 2 pi (1/2 - column), from +Z towards +X.
    const glm::dmat3& turn = target_from_source;
    const bool is_mirrored = turn[0][0] * turn[2][2] - turn[2][0] * turn[0][2] < 0.0;
    const double longitude = std::atan2(turn[2][0], turn[2][2]); // of what was at +Z
    const double offset = (is_mirrored ? 1.0 : 0.0) - longitude / (2.0 * Pi);
    detail::AxisMeans columns(
        cell_borders(source.width, source.sampling), cell_borders(target.width, target.sampling),
        [&](double u) { return (is_mirrored ? -u : u) + offset; },
        [](double a, double b) { return b - a; });
    const bool is_turned_over = turn[1][1] < 0.0;
    detail::AxisMeans rows(
        cell_borders(source.height, source.sampling), cell_borders(target.height, target.sampling),
        [&](double v) { return is_turned_over ? 1.0 - v : v; },
        [](double a, double b) { return std::cos(Pi * a) - std::cos(Pi * b); });
    tables_ = std::make_unique<Tables>(Tables{source, target, std::move(columns), std::move(rows)});
    wide_ = files::large_vector<glm::vec3>(std::size_t{target.width} * source.height);
}
LatLongResize::~LatLongResize() = default;

void LatLongResize::average(std::span<const glm::vec3> from, std::vector<glm::vec3>& to) {
    const std::size_t source_width = tables_->source.width, width = tables_->target.width;
    files::parallel_for(std::uint32_t{0}, tables_->source.height, [&](std::uint32_t y) {
        const glm::vec3* const row = from.data() + y * source_width;
        for (std::size_t x = 0; x < width; ++x) {
            glm::dvec3 sum(0.0);
            for (const auto& [column, weight] : tables_->columns.of(x))
                sum += weight * glm::dvec3(row[column]);
            wide_[y * width + x] = glm::vec3(sum);
        }
    });
    to.resize(width * tables_->target.height);
    files::parallel_for(std::uint32_t{0}, tables_->target.height, [&](std::uint32_t y) {
        std::vector<glm::dvec3> sums(width, glm::dvec3(0.0));
        for (const auto& [row, weight] : tables_->rows.of(y))
            for (std::size_t x = 0; x < width; ++x)
                sums[x] += weight * glm::dvec3(wide_[row * width + x]);
        for (std::size_t x = 0; x < width; ++x)
            to[y * width + x] = glm::vec3(sums[x]);
    });
}

} // namespace relumine::cubemap
