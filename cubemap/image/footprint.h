// Footprints: the parts of the sphere that the pixels of a picture stand for, as spherical
// polygons.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/image/image_layout.h"
#include "cubemap/image/projection.h"

namespace relumine::cubemap {

/// Finds the footprint of a pixel of a Projection.
///
/// A footprint comes in pieces well within a half-sphere. Its edges are curves on the sphere;
/// chords replace them with an error below 1e-4 of a pixel. Neighbours share these chords, so
/// footprints tile the sphere. A pixel on the rim of a disc keeps its part inside the disc. The rim
/// itself shrinks to the one direction that it shows.
///
/// Threads: use one object per thread; it keeps its buffers.
class ProjectionFootprints {
public:
    ProjectionFootprints(const Projection& projection, std::uint32_t width, std::uint32_t height);

    /// Returns true if the whole pixel shows a part of the sphere.
    [[nodiscard]] bool is_whole(std::uint32_t x, std::uint32_t y) const;

    /// Calls `visit(std::span<const glm::dvec3>)` with the unit corners of each piece, clockwise
    /// seen from the middle of the sphere.
    template<typename Visit>
    void visit(std::uint32_t x, std::uint32_t y, const Visit& visit) {
        const glm::dvec2 size(1.0 / width_, 1.0 / height_);
        visit_part({glm::dvec2(x, y) * size, glm::dvec2(x + 1, y + 1) * size}, 0, visit);
    }

private:
    static constexpr int DeepestPart = 8;

    struct Rectangle {
        glm::dvec2 low, high;
    };
    /// A corner of a piece. `along_rim`: the way to the next corner is the disc's rim.
    struct Corner {
        glm::dvec2 point;
        bool along_rim;
        glm::dvec3 direction = glm::dvec3(0.0);
    };

    /// Puts the corners of the rectangle's part that shows something into corners_, without
    /// directions. Returns false if there is no such part.
    bool clip(const Rectangle& rectangle);
    /// Returns true if the piece of corners_ is small enough for one polygon.
    [[nodiscard]] bool is_small(const Rectangle& rectangle) const;
    void make_outline();
    void add_edge(const glm::dvec2& from, const glm::dvec3& from_direction, const glm::dvec2& to,
                  const glm::dvec3& to_direction, int depth);

    template<typename Visit>
    void visit_part(const Rectangle& part, int depth, const Visit& visit) {
        if (!clip(part))
            return;
        for (Corner& corner : corners_)
            corner.direction = projection_.direction(corner.point);
        if (depth < DeepestPart && !is_small(part)) {
            const glm::dvec2 middle = 0.5 * (part.low + part.high);
            visit_part({part.low, middle}, depth + 1, visit);
            visit_part({{middle.x, part.low.y}, {part.high.x, middle.y}}, depth + 1, visit);
            visit_part({{part.low.x, middle.y}, {middle.x, part.high.y}}, depth + 1, visit);
            visit_part({middle, part.high}, depth + 1, visit);
            return;
        }
        make_outline();
        if (outline_.size() >= 3)
            visit(std::span<const glm::dvec3>(outline_));
    }

    const Projection& projection_;
    double width_, height_;
    bool is_disc_, is_mirrored_;
    /// Largest distance between a chord and its edge.
    double tolerance_;
    std::vector<Corner> corners_;
    std::vector<glm::dvec3> outline_;
};

/// Finds the footprint of a pixel of a lat-long. Short arcs of great circles replace the parallels.
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

/// Returns the solid angle of a spherical polygon within a half-sphere. The value is positive if
/// the corners run clockwise seen from the middle of the sphere.
[[nodiscard]] double solid_angle(std::span<const glm::dvec3> corners);

} // namespace relumine::cubemap
