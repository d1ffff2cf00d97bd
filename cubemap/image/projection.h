// Layouts that show the whole sphere in one picture, as a map from the picture's square to
// directions.
//
// A new layout of this kind is one class here and its name in environment.h. Resampling, sizes and
// conversions use the functions below.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// A map from picture to sphere, continuous and one to one inside the picture. Each layout has its
/// own way of joining the picture's rim on the sphere.
class Projection {
public:
    virtual ~Projection() = default;
    /// Returns the unit direction of a point of [0, 1]^2; (0, 0) is the top left.
    [[nodiscard]] virtual glm::dvec3 direction(const glm::dvec2& point) const = 0;
    /// Returns the point that shows a unit direction.
    [[nodiscard]] virtual glm::dvec2 point(const glm::dvec3& direction) const = 0;
    /// Returns the solid angle per area of [0, 1]^2, in steradians.
    [[nodiscard]] virtual double density(const glm::dvec2& point) const = 0;
    /// Returns true if only the disc of radius 1/2 about the middle shows something. The whole rim
    /// of the disc is then one direction.
    [[nodiscard]] virtual bool is_disc() const = 0;
    /// Returns true if the picture is a mirror image of the view from the middle of the sphere.
    [[nodiscard]] virtual bool is_mirrored() const = 0;

protected:
    Projection() = default;
    Projection(const Projection&) = default;
    Projection& operator=(const Projection&) = default;
};

/// Returns the projection of a layout. Null for LatLong and for layouts made of cube faces.
[[nodiscard]] const Projection* projection(Layout layout);

} // namespace relumine::cubemap
