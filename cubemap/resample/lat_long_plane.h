// The plane of turns and heights, in which lat-long pixels and cube texels overlap.
//
// A direction of longitude l and polar angle p has the coordinates f = 1/2 - l / 2 pi (the image's
// own x) and y = -cos p. By Archimedes' theorem the solid angle of a region is 2 pi times its area
// in this plane, and lat-long pixels are plain rectangles.
//
//     face   f at (u, v)                     y
//     +Z     1/2 + atan(u) / 2 pi            v / sqrt(1 + u^2 + v^2)
//     +X, -Z, -X: as +Z, with 1/4 and 1/2 subtracted from f and 1/4 added to it
//     +Y     1/2 - atan2(u, -v) / 2 pi       1 - cos p
//     -Y: as +Y, mirrored at the horizon
//
// On +Y the height is measured from the pole. Otherwise it would lose all its digits there.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "cubemap/face.h"
#include "cubemap/image/image_layout.h"

namespace relumine::cubemap::detail {

inline constexpr double RadiansPerTurn = 2.0 * std::numbers::pi;

inline bool is_polar(Face face) {
    return face == Face::PositiveY || face == Face::NegativeY;
}

/// Returns f of the middle of a side face.
inline double turn_of(Face face) {
    switch (face) {
    case Face::PositiveX:
        return 0.25;
    case Face::NegativeX:
        return 0.75;
    case Face::PositiveZ:
        return 0.5;
    default:
        return 0.0;
    }
}

/// Returns the image's row borders as heights in the measure of +Y or of the side faces.
inline std::vector<double> row_heights(const EnvironmentImage& image, Face face) {
    std::vector<double> heights = cell_borders(image.height, image.sampling);
    for (double& border : heights) {
        const double polar = std::numbers::pi * border;
        border = is_polar(face) ? 2.0 * std::pow(std::sin(0.5 * polar), 2) : -std::cos(polar);
    }
    return heights;
}

/// Returns the integral of clamp(height, low, high) - low along a chord of the given width.
inline double area_within(double from, double to, double width, double low, double high) {
    if (from > to)
        std::swap(from, to);
    if (to <= low)
        return 0.0;
    if (from >= high)
        return width * (high - low);
    if (from >= low && to <= high)
        return width * (0.5 * (from + to) - low);
    // The integral over the height instead: it is quadratic inside, linear above.
    const auto integral = [&](double height) {
        if (height <= low)
            return 0.0;
        const double inside = std::min(height, high) - low;
        return inside * (0.5 * inside + std::max(height - high, 0.0));
    };
    return width * (integral(to) - integral(from)) / (to - from);
}

} // namespace relumine::cubemap::detail
