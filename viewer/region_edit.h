// Which part of a light layer the pointer holds, and how a drag changes the layer. Works without a
// window.
#pragma once

#include <glm/vec3.hpp>

#include "cubemap/layers/light_layer.h"
#include "cubemap/layers/region_turn.h"
#include "viewer/region_outline.h"

namespace relumine::viewer {

/// The part of a layer under the pointer.
enum class Grip { None, Body, Rim };

/// Returns the part of a region at a direction. The rim is within `tolerance_degrees` of the
/// outline. The inner half of the region is always its body, so a small region can still be moved.
[[nodiscard]] Grip grip_at(const cubemap::Region& region, const glm::dvec3& direction,
                           double tolerance_degrees);

/// Returns the region turned as its body was dragged from one direction to another. Soft boxes stay
/// as upright as they are.
[[nodiscard]] cubemap::Region moved(const cubemap::Region& region, const glm::dvec3& from,
                                    const glm::dvec3& to);

/// Returns the region after its rim was dragged. Discs and strokes change their radius, rectangles
/// the sides that were held, lassos their size. The result is valid if the region was.
[[nodiscard]] cubemap::Region resized(const cubemap::Region& region, const glm::dvec3& from,
                                      const glm::dvec3& to);

// Turns as set_rotation() does.
using cubemap::turned;

/// Returns the degrees between two directions of any length but zero.
[[nodiscard]] double angle_between(const glm::dvec3& a, const glm::dvec3& b);

} // namespace relumine::viewer
