// The photographed ground that a mesh stands on: an environment projected to a plane.
#pragma once

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relight/pictures/backdrop.h"

namespace relumine::relight {

/// A level ground and the camera above it that saw an environment. What the camera saw below the
/// horizon lies on the ground, as far as a sphere about the camera reaches. All else stands on the
/// sphere. Ground and sphere meet, so the picture has no seam.
struct Ground {
    /// Where the environment was photographed.
    glm::dvec3 camera{0.0};
    /// Height of the camera above the ground, above 0.
    double height = 1.0;
    /// Radius of the sphere, above `height`.
    double reach = 20.0;

    /// Returns the point of the ground or the sphere that a ray finds, from the camera. For an eye
    /// below the ground it is the ray's direction. An eye outside of the sphere sees a larger one.
    [[nodiscard]] glm::dvec3 point(const glm::vec3& eye, const glm::vec3& direction) const;
};

/// Shows a backdrop on the ground, as an eye sees it.
[[nodiscard]] Backdrop grounded_backdrop(Backdrop backdrop, const Ground& ground,
                                         const glm::vec3& eye);

/// Shows a ground of one colour that ends in the backdrop far away: a studio's sweep.
[[nodiscard]] Backdrop sweep_backdrop(Backdrop backdrop, const glm::vec3& color,
                                      const Ground& ground, const glm::vec3& eye);

/// Whether an environment shows a ground: its part below the horizon is neither black, below 2 % of
/// what a white ground would send, nor even, within 1 % of its mean, and no lamp or window stands
/// on it: what is three times as bright as a white ground, and 3 to 17 degrees below the horizon.
///
/// Shape:   open_ground is the radiance of a level white surface that nothing shades.
/// Cost:    O(texels).
[[nodiscard]] bool has_ground(const cubemap::CubeMap& map, const glm::vec3& open_ground);

} // namespace relumine::relight
