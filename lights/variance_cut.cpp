#include "lights/variance_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "lights/region_cuts.h"
#include "lights/summed_area_table.h"

namespace relumine::lights {

namespace {

/// Returns M0 - |M1|^2 / M0, and 0 where rounding makes it negative.
double variance(const glm::dvec4& moments) {
    const glm::dvec3 first(moments);
    return moments.w > 0.0 ? std::max(moments.w - glm::dot(first, first) / moments.w, 0.0) : 0.0;
}

class MomentTable {
public:
    explicit MomentTable(const LatLongGrid& grid)
        : grid_(grid), table_(grid.width(), grid.height(), [&](std::uint32_t y, glm::dvec4* row) {
              for (std::uint32_t x = 0; x < grid.width(); ++x)
                  row[x] = luminance(grid.radiance(x, y)) * grid.moments(x, y);
          }) {}

    /// Returns E^1.5 d = E sqrt(variance).
    [[nodiscard]] double weight(const PixelRectangle& region) const {
        const glm::dvec4 moments = table_.sum(region);
        return std::max(moments.w, 0.0) * std::sqrt(variance(moments));
    }

    [[nodiscard]] Halves cut(const PixelRectangle& region) const {
        const glm::dvec4 whole = table_.sum(region);
        if (variance(whole) <= 0.0)
            return cut_in_the_middle(grid_, region);
        double smallest = std::numeric_limits<double>::infinity();
        Halves best;
        const auto consider = [&](const Halves& halves) {
            const glm::dvec4 before = table_.sum(halves.first);
            const double sum = variance(before) + variance(whole - before);
            if (sum < smallest) {
                smallest = sum;
                best = halves;
            }
        };
        for (std::uint32_t at = region.x0 + 1; at < region.x1; ++at)
            consider(cut_at_column(region, at));
        for (std::uint32_t at = region.y0 + 1; at < region.y1; ++at)
            consider(cut_at_row(region, at));
        return best;
    }

private:
    const LatLongGrid& grid_;
    SummedAreaTable<glm::dvec4> table_;
};

} // namespace

std::vector<PixelRectangle> variance_cut(const LatLongGrid& grid, std::size_t num_regions) {
    const MomentTable table(grid);
    std::vector<PixelRectangle> regions = {grid.whole()};
    cut_heaviest(
        grid, regions, num_regions,
        [&](const PixelRectangle& region) { return table.weight(region); },
        [&](const PixelRectangle& region) { return table.cut(region); });
    return regions;
}

} // namespace relumine::lights
