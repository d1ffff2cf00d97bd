#include "lights/importance_sampling.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "cubemap/split_mix64.h"
#include "files/parallel.h"

namespace relumine::lights {

namespace {

/// Returns a number in [0, 1) that depends on its arguments only, so it is the same on every
/// machine. Mixing twice keeps the neighbouring indices of one seed apart from the indices of the
/// next.
double random(std::uint64_t seed, std::uint64_t index) {
    const std::uint64_t mixed =
        cubemap::SplitMix64(seed * cubemap::SplitMix64::Step + index).next();
    return cubemap::unit_interval(cubemap::SplitMix64(mixed).next());
}

/// The distribution of the directions: by energy, or by solid angle for a map without light.
class Distribution {
public:
    explicit Distribution(const LatLongGrid& grid)
        : grid_(grid), marginal_(grid.height() + 1, 0.0) {
        sum_rows();
        if (marginal_.back() <= 0.0) {
            is_black_ = true;
            sum_rows();
        }
    }

    [[nodiscard]] double weight(std::uint32_t x, std::uint32_t y) const {
        return is_black_ ? grid_.solid_angle(x, y) : grid_.energy(x, y);
    }
    /// [height + 1] sums over the rows above.
    [[nodiscard]] const std::vector<double>& marginal() const { return marginal_; }

    /// Returns the sum of the row's weights, always added from left to right.
    [[nodiscard]] double row_sum(std::uint32_t y) const {
        double sum = 0.0;
        for (std::uint32_t x = 0; x < grid_.width(); ++x)
            sum += weight(x, y);
        return sum;
    }

    struct Place {
        glm::dvec3 direction{0.0};
        /// Radiance of the pixel.
        glm::dvec3 radiance{0.0};
    };

    /// Returns the place at a share `down` of the marginal sum and a share `across` of the
    /// conditional sum.
    [[nodiscard]] Place place(double down, double across) const {
        const double wanted_down = down * marginal_.back();
        // The last row with light that begins at or before the wanted sum.
        auto row = std::upper_bound(marginal_.begin(), marginal_.end(), wanted_down) - 1;
        if (row == marginal_.end() - 1) // rounding went beyond the last row
            row = std::lower_bound(marginal_.begin(), marginal_.end(), marginal_.back()) - 1;
        const auto y = static_cast<std::uint32_t>(row - marginal_.begin());
        const double part_down = std::clamp((wanted_down - row[0]) / (row[1] - row[0]), 0.0, 1.0);

        const double wanted = across * row_sum(y);
        double before = 0.0;
        std::uint32_t column = 0;
        double part_across = 0.5;
        for (std::uint32_t x = 0; x < grid_.width(); ++x) {
            const double value = weight(x, y);
            if (value > 0.0) {
                column = x;
                part_across = std::clamp((wanted - before) / value, 0.0, 1.0);
            }
            before += value;
            if (wanted < before)
                break;
        }
        return {grid_.direction(column, y, part_across, part_down), grid_.radiance(column, y)};
    }

private:
    void sum_rows() {
        std::vector<double> rows(grid_.height());
        files::parallel_for(std::uint32_t{0}, grid_.height(),
                            [&](std::uint32_t y) { rows[y] = row_sum(y); });
        for (std::size_t y = 0; y < rows.size(); ++y)
            marginal_[y + 1] = marginal_[y] + rows[y];
    }

