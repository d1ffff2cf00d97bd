// Which part of a light layer the pointer holds. Works without a window.
#pragma once

#include <glm/vec3.hpp>

#include "relumine/light/layers.h"

namespace relumine::viewer {

using cubemap::angle_between;
using cubemap::turned;

/// The part of a layer under the pointer.
enum class Grip { None, Body, Rim };

/// Returns the part of a region at a direction. The rim is within `tolerance_degrees` of the
/// outline. The inner half of the region is always its body, so a small region can still be moved.
[[nodiscard]] Grip grip_at(const cubemap::Region& region, const glm::dvec3& direction,
                           double tolerance_degrees);

} // namespace relumine::viewer
