// A lat-long environment as patches of constant radiance on the sphere. All methods that place
// lights work on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "cubemap/image/environment.h"
#include "lights/luminance.h"
#include "lights/pixel_rectangle.h"

namespace relumine::lights {

/// A lat-long image with the place of its pixels. Refers to the image's pixels: the image must
/// outlive it.
class LatLongGrid {
public:
    /// Throws:  std::invalid_argument for another layout, a wrong number of pixels, or radiance
    ///          that is negative or not finite.
    explicit LatLongGrid(const cubemap::EnvironmentImage& image);

    [[nodiscard]] std::uint32_t width() const {
        return static_cast<std::uint32_t>(columns_.size());
    }
    [[nodiscard]] std::uint32_t height() const { return static_cast<std::uint32_t>(rows_.size()); }
    [[nodiscard]] std::size_t num_pixels() const { return pixels_.size(); }
    [[nodiscard]] PixelRectangle whole() const { return {0, 0, width(), height()}; }

    [[nodiscard]] glm::dvec3 radiance(std::uint32_t x, std::uint32_t y) const {
        return pixels_[std::size_t{y} * width() + x];
    }
    [[nodiscard]] double solid_angle(std::uint32_t x, std::uint32_t y) const {
        return rows_[y].height * columns_[x].width;
    }
    /// Returns the pixel's energy: luminance times solid angle.
    [[nodiscard]] double energy(std::uint32_t x, std::uint32_t y) const {
        return luminance(radiance(x, y)) * solid_angle(x, y);
    }
    /// Returns the integral of w over the pixel's footprint in x, y and z, and the footprint's
    /// solid angle in w.
    [[nodiscard]] glm::dvec4 moments(std::uint32_t x, std::uint32_t y) const {
        const Row& row = rows_[y];
        const Column& column = columns_[x];
        return {row.across * column.sine, row.upwards * column.width, row.across * column.cosine,
                row.height * column.width};
    }

    [[nodiscard]] double solid_angle(const PixelRectangle& region) const;
    /// Returns the width of a region in radians, weighted by the cosine of the inclination at its
    /// centre [D05].
    [[nodiscard]] double angular_width(const PixelRectangle& region) const;
    /// Returns the height of a region in radians.
    [[nodiscard]] double angular_height(const PixelRectangle& region) const;
    /// Returns the unit direction of a region's centre in the image.
    [[nodiscard]] glm::dvec3 centre(const PixelRectangle& region) const;
    /// Returns a unit direction inside a pixel: at a fraction of its width from the left and of its
    /// solid angle from the top.
    [[nodiscard]] glm::dvec3 direction(std::uint32_t x, std::uint32_t y, double across,
                                       double down) const;

private:
    /// Polar angles of a row's borders, and three integrals over the row per unit of longitude: its
    /// solid angle, and the sine and cosine of the polar angle over solid angle.
    struct Row {
        double top, bottom, height, across, upwards;
    };
    /// Longitudes of a column's borders, and three integrals over the column: of 1, sine and cosine
    /// of the longitude.
    struct Column {
        double left, right, width, sine, cosine;
    };
    std::vector<Row> rows_;
    std::vector<Column> columns_;
    std::span<const glm::vec3> pixels_;
};

} // namespace relumine::lights
