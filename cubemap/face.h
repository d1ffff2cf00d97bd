// The one place that says how cube faces lie in space. Everything else calls these functions.
#pragma once

#include <array>
#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Cube faces in the order of the OpenEXR specification (ImfEnvmap.h), stacked top to bottom in a
/// file.
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
/// (s, t) run over [0, 1]^2 with (0, 0) at the face's top left corner; texel (x, y) of R x R covers
/// [x/R, (x+1)/R] x [y/R, (y+1)/R] and its sample lies at the centre.
enum class Face : std::uint8_t { PositiveX, NegativeX, PositiveY, NegativeY, PositiveZ, NegativeZ };

inline constexpr std::size_t NumFaces = 6;
inline constexpr std::array<Face, NumFaces> AllFaces = {Face::PositiveX, Face::NegativeX,
                                                        Face::PositiveY, Face::NegativeY,
                                                        Face::PositiveZ, Face::NegativeZ};

/// A point of the cube's surface.
struct FacePoint {
    Face face = Face::PositiveX;
    /// To the right in the face's image, [0, 1]
    double s = 0.0;
    /// Downwards in the face's image, [0, 1]
    double t = 0.0;
};

/// Direction of a face point on the cube [-1, 1]^3, not normalised (its largest component is 1 in
/// size).
[[nodiscard]] glm::dvec3 cube_point(Face face, double s, double t);

/// Unit direction of a face point.
[[nodiscard]] glm::dvec3 direction(Face face, double s, double t);

/// The face point that a direction (any length but zero) goes through. Ties on edges and corners go
/// to the face that comes first in Face.
[[nodiscard]] FacePoint face_point(const glm::dvec3& direction);

/// Solid angle in steradians of the rectangle [s0, s1] x [t0, t1] of any face; exact (four
/// arctangents). The six full faces sum to 4 pi.
[[nodiscard]] double solid_angle(double s0, double t0, double s1, double t1);

} // namespace relumine::cubemap
