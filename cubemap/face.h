// The one place that says how cube faces lie in space. All other code calls these functions.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "files/plain_glm.h"

namespace relumine::cubemap {

/// Cube faces in the order of the OpenEXR specification (ImfEnvmap.h). A file stacks the faces in
/// this order from top to bottom.
///
/// World axes: right-handed, +Y up. Every face is seen from the centre of the cube, looking
/// outwards, as OpenEXR stores it:
///
///     face   image right (s)   image down (t)        direction of (s, t), u = 2s - 1, v = 2t - 1
///     +X          +Z                -Y               ( 1, -v,  u)
///     -X          -Z                -Y               (-1, -v, -u)
///     +Y          +X                -Z               ( u,  1, -v)
///     -Y          +X                +Z               ( u, -1,  v)
///     +Z          -X                -Y               (-u, -v,  1)
///     -Z          +X                -Y               ( u, -v, -1)
///
/// (s, t) run over [0, 1]^2; (0, 0) is the top left corner of the face. Texel (x, y) of R x R
/// covers [x/R, (x+1)/R] x [y/R, (y+1)/R], and its sample lies at the centre.
enum class Face : std::uint8_t { PositiveX, NegativeX, PositiveY, NegativeY, PositiveZ, NegativeZ };

inline constexpr std::size_t NumFaces = 6;
inline constexpr std::array<Face, NumFaces> AllFaces = {Face::PositiveX, Face::NegativeX,
                                                        Face::PositiveY, Face::NegativeY,
                                                        Face::PositiveZ, Face::NegativeZ};

/// A point of the cube's surface.
struct FacePoint {
    Face face = Face::PositiveX;
    /// To the right in the face's image, in [0, 1].
    double s = 0.0;
    /// Downwards in the face's image, in [0, 1].
    double t = 0.0;
};

/// Returns the direction of a face point on the cube [-1, 1]^3. The vector is not normalised: its
/// largest component has size 1.
[[nodiscard]] inline glm::dvec3 cube_point(Face face, double s, double t) {
    const double u = 2.0 * s - 1.0;
    const double v = 2.0 * t - 1.0;
    switch (face) {
    case Face::PositiveX:
        return {1.0, -v, u};
    case Face::NegativeX:
        return {-1.0, -v, -u};
    case Face::PositiveY:
        return {u, 1.0, -v};
    case Face::NegativeY:
        return {u, -1.0, v};
    case Face::PositiveZ:
        return {-u, -v, 1.0};
    case Face::NegativeZ:
        break;
    }
    return {u, -v, -1.0};
}

/// The axes of a face, to the right and down in its image and outwards: cube_point() is outwards +
/// u right + v down, where (u, v) = (2s - 1, 2t - 1).
struct FaceAxes {
    glm::dvec3 right, down, outwards;

    explicit FaceAxes(Face face);
    /// Returns the unit direction of (u, v).
    [[nodiscard]] glm::dvec3 direction(double u, double v) const {
        // The three axes are perpendicular, so the length follows from u and v.
        return (outwards + u * right + v * down) * (1.0 / std::sqrt(1.0 + u * u + v * v));
    }
    /// Returns a direction's parts along the axes. It goes through (u, v) = (x, y) / z.
    [[nodiscard]] glm::dvec3 parts(const glm::dvec3& direction) const {
        return {glm::dot(direction, right), glm::dot(direction, down),
                glm::dot(direction, outwards)};
    }
};

/// Returns the unit direction of a face point.
[[nodiscard]] inline glm::dvec3 direction(Face face, double s, double t) {
    return glm::normalize(cube_point(face, s, t));
}

/// Returns the face point that a direction goes through. The direction may have any length but
/// zero. A direction on an edge or a corner belongs to the face that comes first in Face.
[[nodiscard]] inline FacePoint face_point(const glm::dvec3& direction) {
    const glm::dvec3& w = direction;
    const glm::dvec3 size = glm::abs(w);
    const auto at = [](Face face, double u, double v) {
        return FacePoint{face, std::clamp(0.5 * (u + 1.0), 0.0, 1.0),
                         std::clamp(0.5 * (v + 1.0), 0.0, 1.0)};
    };
    if (size.x >= size.y && size.x >= size.z)
        return w.x > 0.0 ? at(Face::PositiveX, w.z / size.x, -w.y / size.x)
                         : at(Face::NegativeX, -w.z / size.x, -w.y / size.x);
    if (size.y >= size.z)
        return w.y > 0.0 ? at(Face::PositiveY, w.x / size.y, -w.z / size.y)
                         : at(Face::NegativeY, w.x / size.y, w.z / size.y);
    return w.z > 0.0 ? at(Face::PositiveZ, -w.x / size.z, -w.y / size.z)
                     : at(Face::NegativeZ, w.x / size.z, -w.y / size.z);
}

/// Returns the solid angle of the rectangle [s0, s1] x [t0, t1] of any face, in steradians. The
/// value is exact (four arctangents). The six full faces sum to 4 pi.
[[nodiscard]] double solid_angle(double s0, double t0, double s1, double t1);

} // namespace relumine::cubemap
