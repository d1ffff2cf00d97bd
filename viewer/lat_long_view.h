// The environment's view: a lat-long picture that is panned and zoomed. Works without a window.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "viewer/panel_layout.h"

namespace relumine::viewer {

/// Returns lat-long coordinates, as cubemap::Layout::LatLong. u goes from 0 at the left edge
/// (longitude pi) to 1 at the right (-pi), so +Z is at 0.5 and +X at 0.25. v goes from 0 at the top
/// (+Y) to 1.
[[nodiscard]] glm::dvec2 lat_long(const glm::dvec3& direction);
/// Returns a unit direction. Any u is valid (it goes round); v must lie within [0, 1].
[[nodiscard]] glm::dvec3 direction_at(const glm::dvec2& uv);

/// Returns a line of directions as lat-long points, without jumps: u goes on beyond 0 and 1 where
/// the line crosses the seam.
[[nodiscard]] std::vector<glm::dvec2> unrolled(std::span<const glm::dvec3> line);

/// The visible part of the lat-long and its scale. The picture repeats sideways without end.
struct LatLongView {
    glm::dvec2 center{0.5, 0.5};
    /// 1: the whole width fits.
    double zoom = 1.0;

    [[nodiscard]] glm::dvec2 uv_at(const PixelRectangle& viewport, const glm::dvec2& pixel) const;
    [[nodiscard]] glm::dvec2 pixel_at(const PixelRectangle& viewport, const glm::dvec2& uv) const;
    /// Returns the direction at a pixel; nothing above the top or below the bottom of the picture.
    [[nodiscard]] std::optional<glm::dvec3> direction(const PixelRectangle& viewport,
                                                      const glm::dvec2& pixel) const;
    /// Returns the pixel of a direction. Of its copies, the one nearest to the view's centre
    /// counts.
    [[nodiscard]] glm::dvec2 pixel_of(const PixelRectangle& viewport,
                                      const glm::dvec3& direction) const;

    void pan(const PixelRectangle& viewport, const glm::dvec2& pixels);
    /// Zooms by wheel steps. The point under the pixel stays there.
    void zoom_at(const PixelRectangle& viewport, const glm::dvec2& pixel, double steps);
};

} // namespace relumine::viewer
