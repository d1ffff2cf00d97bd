#include "lights/region_cuts.h"

#include <glm/geometric.hpp>

#include "files/parallel.h"

namespace relumine::lights {

Halves cut_at_column(const PixelRectangle& region, std::uint32_t at) {
    return {{region.x0, region.y0, at, region.y1}, {at, region.y0, region.x1, region.y1}};
}

Halves cut_at_row(const PixelRectangle& region, std::uint32_t at) {
    return {{region.x0, region.y0, region.x1, at}, {region.x0, at, region.x1, region.y1}};
}

bool is_cut_at_column(const LatLongGrid& grid, const PixelRectangle& region) {
    if (region.width() == 1 || region.height() == 1)
        return region.width() > 1;
    return grid.angular_width(region) >= grid.angular_height(region);
}

Halves cut_in_the_middle(const LatLongGrid& grid, const PixelRectangle& region) {
    if (is_cut_at_column(grid, region))
        return cut_at_column(region, region.x0 + region.width() / 2);
    return cut_at_row(region, region.y0 + region.height() / 2);
}

namespace {

DistantLight light_of(const LatLongGrid& grid, const PixelRectangle& region) {
    DistantLight light;
    light.solid_angle = grid.solid_angle(region);
    glm::dvec3 moment(0.0);
    double energy = 0.0;
    // Sums go row by row, so sums of very many pixels keep their last digits.
    for (std::uint32_t y = region.y0; y < region.y1; ++y) {
        glm::dvec3 row_irradiance(0.0);
        glm::dvec3 row_moment(0.0);
        double row_energy = 0.0;
        for (std::uint32_t x = region.x0; x < region.x1; ++x) {
            const glm::dvec3 radiance = grid.radiance(x, y);
            const glm::dvec4 moments = grid.moments(x, y);
            const double value = luminance(radiance);
            row_irradiance += radiance * moments.w;
            row_moment += value * glm::dvec3(moments);
            row_energy += value * moments.w;
        }
        light.irradiance += row_irradiance;
        moment += row_moment;
        energy += row_energy;
    }
    // A shorter vector is rounding (1e-16 per pixel) and has no meaning.
    constexpr double Shortest = 1e-9;
    const double length = glm::length(moment);
    light.direction =
        energy > 0.0 && length > Shortest * energy ? moment / length : grid.centre(region);
    return light;
}

} // namespace

std::vector<DistantLight> lights_of(const LatLongGrid& grid,
                                    const std::vector<PixelRectangle>& regions) {
    std::vector<DistantLight> result(regions.size());
    files::parallel_for(std::size_t{0}, regions.size(),
                        [&](std::size_t i) { result[i] = light_of(grid, regions[i]); });
    return result;
}

} // namespace relumine::lights
