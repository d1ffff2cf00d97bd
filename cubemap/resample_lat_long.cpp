// The overlaps of lat-long pixels and cube texels, in the plane of turns and heights.
//
// A direction of longitude l and polar angle p has the coordinates f = 1/2 - l / 2 pi (the image's own x) and y = -cos p. By
// Archimedes' theorem the solid angle of a region is 2 pi times its area there, and lat-long pixels are plain
// rectangles. A texel's four edges become curves, which are replaced by short chords; neighbouring texels share
// them, so the texels tile the plane and a pixel's overlaps add up to the pixel exactly.
//
//     face   f at (u, v)                     y
//     +Z     1/2 + atan(u) / 2 pi            v / sqrt(1 + u^2 + v^2)       +X: f - 1/4,  -Z: f - 1/2,  -X: f + 1/4
//     +Y     1/2 - atan2(u, -v) / 2 pi       1 - cos p
//     -Y     1/2 - atan2(u,  v) / 2 pi       -1 - cos p
//
// On +Y and -Y the height is measured from the pole, where it would lose all its digits otherwise.
#include "cubemap/resample_lat_long.h"

#include <cmath>
#include <numbers>

#include <glm/vec2.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cubemap/grid_cut.h"
#include "cubemap/image_layout.h"

namespace relumine::cubemap::detail {

namespace {

constexpr double TwoPi = 2.0 * std::numbers::pi;

bool is_polar(Face face) {
    return face == Face::PositiveY || face == Face::NegativeY;
}

/// f of the middle of a side face.
double turn_of(Face face) {
    switch (face) {
    case Face::PositiveX:
        return 0.25;
    case Face::NegativeX:
        return 0.75;
    case Face::PositiveZ:
        return 0.5;
    default:
        return 0.0;
    }
}

/// Makes the polygons of a face's texels. Points of a face are (u, v) in [-1, 1]^2.
class TexelPolygons {
public:
    explicit TexelPolygons(Face face) : face_(face), turn_(turn_of(face)), polar_(is_polar(face)) {}

    /// The texel [u0, u1] x [v0, v1] in the plane of turns and heights.
    void make(double u0, double v0, double u1, double v1, Polygon& polygon) const {
        polygon.clear();
        const std::array<glm::dvec2, 4> corners = {glm::dvec2{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}};
        if (polar_) {
            make_polar(corners, polygon);
            return;
        }
        add_level_edge(corners[0], corners[1], polygon);
        add_level_edge(corners[2], corners[3], polygon);
    }

private:
    // A chord across an angle d cuts off d^2 / 12 of a texel's area on the side faces, and up to 0.7 d^2 on the polar ones (where
    // the pole is as near as the edge is long): at most 3e-6 with these numbers.
    static constexpr double ChordsPerRadian = 192.0;
    static constexpr double PolarChordsPerRadian = 512.0;

    [[nodiscard]] static int num_chords(double angle, double per_radian) {
        return std::max(1, static_cast<int>(std::ceil(angle * per_radian)));
    }

    /// An edge of constant v of a side face, both ends included. (Edges of constant u are meridians: straight.)
    void add_level_edge(const glm::dvec2& from, const glm::dvec2& to, Polygon& polygon) const {
        const double from_angle = std::atan(from.x), to_angle = std::atan(to.x);
        const int n = num_chords(std::abs(to_angle - from_angle), ChordsPerRadian);
        for (int i = 0; i <= n; ++i) {
            const double u = i == n ? to.x : from.x + (to.x - from.x) * i / n;
            const double angle = i == 0 ? from_angle : i == n ? to_angle : std::atan(u);
            polygon.emplace_back(turn_ + angle / TwoPi, from.y / std::sqrt(1.0 + u * u + from.y * from.y));
        }
    }

    /// Longitude in turns, at any point of a polar face but the pole.
    [[nodiscard]] double polar_turn(const glm::dvec2& point) const {
        return 0.5 - std::atan2(point.x, face_ == Face::PositiveY ? -point.y : point.y) / TwoPi;
    }

    /// Height measured from the pole, without cancellation.
    [[nodiscard]] double polar_height(const glm::dvec2& point) const {
        const double squared = point.x * point.x + point.y * point.y;
        const double root = std::sqrt(1.0 + squared);
        const double height = squared / (root * (1.0 + root));
        return face_ == Face::PositiveY ? height : -height;
    }

