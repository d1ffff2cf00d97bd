#include "cubemap/resample/pixel_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/image/projection.h"

namespace relumine::cubemap {

namespace {

constexpr double TurnOfLongitude = 2.0 * std::numbers::pi;

/// Returns a rectangle of turns and heights of a lat-long image, in [0, 1].
PixelPlace lat_long_part(double left, double top, double right, double bottom) {
    const double top_cosine = std::cos(top * std::numbers::pi);
    const double bottom_cosine = std::cos(bottom * std::numbers::pi);
    const double cosine = 0.5 * (top_cosine + bottom_cosine);
    const double sine = std::sqrt(std::max(1.0 - cosine * cosine, 0.0));
    const double longitude = (0.5 - 0.5 * (left + right)) * TurnOfLongitude;
    return {.direction = {sine * std::sin(longitude), cosine, sine * std::cos(longitude)},
            .solid_angle = (right - left) * TurnOfLongitude * (top_cosine - bottom_cosine)};
}

} // namespace

PixelParts::PixelParts(const ImageShape& shape)
    : projection_(projection(shape.layout)), width_(shape.width), height_(shape.height) {
    if (has_faces(shape.layout)) {
        squares_.emplace(shape.layout, shape.width, shape.height);
        width_ = height_ = squares_->resolution();
    } else if (!fits(shape.layout, shape.width, shape.height)) {
        throw std::invalid_argument(fmt::format("expected a size that fits a {} image, got {}x{}",
                                                name(shape.layout), shape.width, shape.height));
    }
    columns_ = cell_borders(width_, shape.sampling);
    rows_ = cell_borders(height_, shape.sampling);
}

void PixelParts::append(std::uint32_t panel, std::uint32_t x, std::uint32_t y, std::uint32_t n,
                        std::vector<PixelPlace>& parts) const {
    const auto border = [n](const std::vector<double>& borders, std::uint32_t cell,
                            std::uint32_t i) {
        const double part = static_cast<double>(i) / n;
        return borders[cell] + part * (borders[cell + 1] - borders[cell]);
    };
    for (std::uint32_t row = 0; row < n; ++row)
        for (std::uint32_t column = 0; column < n; ++column) {
            const double left = border(columns_, x, column);
            const double right = border(columns_, x, column + 1);
            const double top = border(rows_, y, row);
            const double bottom = border(rows_, y, row + 1);
            const glm::dvec2 middle(0.5 * (left + right), 0.5 * (top + bottom));
            if (squares_) {
                parts.push_back({.direction = direction(AllFaces[panel], middle.x, middle.y),
                                 .solid_angle = solid_angle(left, top, right, bottom)});
            } else if (projection_ == nullptr) {
                parts.push_back(lat_long_part(left, top, right, bottom));
            } else if (!projection_->is_disc() || glm::distance(middle, glm::dvec2(0.5)) < 0.5) {
                parts.push_back({.direction = projection_->direction(middle),
                                 .solid_angle = projection_->density(middle) * (right - left) *
                                                (bottom - top)});
            }
        }
}

} // namespace relumine::cubemap
