#include "lights/lat_long_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "cubemap/image/image_layout.h"
#include "files/parallel.h"

namespace relumine::lights {

namespace {

bool is_radiance(const glm::vec3& value) {
    return std::isfinite(value.r) && std::isfinite(value.g) && std::isfinite(value.b) &&
           value.r >= 0.0f && value.g >= 0.0f && value.b >= 0.0f;
}

void check_radiance(std::span<const glm::vec3> pixels, std::size_t width) {
    const std::size_t height = pixels.size() / width;
    std::vector<char> good(height, 1);
    files::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
        const auto row = pixels.subspan(y * width, width);
        good[y] = std::all_of(row.begin(), row.end(), is_radiance) ? 1 : 0;
    });
    const auto bad_row =
        static_cast<std::size_t>(std::find(good.begin(), good.end(), 0) - good.begin());
    if (bad_row == height)
        return;
    const auto row = pixels.subspan(bad_row * width, width);
    const auto bad = std::find_if_not(row.begin(), row.end(), is_radiance);
    throw std::invalid_argument(fmt::format(
        "expected radiance that is finite and not negative, got ({}, {}, {}) in pixel ({}, {})",
        bad->r, bad->g, bad->b, bad - row.begin(), bad_row));
}

} // namespace

LatLongGrid::LatLongGrid(const cubemap::EnvironmentImage& image) : pixels_(image.pixels) {
    if (image.layout != cubemap::Layout::LatLong)
        throw std::invalid_argument(
            fmt::format("expected a lat-long image, got a {}", cubemap::name(image.layout)));
    if (image.width == 0 || image.pixels.size() != std::size_t{image.width} * image.height ||
        image.pixels.empty())
        throw std::invalid_argument(fmt::format("expected {} x {} pixels and at least one, got {}",
                                                image.width, image.height, image.pixels.size()));
    check_radiance(pixels_, image.width);

    // Differences such as sin a - sin b are written as products, so narrow borders cause no
    // cancellation.
    const std::vector<double> down = cubemap::cell_borders(image.height, image.sampling);
    for (std::uint32_t y = 0; y < image.height; ++y) {
        const double top = std::numbers::pi * down[y];
        const double bottom = std::numbers::pi * down[y + 1];
        const double height = 2.0 * std::sin(0.5 * (top + bottom)) * std::sin(0.5 * (bottom - top));
        // The integral of sin^2 is (bottom - top) / 2 - (sin 2 bottom - sin 2 top) / 4.
        const double across =
            0.5 * (bottom - top) - 0.5 * std::cos(top + bottom) * std::sin(bottom - top);
        // The integral of sin cos is (sin^2 bottom - sin^2 top) / 2.
        const double upwards = 0.5 * std::sin(top + bottom) * std::sin(bottom - top);
        rows_.push_back({top, bottom, height, across, upwards});
    }
    const std::vector<double> across = cubemap::cell_borders(image.width, image.sampling);
    for (std::uint32_t x = 0; x < image.width; ++x) {
        const double left =
            2.0 * std::numbers::pi * (0.5 - across[x]); // the left edge is longitude +pi
        const double right = 2.0 * std::numbers::pi * (0.5 - across[x + 1]);
        const double half = 0.5 * (left - right);
        const double middle = 0.5 * (left + right);
        columns_.push_back({left, right, 2.0 * half, 2.0 * std::sin(middle) * std::sin(half),
                            2.0 * std::cos(middle) * std::sin(half)});
    }
}

double LatLongGrid::solid_angle(const PixelRectangle& region) const {
    const double top = rows_[region.y0].top;
    const double bottom = rows_[region.y1 - 1].bottom;
    return (columns_[region.x0].left - columns_[region.x1 - 1].right) * 2.0 *
           std::sin(0.5 * (top + bottom)) * std::sin(0.5 * (bottom - top));
}

double LatLongGrid::angular_width(const PixelRectangle& region) const {
    // cos(inclination) = sin(polar angle)
    return (columns_[region.x0].left - columns_[region.x1 - 1].right) *
           std::sin(0.5 * (rows_[region.y0].top + rows_[region.y1 - 1].bottom));
}

double LatLongGrid::angular_height(const PixelRectangle& region) const {
    return rows_[region.y1 - 1].bottom - rows_[region.y0].top;
}

glm::dvec3 LatLongGrid::centre(const PixelRectangle& region) const {
    const double polar = 0.5 * (rows_[region.y0].top + rows_[region.y1 - 1].bottom);
    const double longitude = 0.5 * (columns_[region.x0].left + columns_[region.x1 - 1].right);
    return {std::sin(polar) * std::sin(longitude), std::cos(polar),
            std::sin(polar) * std::cos(longitude)};
}

glm::dvec3 LatLongGrid::direction(std::uint32_t x, std::uint32_t y, double across,
                                  double down) const {
    const double longitude = columns_[x].left - across * columns_[x].width;
    const double up = std::clamp(std::cos(rows_[y].top) - down * rows_[y].height, -1.0, 1.0);
    const double level = std::sqrt((1.0 - up) * (1.0 + up));
    return {level * std::sin(longitude), up, level * std::cos(longitude)};
}

} // namespace relumine::lights