    void make_polar(const std::array<glm::dvec2, 4>& corners, Polygon& polygon) const {
        const auto is_pole = [](const glm::dvec2& p) {
            return p.x == 0.0 && p.y == 0.0;
        };
        const std::size_t start = is_pole(corners[0]) ? 1 : 0;
        double turn = polar_turn(corners[start]); // continuous along the outline, so it may leave [0, 1]
        const double first_turn = turn;
        const auto unrolled = [&](double next) {
            return next - std::round(next - turn);
        };
        for (std::size_t edge = 0; edge < 4; ++edge) {
            const glm::dvec2 from = corners[(start + edge) % 4], to = corners[(start + edge + 1) % 4];
            if (is_pole(from) || is_pole(to)) {
                // An edge into or out of the pole is a meridian: it keeps the longitude of its other end.
                turn = unrolled(polar_turn(is_pole(from) ? to : from));
                polygon.emplace_back(turn, polar_height(from));
                if (is_pole(to))
                    polygon.emplace_back(turn, 0.0);
                continue;
            }
            const double angle =
                std::atan2(std::abs(from.x * to.y - from.y * to.x), from.x * to.x + from.y * to.y);
            const int n = num_chords(angle, PolarChordsPerRadian);
            for (int i = 0; i < n; ++i) {
                const glm::dvec2 point = i == 0 ? from : from + (to - from) * (static_cast<double>(i) / n);
                turn = unrolled(polar_turn(point));
                polygon.emplace_back(turn, polar_height(point));
            }
        }
        // An outline around the pole ends a whole turn away from its start; the pole itself is the line that closes it.
        turn = unrolled(polar_turn(corners[start]));
        if (std::abs(turn - first_turn) > 0.5) {
            polygon.emplace_back(turn, polygon.front().y);
            polygon.emplace_back(turn, 0.0);
            polygon.emplace_back(first_turn, 0.0);
        }
    }

    Face face_;
    double turn_;
    bool polar_;
};

/// The image's row borders as heights, as the face measures them.
std::vector<double> row_heights(const EnvironmentImage& image, Face face) {
    std::vector<double> heights = cell_borders(image.height, image.sampling);
    for (double& border : heights) {
        const double polar = std::numbers::pi * border;
        if (face == Face::PositiveY)
            border = 2.0 * std::pow(std::sin(0.5 * polar), 2);
        else if (face == Face::NegativeY)
            border = -2.0 * std::pow(std::sin(0.5 * (std::numbers::pi - polar)), 2);
        else
            border = -std::cos(polar);
    }
    return heights;
}

} // namespace

CubeMap cube_from_lat_long(const EnvironmentImage& image, std::uint32_t resolution) {
    CubeMap map(resolution);
    const std::vector<double> solid_angles = texel_solid_angles(resolution);
    const std::vector<double> column_borders = cell_borders(image.width, image.sampling);
    const auto coordinate = [&](std::uint32_t i) {
        return 2.0 * (i / static_cast<double>(resolution)) - 1.0;
    };
    for (const Face face : AllFaces) {
        const TexelPolygons texels(face);
        const std::vector<double> heights = row_heights(image, face);
        tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, resolution), [&](const auto& rows_of_texels) {
            GridLines columns(column_borders, true);
            GridLines rows(heights, false);
            GridCutter cutter;
            Polygon polygon;
            for (std::uint32_t y = rows_of_texels.begin(); y != rows_of_texels.end(); ++y) {
                for (std::uint32_t x = 0; x < resolution; ++x) {
                    texels.make(coordinate(x), coordinate(y), coordinate(x + 1), coordinate(y + 1), polygon);
                    glm::dvec3 sum(0.0);
                    cutter.cut(polygon, columns, rows,
                               [&](std::size_t column, std::size_t row, const Polygon& piece) {
                                   const double overlap = area(piece);
                                   if (overlap != 0.0) // an infinite pixel that only touches must not matter
                                       sum += glm::dvec3(image.pixels[row * image.width + column]) * overlap;
                               });
                    map.at(face, x, y) =
                        sum * (TwoPi / solid_angles[static_cast<std::size_t>(y) * resolution + x]);
                }
            }
        });
    }
    return map;
}

} // namespace relumine::cubemap::detail