    const LatLongGrid& grid_;
    bool is_black_ = false;
    std::vector<double> marginal_;
};

/// Adds the share `down` of an image row to a row of strata. Each stratum gets an equal part of the
/// conditional sum.
void share_row(const LatLongGrid& grid, const Distribution& distribution, std::uint32_t y,
               double down, std::span<ImportanceSample> strata) {
    const double sum = distribution.row_sum(y);
    const std::size_t num_strata = strata.size();
    const auto border = [&](std::size_t stratum) {
        return sum * static_cast<double>(stratum) / static_cast<double>(num_strata);
    };
    std::size_t stratum = 0;
    double before = 0.0;
    for (std::uint32_t x = 0; x < grid.width(); ++x) {
        const double weight = distribution.weight(x, y);
        if (weight <= 0.0)
            continue;
        const glm::dvec3 irradiance = grid.radiance(x, y) * grid.solid_angle(x, y);
        const double after = before + weight;
        double from = before;
        // Parts of the pixel's share end at the borders of strata. The last stratum has no border.
        while (stratum + 1 < num_strata && border(stratum + 1) < after) {
            const double part = down * (std::max(border(stratum + 1), from) - from) / weight;
            strata[stratum].light.irradiance += part * irradiance;
            strata[stratum].light.solid_angle += part * grid.solid_angle(x, y);
            from = std::max(border(stratum + 1), from);
            ++stratum;
        }
        const double part = down * (after - from) / weight;
        strata[stratum].light.irradiance += part * irradiance;
        strata[stratum].light.solid_angle += part * grid.solid_angle(x, y);
        before = after;
    }
}

} // namespace

std::vector<ImportanceSample> importance_samples(const LatLongGrid& grid, std::size_t num_lights,
                                                 std::uint64_t seed) {
    const Distribution distribution(grid);
    const std::vector<double>& marginal = distribution.marginal();
    // The image is twice as wide as high. With this number of rows, strata are about square where
    // the distribution is even.
    const auto num_rows = std::clamp(
        static_cast<std::size_t>(std::lround(std::sqrt(0.5 * static_cast<double>(num_lights)))),
        std::size_t{1}, num_lights);
    const auto first_of_row = [&](std::size_t row) {
        return row * num_lights / num_rows;
    };
    std::vector<ImportanceSample> samples(num_lights);
    files::parallel_for(std::size_t{0}, num_rows, [&](std::size_t row) {
        const std::size_t first = first_of_row(row);
        const std::size_t num_strata = first_of_row(row + 1) - first;
        const double top = static_cast<double>(first) / static_cast<double>(num_lights);
        const double bottom =
            static_cast<double>(first + num_strata) / static_cast<double>(num_lights);
        const double top_sum = top * marginal.back();
        const double bottom_sum = row + 1 < num_rows ? bottom * marginal.back() : marginal.back();
        for (std::uint32_t y = 0; y < grid.height(); ++y) {
            const double part =
                std::min(marginal[y + 1], bottom_sum) - std::max(marginal[y], top_sum);
            if (part > 0.0)
                share_row(grid, distribution, y, part / (marginal[y + 1] - marginal[y]),
                          std::span(samples).subspan(first, num_strata));
        }
        for (std::size_t i = 0; i < num_strata; ++i) {
            const double down = top + (bottom - top) * random(seed, 2 * (first + i));
            const double across = (static_cast<double>(i) + random(seed, 2 * (first + i) + 1)) /
                                  static_cast<double>(num_strata);
            const Distribution::Place place = distribution.place(down, across);
            samples[first + i].light.direction = place.direction;
            samples[first + i].luminance = luminance(place.radiance);
        }
    });
    return samples;
}

std::vector<ImportanceSample> independent_samples(const LatLongGrid& grid, std::size_t num_lights,
                                                  std::uint64_t seed) {
    const Distribution distribution(grid);
    const double share = distribution.marginal().back() / static_cast<double>(num_lights);
    std::vector<ImportanceSample> samples(num_lights);
    files::parallel_for(std::size_t{0}, num_lights, [&](std::size_t i) {
        const Distribution::Place place =
            distribution.place(random(seed, 2 * i), random(seed, 2 * i + 1));
        ImportanceSample& sample = samples[i];
        sample.light.direction = place.direction;
        sample.luminance = luminance(place.radiance);
        if (sample.luminance > 0.0) { // the density is luminance over its integral
            sample.light.solid_angle = share / sample.luminance;
            sample.light.irradiance = place.radiance * sample.light.solid_angle;
        }
    });
    return samples;
}

std::vector<DistantLight> importance_sample(const LatLongGrid& grid, std::size_t num_lights,
                                            std::uint64_t seed) {
    std::vector<DistantLight> lights;
    lights.reserve(num_lights);
    for (const ImportanceSample& sample : importance_samples(grid, num_lights, seed))
        lights.push_back(sample.light);
    return lights;
}

} // namespace relumine::lights
