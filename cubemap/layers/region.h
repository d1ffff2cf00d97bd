// The region of a layer: one of the shapes that are listed here.
#pragma once

#include <string_view>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/layers/shapes/disc.h"
#include "cubemap/layers/shapes/lasso.h"
#include "cubemap/layers/shapes/rectangle.h"
#include "cubemap/layers/shapes/stroke.h"

namespace relumine::cubemap {

/// The list of shapes.
using Region = std::variant<Disc, Rectangle, Lasso, Stroke>;

/// Returns the name in layer files: "disc", "rectangle", ...
[[nodiscard]] std::string_view type_name(const Region& region);

/// Returns how the window and Python name the shape.
[[nodiscard]] const ShapeWords& words(const Region& region);

/// Returns a region's fields. The pointers are valid until the region is replaced.
[[nodiscard]] std::vector<LayerField> fields(Region& region);

/// Returns a region as the window adds one. Shapes with points have none yet.
[[nodiscard]] Region as_added(const Region& shape);

/// Checks a region alone.
/// Throws:  std::invalid_argument `expected X, got Y` for anything that the shape's fields exclude.
void validate(const Region& region);

/// Returns how much of a direction belongs to the region, in [0, 1]. The direction may have any
/// length but zero. Every call prepares the region again; use composite() for many directions.
/// Throws:  as validate().
[[nodiscard]] double coverage(const Region& region, const glm::dvec3& direction);

/// Returns the region with hard edges.
[[nodiscard]] Region hardened(Region region);

/// Returns a region's middle, a unit direction: its direction, or the mean of its points.
[[nodiscard]] glm::dvec3 middle(const Region& region);

/// Returns the region's border as a closed line of unit directions. The first one is repeated at
/// the end.
[[nodiscard]] std::vector<glm::dvec3> outline(const Region& region);

/// Returns a region turned about +Y. A rectangle stays upright.
[[nodiscard]] Region turned(Region region, double degrees_about_y);

/// Returns the region turned as its body was dragged from one direction to another, on the shortest
/// way. Soft boxes stay as upright as they are.
[[nodiscard]] Region moved(Region region, const glm::dvec3& from, const glm::dvec3& to);

/// Returns the region moved so that its middle is at a direction.
[[nodiscard]] Region centred(Region region, const glm::dvec3& direction);

/// Returns the region after its rim was dragged. The result is valid if the region was.
[[nodiscard]] Region resized(Region region, const glm::dvec3& from, const glm::dvec3& to);

namespace detail {
template<typename Shapes>
struct Prepare;
template<LayerShape... Shapes>
struct Prepare<std::variant<Shapes...>> {
    using All = std::variant<typename Shapes::Prepared...>;
};
} // namespace detail

using RegionShape = detail::Prepare<Region>::All;

/// Prepares a region.
/// Throws:  std::invalid_argument as validate() does.
[[nodiscard]] RegionShape shape(const Region& region);

/// Rises from 0 at t = 0 to 1 at t = 1, and is level at both ends and beyond.
[[nodiscard]] double smoothstep(double t);

} // namespace relumine::cubemap
