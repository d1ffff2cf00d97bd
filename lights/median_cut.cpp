#include "lights/median_cut.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lights/region_cuts.h"
#include "lights/summed_area_table.h"

namespace relumine::lights {

namespace {

class EnergyTable {
public:
    explicit EnergyTable(const LatLongGrid& grid)
        : grid_(grid), table_(grid.width(), grid.height(), [&](std::uint32_t y, double* row) {
              for (std::uint32_t x = 0; x < grid.width(); ++x)
                  row[x] = grid.energy(x, y);
          }) {}

    [[nodiscard]] double energy(const PixelRectangle& region) const {
        return std::max(table_.sum(region), 0.0);
    }

    /// [D05] step 2: cuts along the longest dimension and divides the energy evenly.
    [[nodiscard]] Halves cut(const PixelRectangle& region) const {
        const double whole = energy(region);
        if (whole <= 0.0)
            return cut_in_the_middle(grid_, region);
        const bool at_column = is_cut_at_column(grid_, region);
        const auto halves = [&](std::uint32_t at) {
            return at_column ? cut_at_column(region, at) : cut_at_row(region, at);
        };
        // Finds the first cut with half of the energy or more before it. The energy before a cut
        // grows with its position.
        std::uint32_t first = (at_column ? region.x0 : region.y0) + 1;
        std::uint32_t last = (at_column ? region.x1 : region.y1) - 1;
        const std::uint32_t lowest = first;
        while (first < last) {
            const std::uint32_t middle = first + (last - first) / 2;
            if (2.0 * energy(halves(middle).first) >= whole)
                last = middle;
            else
                first = middle + 1;
        }
        // This cut or the one before, whichever divides more evenly.
        const auto imbalance = [&](std::uint32_t at) {
            return std::abs(2.0 * energy(halves(at).first) - whole);
        };
        if (first > lowest && imbalance(first - 1) < imbalance(first))
            --first;
        return halves(first);
    }

private:
    const LatLongGrid& grid_;
    SummedAreaTable<double> table_;
};

} // namespace

std::vector<PixelRectangle> median_cut(const LatLongGrid& grid, std::size_t num_regions) {
    const EnergyTable table(grid);
    std::vector<PixelRectangle> regions = {grid.whole()}; // step 1
    const auto cut = [&](const PixelRectangle& region) {
        return table.cut(region);
    };
    if (std::has_single_bit(num_regions)) {
        for (int round = std::countr_zero(num_regions); round > 0; --round) { // step 3
            std::vector<PixelRectangle> next;
            for (const PixelRectangle& region : regions) {
                if (region.width() == 1 && region.height() == 1) {
                    next.push_back(region);
                    continue;
                }
                const Halves halves = cut(region);
                next.push_back(halves.first);
                next.push_back(halves.second);
            }
            regions = std::move(next);
        }
    }
    cut_heaviest(
        grid, regions, num_regions,
        [&](const PixelRectangle& region) { return table.energy(region); }, cut);
    return regions;
}

} // namespace relumine::lights
