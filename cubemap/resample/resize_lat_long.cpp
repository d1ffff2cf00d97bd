#include "cubemap/resample/resize_lat_long.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "files/large_vector.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

/// The cells of one axis that each cell of another one overlaps, with their parts of it.
class AxisMeans {
public:
    struct Part {
        std::uint32_t source;
        double weight;
    };

    /// Borders ascend from 0 to 1. `place` carries places on the source's axis to the target's,
    /// linearly; ranges that leave 0..1 come in again at the other end. `measure(a, b)` is the
    /// weight of a range.
    template<typename Place, typename Measure>
    AxisMeans(const std::vector<double>& source, const std::vector<double>& target,
              const Place& place, const Measure& measure)
        : starts_(target.size(), 0) {
        std::vector<std::pair<std::uint32_t, Part>> parts;
        const auto add = [&](std::uint32_t cell, double begin, double end) {
            const auto after = std::upper_bound(target.begin(), target.end(), begin);
            auto i =
                static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(after - target.begin(), 1)) - 1;
            for (; i + 1 < target.size() && target[i] < end; ++i)
                if (const double weight =
                        measure(std::max(begin, target[i]), std::min(end, target[i + 1]));
                    weight > 0.0)
                    parts.push_back({i, {cell, weight}});
        };
        for (std::uint32_t cell = 0; cell + 1 < source.size(); ++cell) {
            auto [begin, end] = std::minmax({place(source[cell]), place(source[cell + 1])});
            const double turns = std::floor(begin);
            begin -= turns;
            end -= turns;
            add(cell, begin, std::min(end, 1.0));
            if (end > 1.0)
                add(cell, 0.0, end - 1.0);
        }
        std::stable_sort(parts.begin(), parts.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        std::vector<double> sums(target.size() - 1, 0.0);
        for (const auto& [cell, part] : parts) {
            ++starts_[cell + 1];
            sums[cell] += part.weight;
        }
        for (std::size_t i = 1; i < starts_.size(); ++i)
            starts_[i] += starts_[i - 1];
        for (const auto& [cell, part] : parts)
            parts_.push_back({part.source, part.weight / sums[cell]});
    }

    /// The parts of a target cell; their weights add up to 1.
    [[nodiscard]] std::span<const Part> of(std::size_t cell) const {
        return std::span(parts_).subspan(starts_[cell], starts_[cell + 1] - starts_[cell]);
    }

private:
    std::vector<std::size_t> starts_;
    std::vector<Part> parts_;
};

} // namespace

bool keeps_vertical(const glm::dmat3& turn) {
    constexpr double Rounding = 1e-12;
    return std::abs(std::abs(turn[1][1]) - 1.0) < Rounding;
}

struct LatLongResize::Tables {
    ImageShape source, target;
    AxisMeans columns, rows;
};

LatLongResize::LatLongResize(const ImageShape& source, const ImageShape& target,
                             const glm::dmat3& target_from_source) {
    constexpr double Pi = std::numbers::pi;
    // Longitude is 2 pi (1/2 - column), from +Z towards +X.
    const glm::dmat3& turn = target_from_source;
    const bool is_mirrored = turn[0][0] * turn[2][2] - turn[2][0] * turn[0][2] < 0.0;
    const double longitude = std::atan2(turn[2][0], turn[2][2]); // of what was at +Z
    const double offset = (is_mirrored ? 1.0 : 0.0) - longitude / (2.0 * Pi);
    AxisMeans columns(
        cell_borders(source.width, source.sampling), cell_borders(target.width, target.sampling),
        [&](double u) { return (is_mirrored ? -u : u) + offset; },
        [](double a, double b) { return b - a; });
    const bool is_turned_over = turn[1][1] < 0.0;
    AxisMeans rows(
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
