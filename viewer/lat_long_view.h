// The environment's view: a lat-long picture that is panned and zoomed. Without a window.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "viewer/panel_layout.h"

namespace relumine::viewer {

/// Lat-long coordinates: u from 0 at the left edge (longitude pi) to 1 at the right (-pi), so that
/// +Z is at 0.5 and +X at 0.25; v from 0 at the top (+Y) to 1. As cubemap::Layout::LatLong.
[[nodiscard]] glm::dvec2 lat_long(const glm::dvec3& direction);
/// Unit. Any u (it goes round), v within [0, 1].
[[nodiscard]] glm::dvec3 direction_at(const glm::dvec2& uv);

/// A line of directions as lat-long points, without jumps: u goes on beyond 0 and 1 where the line
/// crosses the seam.
[[nodiscard]] std::vector<glm::dvec2> unrolled(std::span<const glm::dvec3> line);

/// Which part of the lat-long is seen, and how large. It goes on sideways without end.
struct LatLongView {
    glm::dvec2 center{0.5, 0.5};
    /// 1: the whole width fits
    double zoom = 1.0;

    [[nodiscard]] glm::dvec2 uv_at(const PixelRectangle& viewport, const glm::dvec2& pixel) const;
    [[nodiscard]] glm::dvec2 pixel_at(const PixelRectangle& viewport, const glm::dvec2& uv) const;
    /// Nothing above the top or below the bottom of the picture.
    [[nodiscard]] std::optional<glm::dvec3> direction(const PixelRectangle& viewport,
                                                      const glm::dvec2& pixel) const;
    /// Where a direction is seen; of its copies the one nearest to the view's centre.
    [[nodiscard]] glm::dvec2 pixel_of(const PixelRectangle& viewport,
                                      const glm::dvec3& direction) const;

    void pan(const PixelRectangle& viewport, const glm::dvec2& pixels);
    /// Wheel steps; what is under the pixel stays there.
    void zoom_at(const PixelRectangle& viewport, const glm::dvec2& pixel, double steps);
};

} // namespace relumine::viewer
