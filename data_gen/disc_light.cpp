// Round lights, exact to the rim.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "data_gen/environments.h"

namespace relumine::data_gen {
namespace {

// Rectangle of a face in its coordinates s, t.
struct Cell {
    cubemap::Face face;
    double s0, t0, s1, t1;
    [[nodiscard]] double solid_angle() const { return cubemap::solid_angle(s0, t0, s1, t1); }
    // Corners in turn around the cell.
    [[nodiscard]] std::array<glm::dvec3, 4> corners() const {
        return {cubemap::direction(face, s0, t0), cubemap::direction(face, s1, t0),
                cubemap::direction(face, s1, t1), cubemap::direction(face, s0, t1)};
    }
};

// Angle between two unit vectors, accurate for tiny angles as well.
double angle(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Part of a square in which a function that is linear along the edges is positive; values at the corners in turn.
double positive_fraction(const std::array<double, 4>& values) {
    static constexpr std::array<std::array<double, 2>, 4> Corners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    std::array<glm::dvec2, 8> polygon;
    std::size_t size = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        const glm::dvec2 here(Corners[k][0], Corners[k][1]);
        const glm::dvec2 there(Corners[next][0], Corners[next][1]);
        if (values[k] > 0.0) {
            polygon[size++] = here;
        }
        if ((values[k] > 0.0) != (values[next] > 0.0)) {
            polygon[size++] = here + (there - here) * (values[k] / (values[k] - values[next]));
        }
    }
    double doubled_area = 0.0;
    for (std::size_t k = 0; k < size; ++k) {
        const glm::dvec2& a = polygon[k];
        const glm::dvec2& b = polygon[(k + 1) % size];
        doubled_area += a.x * b.y - a.y * b.x;
    }
    return 0.5 * doubled_area;
}

class Disc {
public:
    Disc(const glm::dvec3& direction, double radius) : direction_(direction), radius_(radius) {}

    enum class Overlap { None, Part, All };
    struct Bound {
        Overlap overlap;
        double cell_radius; ///< of a cone around the cell
    };

    // From a cone around the cell, so All and None are certain and Part is not.
    [[nodiscard]] Bound bound(const Cell& cell) const {
        const glm::dvec3 center =
            cubemap::direction(cell.face, 0.5 * (cell.s0 + cell.s1), 0.5 * (cell.t0 + cell.t1));
        double cell_radius = 0.0;
        for (const glm::dvec3& corner : cell.corners()) {
            cell_radius = std::max(cell_radius, angle(center, corner));
        }
        const double distance = angle(center, direction_);
        if (distance >= radius_ + cell_radius) {
            return {Overlap::None, cell_radius};
        }
        return {distance + cell_radius <= radius_ ? Overlap::All : Overlap::Part, cell_radius};
    }

    // Solid angle of the cell within the disc: quartered until the rim is as good as straight.
    [[nodiscard]] double covered(const Cell& cell) const {
        const auto [overlap, cell_radius] = bound(cell);
        if (overlap == Overlap::None) {
            return 0.0;
        }
        if (overlap == Overlap::All) {
            return cell.solid_angle();
        }
        // Chords of a circle that span 1/32 of its radius miss (1/32)^2 / 6 = 0.016 % of its area.
        if (cell_radius < radius_ / 64.0) {
            std::array<double, 4> depth = {};
            const auto corners = cell.corners();
            std::transform(corners.begin(), corners.end(), depth.begin(),
                           [&](const glm::dvec3& corner) { return radius_ - angle(corner, direction_); });
            return positive_fraction(depth) * cell.solid_angle();
        }
        const double s = 0.5 * (cell.s0 + cell.s1);
        const double t = 0.5 * (cell.t0 + cell.t1);
        return covered({cell.face, cell.s0, cell.t0, s, t}) + covered({cell.face, s, cell.t0, cell.s1, t}) +
               covered({cell.face, cell.s0, t, s, cell.t1}) + covered({cell.face, s, t, cell.s1, cell.t1});
    }

private:
    glm::dvec3 direction_;
    double radius_;
};

// Texels [x0, x1) x [y0, y1) of a face.
struct TexelRange {
    std::uint32_t x0, y0, x1, y1;
};

void add_to_range(cubemap::CubeMap& map, cubemap::Face face, const TexelRange& range, const Disc& disc,
                  const glm::vec3& radiance) {
    const double texel = 1.0 / map.resolution;
    const Cell cell{face, range.x0 * texel, range.y0 * texel, range.x1 * texel, range.y1 * texel};
    const Disc::Overlap overlap = disc.bound(cell).overlap;
    if (overlap == Disc::Overlap::None) {
        return;
    }
    const std::uint32_t width = range.x1 - range.x0;
    const std::uint32_t height = range.y1 - range.y0;
    if (overlap == Disc::Overlap::All || (width == 1 && height == 1)) {
        const auto part =
            static_cast<float>(overlap == Disc::Overlap::All ? 1.0 : disc.covered(cell) / cell.solid_angle());
        for (std::uint32_t y = range.y0; y < range.y1; ++y) {
            for (std::uint32_t x = range.x0; x < range.x1; ++x) {
                map.at(face, x, y) += part * radiance;
            }
        }
    } else if (width >= height) {
        const std::uint32_t middle = range.x0 + width / 2;
        add_to_range(map, face, {range.x0, range.y0, middle, range.y1}, disc, radiance);
        add_to_range(map, face, {middle, range.y0, range.x1, range.y1}, disc, radiance);
    } else {
        const std::uint32_t middle = range.y0 + height / 2;
        add_to_range(map, face, {range.x0, range.y0, range.x1, middle}, disc, radiance);
        add_to_range(map, face, {range.x0, middle, range.x1, range.y1}, disc, radiance);
    }
}

} // namespace

void add_disc(cubemap::CubeMap& map, const glm::dvec3& direction, double angular_radius_degrees,
              const glm::vec3& radiance) {
    const double length = glm::length(direction);
    if (!(length > 0.0) || !std::isfinite(length)) {
        throw std::invalid_argument("disc light: expected a direction other than zero");
    }
    if (!(angular_radius_degrees > 0.0 && angular_radius_degrees <= 90.0)) {
        throw std::invalid_argument(
            fmt::format("disc light: expected an angular radius above 0 and up to 90 degrees, got {}",
                        angular_radius_degrees));
    }
    const Disc disc(direction / length, angular_radius_degrees * std::numbers::pi / 180.0);
    for (const cubemap::Face face : cubemap::AllFaces) {
        add_to_range(map, face, {0, 0, map.resolution, map.resolution}, disc, radiance);
    }
}

cubemap::CubeMap disc_light(std::uint32_t resolution, const glm::dvec3& direction,
                            double angular_radius_degrees, const glm::vec3& radiance) {
    cubemap::CubeMap map(resolution);
    add_disc(map, direction, angular_radius_degrees, radiance);
    return map;
}

} // namespace relumine::data_gen
