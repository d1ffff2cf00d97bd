// Layouts that are one picture of the whole sphere, as a map from the picture's square to
// directions. A new layout of this kind is one class here and its name in environment.h;
// resampling, sizes and conversions follow from the functions below.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// Continuous and one to one inside the picture; where neighbouring points of the picture's rim
/// meet on the sphere is the layout's affair.
class Projection {
public:
    virtual ~Projection() = default;
    /// Unit direction of a point of [0, 1]^2, (0, 0) at the top left.
    [[nodiscard]] virtual glm::dvec3 direction(const glm::dvec2& point) const = 0;
    /// The point that shows a unit direction.
    [[nodiscard]] virtual glm::dvec2 point(const glm::dvec3& direction) const = 0;
    /// Solid angle per area of [0, 1]^2, in steradians.
    [[nodiscard]] virtual double density(const glm::dvec2& point) const = 0;
    /// True if only the disc of radius 1/2 about the middle shows anything; its whole rim is then
    /// one direction.
    [[nodiscard]] virtual bool is_disc() const = 0;
    /// True if the picture is a mirror image of what is seen from the middle of the sphere.
    [[nodiscard]] virtual bool is_mirrored() const = 0;

protected:
    Projection() = default;
    Projection(const Projection&) = default;
    Projection& operator=(const Projection&) = default;
};

/// The projection of a layout; null for LatLong and for those made of cube faces.
[[nodiscard]] const Projection* projection(Layout layout);

} // namespace relumine::cubemap
