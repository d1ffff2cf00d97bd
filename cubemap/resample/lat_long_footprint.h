// Footprints: the parts of the sphere that the pixels of a lat-long stand for, as spherical
// polygons.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

/// Finds a pixel's footprint. Short arcs of great circles replace the parallels.
///
/// Threads: use one object per thread; it keeps its buffers.
class LatLongFootprints {
public:
    explicit LatLongFootprints(const ImageShape& shape)
        : columns_(cell_borders(shape.width, shape.sampling)),
          rows_(cell_borders(shape.height, shape.sampling)) {}

    /// Calls `visit(std::span<const glm::dvec3>)` with the unit corners of each piece, clockwise
    /// seen from the middle of the sphere.
    template<typename Visit>
    void visit(std::uint32_t x, std::uint32_t y, const Visit& visit) {
        constexpr double Pi = std::numbers::pi;
        // An arc of angle d in place of a parallel moves less than d^2 / 12 of a pixel's area: 1e-6
        // at this number of arcs per turn.
        constexpr double ArcsPerTurn = 1536.0;
        // Larger footprints are divided, so every part lies well within a half-sphere.
        constexpr double LargestPart = Pi / 8.0;
        const double top = Pi * rows_[y], bottom = Pi * rows_[y + 1];
        const double left = 2.0 * Pi * (0.5 - columns_[x]),
                     right = 2.0 * Pi * (0.5 - columns_[x + 1]);
        const int parts_down = static_cast<int>(std::ceil((bottom - top) / LargestPart));
        const int parts_across = static_cast<int>(std::ceil((left - right) / LargestPart));
        const int arcs =
            static_cast<int>(std::ceil((left - right) / parts_across / (2.0 * Pi) * ArcsPerTurn));
        for (int part = 0; part < parts_down * parts_across; ++part) {
            const int i = part % parts_across, j = part / parts_across;
            const auto longitude = [&](int arc) {
                return left + (right - left) * (i + static_cast<double>(arc) / arcs) / parts_across;
            };
            const auto polar = [&](int k) {
                return top + (bottom - top) * k / parts_down;
            };
            outline_.clear();
            for (int arc = 0; arc <= arcs; ++arc)
                outline_.push_back(point(longitude(arc), polar(j)));
            for (int arc = arcs; arc >= 0; --arc)
                outline_.push_back(point(longitude(arc), polar(j + 1)));
            visit(std::span<const glm::dvec3>(outline_));
        }
    }

private:
    [[nodiscard]] static glm::dvec3 point(double longitude, double polar) {
        return {std::sin(polar) * std::sin(longitude), std::cos(polar),
                std::sin(polar) * std::cos(longitude)};
    }

    std::vector<double> columns_, rows_;
    std::vector<glm::dvec3> outline_;
};

} // namespace relumine::cubemap
