#include "cubemap/image_layout.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

namespace relumine::cubemap {

namespace {

constexpr double Pi = std::numbers::pi;

} // namespace

std::string_view name(Layout layout) {
    switch (layout) {
    case Layout::LatLong:
        return "lat-long";
    case Layout::Cube:
        return "cube";
    case Layout::VerticalCross:
        break;
    }
    return "vertical cross";
}

std::vector<double> cell_borders(std::uint32_t num_cells, Sampling sampling) {
    std::vector<double> borders(std::size_t{num_cells} + 1);
    const double n = num_cells;
    for (std::size_t i = 0; i <= num_cells; ++i) {
        const auto position = static_cast<double>(i);
        borders[i] = sampling == Sampling::TexelCentres ? position / n : (position - 0.5) / (n - 1.0);
    }
    borders.front() = 0.0;
    borders.back() = 1.0;
    return borders;
}

double sample_position(std::uint32_t index, std::uint32_t num_samples, Sampling sampling) {
    if (sampling == Sampling::TexelCentres || num_samples == 1)
        return (index + 0.5) / num_samples;
    return static_cast<double>(index) / (num_samples - 1);
}

bool fits(Layout layout, std::uint32_t width, std::uint32_t height) {
    if (width == 0 || height == 0)
        return false;
    switch (layout) {
    case Layout::LatLong:
        return true;
    case Layout::Cube:
        return height % 6 == 0 && height / 6 == width;
    case Layout::VerticalCross:
        break;
    }
    return width % 3 == 0 && height % 4 == 0 && width / 3 == height / 4;
}

FaceCells::FaceCells(Layout layout, std::uint32_t width, std::uint32_t height)
    : width_(width), resolution_(0), cells_{} {
    if (layout == Layout::LatLong || !fits(layout, width, height))
        throw std::invalid_argument(fmt::format("expected an image of six cube faces, got a {} of {}x{}",
                                                name(layout), width, height));
    if (layout == Layout::Cube) {
        resolution_ = width;
        for (std::size_t face = 0; face < NumFaces; ++face)
            cells_[face] = {0, face, false};
    } else {
        // The cross unfolds the cube around -Z, as HDR Shop and Debevec's probes do; +Z hangs at the bottom, upside down:
        //
        //          +Y
        //      -X  -Z  +X
        //          -Y
        //          +Z (turned)
        resolution_ = width / 3;
        cells_ = {Cell{2, 1, false}, Cell{0, 1, false}, Cell{1, 0, false},
                  Cell{1, 2, false}, Cell{1, 3, true},  Cell{1, 1, false}};
    }
}

namespace detail {

std::vector<LatLongRow> lat_long_rows(const ImageShape& shape) {
    const std::vector<double> borders = cell_borders(shape.height, shape.sampling);
    std::vector<LatLongRow> rows(shape.height);
    for (std::uint32_t y = 0; y < shape.height; ++y) {
        const double polar = Pi * sample_position(y, shape.height, shape.sampling);
        const double top = Pi * borders[y], bottom = Pi * borders[y + 1];
        // cos(top) - cos(bottom) without cancellation
        const double height = 2.0 * std::sin(0.5 * (top + bottom)) * std::sin(0.5 * (bottom - top));
        rows[y] = {std::cos(polar), std::sin(polar), height};
    }
    return rows;
}

std::vector<LatLongColumn> lat_long_columns(const ImageShape& shape) {
    const std::vector<double> borders = cell_borders(shape.width, shape.sampling);
    std::vector<LatLongColumn> columns(shape.width);
    for (std::uint32_t x = 0; x < shape.width; ++x) {
        const double longitude = 2.0 * Pi * (0.5 - sample_position(x, shape.width, shape.sampling));
        columns[x] = {std::sin(longitude), std::cos(longitude), 2.0 * Pi * (borders[x + 1] - borders[x])};
    }
    return columns;
}

} // namespace detail

} // namespace relumine::cubemap
