// Axes around a direction.
#pragma once

#include <cmath>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Returns a right-handed frame of unit vectors whose third axis is a unit vector.
///
/// Based on: T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
template<class Number>
[[nodiscard]] glm::mat<3, 3, Number> frame_of(const glm::vec<3, Number>& axis) {
    const Number one(1);
    const Number sign = std::copysign(one, axis.z);
    const Number a = -one / (sign + axis.z);
    const Number b = axis.x * axis.y * a;
    return {{one + sign * axis.x * axis.x * a, sign * b, -sign * axis.x},
            {b, sign + axis.y * axis.y * a, -axis.y},
            axis};
}

} // namespace relumine::cubemap
