#include "viewer/lat_long_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace relumine::viewer {

namespace {

constexpr double Pi = std::numbers::pi;

/// Keeps the view inside the picture. A view higher than the picture is centred.
double clamped_v(double v, double half_height) {
    return half_height >= 0.5 ? 0.5 : std::clamp(v, half_height, 1.0 - half_height);
}

double pixels_per_u(const LatLongView& view, const PixelRectangle& viewport) {
    return view.zoom * std::max(viewport.width, 1);
}

glm::dvec2 middle(const PixelRectangle& viewport) {
    return {viewport.x + 0.5 * viewport.width, viewport.y + 0.5 * viewport.height};
}

void settle(LatLongView& view, const PixelRectangle& viewport) {
    view.center.x -= std::floor(view.center.x);
    view.center.y = clamped_v(view.center.y, viewport.height / pixels_per_u(view, viewport));
}

} // namespace

glm::dvec2 lat_long(const glm::dvec3& direction) {
    const glm::dvec3 w = glm::normalize(direction);
    return {0.5 - std::atan2(w.x, w.z) / (2.0 * Pi),
            0.5 - std::asin(std::clamp(w.y, -1.0, 1.0)) / Pi};
}

glm::dvec3 direction_at(const glm::dvec2& uv) {
    const double longitude = Pi * (1.0 - 2.0 * uv.x);
    const double latitude = Pi * (0.5 - uv.y);
    return {std::sin(longitude) * std::cos(latitude), std::sin(latitude),
            std::cos(longitude) * std::cos(latitude)};
}

std::vector<glm::dvec2> unrolled(std::span<const glm::dvec3> line) {
    std::vector<glm::dvec2> result;
    result.reserve(line.size());
    for (const glm::dvec3& direction : line) {
        glm::dvec2 uv = lat_long(direction);
        if (!result.empty())
            uv.x += std::round(result.back().x - uv.x);
        result.push_back(uv);
    }
    return result;
}

glm::dvec2 LatLongView::uv_at(const PixelRectangle& viewport, const glm::dvec2& pixel) const {
    const glm::dvec2 from_middle = (pixel - middle(viewport)) / pixels_per_u(*this, viewport);
    return {center.x + from_middle.x, center.y + 2.0 * from_middle.y};
}

glm::dvec2 LatLongView::pixel_at(const PixelRectangle& viewport, const glm::dvec2& uv) const {
    const glm::dvec2 from_center(uv.x - center.x, 0.5 * (uv.y - center.y));
    return middle(viewport) + pixels_per_u(*this, viewport) * from_center;
}

std::optional<glm::dvec3> LatLongView::direction(const PixelRectangle& viewport,
                                                 const glm::dvec2& pixel) const {
    const glm::dvec2 uv = uv_at(viewport, pixel);
    if (uv.y < 0.0 || uv.y > 1.0)
        return std::nullopt;
    return direction_at(uv);
}

glm::dvec2 LatLongView::pixel_of(const PixelRectangle& viewport,
                                 const glm::dvec3& direction) const {
    glm::dvec2 uv = lat_long(direction);
    uv.x += std::round(center.x - uv.x);
    return pixel_at(viewport, uv);
}

void LatLongView::pan(const PixelRectangle& viewport, const glm::dvec2& pixels) {
    const glm::dvec2 moved = pixels / pixels_per_u(*this, viewport);
    center -= glm::dvec2(moved.x, 2.0 * moved.y);
    settle(*this, viewport);
}

void LatLongView::zoom_at(const PixelRectangle& viewport, const glm::dvec2& pixel, double steps) {
    constexpr double MaxZoom = 200.0;
    const glm::dvec2 under = uv_at(viewport, pixel);
    zoom = std::clamp(zoom * std::exp2(0.25 * steps), 1.0, MaxZoom);
    center += under - uv_at(viewport, pixel);
    settle(*this, viewport);
}

} // namespace relumine::viewer
