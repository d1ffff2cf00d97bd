// What of a light layer the pointer holds, and how a drag changes it. Without a window.
#pragma once

#include <glm/vec3.hpp>

#include "cubemap/layers/light_layer.h"
#include "cubemap/layers/region_turn.h"
#include "viewer/region_outline.h"

namespace relumine::viewer {

/// What of a layer lies under the pointer.
enum class Grip { None, Body, Rim };

/// Rim: within `tolerance_degrees` of the outline, where a region is so small that this would leave
/// no body, outside of its half size.
[[nodiscard]] Grip grip_at(const cubemap::Region& region, const glm::dvec3& direction,
                           double tolerance_degrees);

/// The region after its body was dragged from one direction to another: turned along. Soft boxes
/// stay as upright as they are.
[[nodiscard]] cubemap::Region moved(const cubemap::Region& region, const glm::dvec3& from,
                                    const glm::dvec3& to);

/// The region after its rim was dragged: discs and strokes change their radius, rectangles the
/// sides that were held, lassos their size. What comes out is valid if the region was.
[[nodiscard]] cubemap::Region resized(const cubemap::Region& region, const glm::dvec3& from,
                                      const glm::dvec3& to);

using cubemap::turned; // as relight::LightEditor::set_rotation() turns

/// Degrees between two directions of any length but zero.
[[nodiscard]] double angle_between(const glm::dvec3& a, const glm::dvec3& b);

} // namespace relumine::viewer
