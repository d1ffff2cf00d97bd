// Mean coverage of a region over a square of a cube face, by its solid angle.
//
// Squares that the region's edge crosses are quartered until the ramps of region_shape.h are as
// good as linear over them; the smoothstep of a linear function over a square has a closed form,
// whatever the width of the edge. So a straight hard edge needs no quartering at all, a round one
// only until it looks straight.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "cubemap/face.h"
#include "cubemap/layers/region_shape.h"

namespace relumine::cubemap {

/// A face's plane: the point (u, v) of [-1, 1]^2 is origin + u right + v down (face.h's cube_point
/// with u = 2s - 1, v = 2t - 1).
struct FacePlane {
    explicit FacePlane(Face face)
        : origin(cube_point(face, 0.5, 0.5)), right(cube_point(face, 1.0, 0.5) - origin),
          down(cube_point(face, 0.5, 1.0) - origin) {}
    [[nodiscard]] glm::dvec3 direction(double u, double v) const {
        // The three axes are perpendicular, so the length needs no vector.
        return (origin + u * right + v * down) * (1.0 / std::sqrt(1.0 + u * u + v * v));
    }
    glm::dvec3 origin, right, down;
};

/// The square [u - half, u + half] x [v - half, v + half] of a face's plane.
struct FaceSquare {
    double u = 0.0;
    double v = 0.0;
    double half = 1.0;
    /// No direction of the square is further than this chord from its centre's: moving points of
    /// the plane to the sphere brings them closer together.
    [[nodiscard]] double chord() const { return 1.4142135623730952 * half; }
    [[nodiscard]] FaceSquare quarter(int i) const {
        const double h = 0.5 * half;
        return {(i & 1) != 0 ? u + h : u - h, (i & 2) != 0 ? v + h : v - h, h};
    }
    /// Steradians; relative error below 1e-5.
    [[nodiscard]] double solid_angle() const {
        if (half > 1.0 / 16.0)
            return cubemap::solid_angle(0.5 * (u - half + 1.0), 0.5 * (v - half + 1.0),
                                        0.5 * (u + half + 1.0), 0.5 * (v + half + 1.0));
        // The density q^(-3/2) at the centre and its Laplacian.
        const double q = 1.0 + u * u + v * v;
        return 4.0 * half * half / (q * std::sqrt(q)) *
               (1.0 + half * half / 6.0 * (9.0 * (q - 1.0) - 6.0) / (q * q));
    }
};

/// Mean of smoothstep(a + p x + q y) over the unit square.
[[nodiscard]] double mean_smoothstep(double a, double p, double q);

/// Mean coverage of a square that bound() calls Part, [0, 1].
template<typename Shape>
[[nodiscard]] double mean_coverage(const Shape& shape, const FacePlane& plane,
                                   const FaceSquare& square);

namespace detail {

/// Mean of one ramp's smoothstep over a square, from samples at the four corners (row by row) and
/// the centre.
struct RampFit {
    RampFit(const std::array<double, 4>& corners, double centre);
    double mean = 0.0;
    /// No sample above 0
    bool none = false;
    /// No sample below 1
    bool full = false;
    /// The ramp changes little
    bool smooth = false;
    /// The ramp may be steep but is straight
    bool linear = false;
};

/// The fits' product, if it can be trusted.
template<typename Shape>
std::optional<double> fitted_coverage(const Shape& shape, const FacePlane& plane,
                                      const FaceSquare& square) {
    constexpr std::size_t N = Shape::NumRamps;
    // Beyond this size the density of solid angle varies too much within a square (by a percent).
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
    // The mean of a product is the product of the means where only one factor varies or all vary
    // little.
    if (!trusted || (num_partial > 1 && !all_smooth))
        return std::nullopt;
    return product;
}

/// Integral of coverage over a square's solid angle.
template<typename Shape>
double covered_solid_angle(const Shape& shape, const FacePlane& plane, const FaceSquare& square) {
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
double mean_coverage(const Shape& shape, const FacePlane& plane, const FaceSquare& square) {
    if (const std::optional<double> fitted = detail::fitted_coverage(shape, plane, square))
        return *fitted;
    double sum = 0.0;
    for (int i = 0; i < 4; ++i)
        sum += detail::covered_solid_angle(shape, plane, square.quarter(i));
    return std::min(1.0, sum / square.solid_angle());
}

} // namespace relumine::cubemap
