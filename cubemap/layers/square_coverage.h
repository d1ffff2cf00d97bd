// Mean coverage of a region over a square of a cube face, weighted by solid angle.
//
// A square on the region's edge is quartered until the ramps of layer_shape.h are nearly linear
// over it. The smoothstep of a linear function over a square has a closed form for every width of
// the edge. So a straight hard edge needs no quartering, and a round edge is quartered only until
// it looks straight.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <glm/vec3.hpp>

#include "cubemap/face.h"
#include "cubemap/layers/region.h"

namespace relumine::cubemap {

/// The square [u - half, u + half] x [v - half, v + half] of a face's plane.
struct FaceSquare {
    double u = 0.0;
    double v = 0.0;
    double half = 1.0;
    /// Returns a chord that no direction of the square exceeds, measured from the direction of its
    /// centre. Points of the plane come closer together when they move to the sphere.
    [[nodiscard]] double chord() const { return 1.4142135623730952 * half; }
    [[nodiscard]] FaceSquare quarter(int i) const {
        const double h = 0.5 * half;
        return {(i & 1) != 0 ? u + h : u - h, (i & 2) != 0 ? v + h : v - h, h};
    }
    /// Returns the solid angle in steradians. The relative error is below 1e-5.
    [[nodiscard]] double solid_angle() const {
        if (half > 1.0 / 16.0)
            return cubemap::solid_angle(0.5 * (u - half + 1.0), 0.5 * (v - half + 1.0),
                                        0.5 * (u + half + 1.0), 0.5 * (v + half + 1.0));
        // The density q^(-3/2) at the centre, corrected by its Laplacian.
        const double q = 1.0 + u * u + v * v;
        return 4.0 * half * half / (q * std::sqrt(q)) *
               (1.0 + half * half / 6.0 * (9.0 * (q - 1.0) - 6.0) / (q * q));
    }
};

/// Returns the mean of smoothstep(a + p x + q y) over the unit square.
[[nodiscard]] double mean_smoothstep(double a, double p, double q);

/// Returns the mean coverage, in [0, 1], of a square for which bound() gives Part.
template<typename Shape>
[[nodiscard]] double mean_coverage(const Shape& shape, const FaceAxes& plane,
                                   const FaceSquare& square);

namespace detail {

/// Mean of one ramp's smoothstep over a square, from samples at the four corners (row by row) and
/// at the centre.
struct RampFit {
    RampFit(const std::array<double, 4>& corners, double centre);
    double mean = 0.0;
    /// No sample is above 0.
    bool none = false;
    /// No sample is below 1.
    bool full = false;
    /// The ramp changes little over the square.
    bool smooth = false;
    /// The ramp is straight over the square; it may be steep.
    bool linear = false;
};

/// Returns the product of the ramps' means, or nothing if the fits cannot be trusted.
template<typename Shape>
std::optional<double> fitted_coverage(const Shape& shape, const FaceAxes& plane,
                                      const FaceSquare& square) {
    constexpr std::size_t N = Shape::NumRamps;
    // In larger squares the density of solid angle varies by more than a percent.
    constexpr double LargestHalf = 1.0 / 256.0;
    const bool smallest = square.chord() <= shape.smallest_feature();
    if (!smallest && square.half > LargestHalf)
        return std::nullopt;
    const auto ramps_at = [&](double u, double v) {
        return shape.ramps(plane.direction(u, v));
    };
    const double u0 = square.u - square.half, u1 = square.u + square.half;
    const double v0 = square.v - square.half, v1 = square.v + square.half;
    const std::array<std::array<double, N>, 4> corners = {ramps_at(u0, v0), ramps_at(u1, v0),
                                                          ramps_at(u0, v1), ramps_at(u1, v1)};
    const glm::dvec3 middle = plane.direction(square.u, square.v);
    const std::array<double, N> centre = shape.ramps(middle);
    double product = 1.0;
    std::size_t num_partial = 0;
    bool all_smooth = true;
    bool trusted = true;
    for (std::size_t i = 0; i < N; ++i) {
        const RampFit fit({corners[0][i], corners[1][i], corners[2][i], corners[3][i]}, centre[i]);
        product *= fit.mean;
        if (smallest || (fit.full && Shape::HasConcaveRamps))
            continue;
        const bool straight = fit.linear && !shape.has_kink(i, middle, square.chord());
        if (fit.none && straight)
            return 0.0;
        num_partial += 1;
        all_smooth = all_smooth && fit.smooth;
        trusted = trusted && (fit.smooth || straight);
    }
    // The mean of a product is the product of the means if only one factor varies, or if all vary
    // little.
    if (!trusted || (num_partial > 1 && !all_smooth))
        return std::nullopt;
    return product;
}

/// Returns the integral of coverage over a square's solid angle.
template<typename Shape>
double covered_solid_angle(const Shape& shape, const FaceAxes& plane, const FaceSquare& square) {
    switch (shape.bound(plane.direction(square.u, square.v), square.chord())) {
    case Overlap::None:
        return 0.0;
    case Overlap::All:
        return square.solid_angle();
    case Overlap::Part:
        break;
    }
    if (const std::optional<double> fitted = fitted_coverage(shape, plane, square))
        return *fitted * square.solid_angle();
    double sum = 0.0;
    for (int i = 0; i < 4; ++i)
        sum += covered_solid_angle(shape, plane, square.quarter(i));
    return sum;
}

} // namespace detail

template<typename Shape>
double mean_coverage(const Shape& shape, const FaceAxes& plane, const FaceSquare& square) {
    if (const std::optional<double> fitted = detail::fitted_coverage(shape, plane, square))
        return *fitted;
    double sum = 0.0;
    for (int i = 0; i < 4; ++i)
        sum += detail::covered_solid_angle(shape, plane, square.quarter(i));
    return std::min(1.0, sum / square.solid_angle());
}

} // namespace relumine::cubemap
