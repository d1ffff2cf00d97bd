// The overlaps of lat-long pixels and cube texels, in the plane of turns and heights.
//
// A direction of longitude l and polar angle p has the coordinates f = 1/2 - l / 2 pi (the image's
// own x) and y = -cos p. By Archimedes' theorem the solid angle of a region is 2 pi times its area
// in this plane, and lat-long pixels are plain rectangles.
//
// A texel's four edges become curves; chords replace them. Neighbouring texels share the chords, so
// the texels tile the plane, and the overlaps of a pixel add up to the pixel exactly.
//
//     face   f at (u, v)                     y
//     +Z     1/2 + atan(u) / 2 pi            v / sqrt(1 + u^2 + v^2)
//     +X, -Z, -X: as +Z, with 1/4 and 1/2 subtracted from f and 1/4 added to it
//     +Y     1/2 - atan2(u, -v) / 2 pi       1 - cos p
//     -Y     1/2 - atan2(u,  v) / 2 pi       -1 - cos p
//
// On +Y and -Y the height is measured from the pole. Otherwise it would lose all its digits there.
#include "cubemap/resample/resample_lat_long.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cubemap/grid_cut.h"
#include "cubemap/image/image_layout.h"

namespace relumine::cubemap::detail {

namespace {

constexpr double TwoPi = 2.0 * std::numbers::pi;

bool is_polar(Face face) {
    return face == Face::PositiveY || face == Face::NegativeY;
}

/// Returns f of the middle of a side face.
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

/// The texels of one row of a face as polygons in the plane of turns and heights.
///
/// Edges are computed once and shared by the texels on both sides. An edge is one or a few chords.
/// A chord that would cut off too much gets a corner in its middle, which makes the area under the
/// edge exact (spherical excess of the triangle of edge and pole). So a polygon has its texel's
/// solid angle to a few 1e-6 at every resolution.
class TexelRow {
public:
    TexelRow(Face face, std::uint32_t resolution, Sampling sampling)
        : face_(face), turn_(turn_of(face)), polar_(is_polar(face)), resolution_(resolution),
          borders_(cell_borders(resolution, sampling)),
          negligible_(NegligibleArea * 2.0 / (6.0 * resolution * resolution)) {}

    /// Makes row y the current row. This is cheaper if row y - 1 is current.
    void move_to(std::uint32_t y) {
        if (y != 0 && y == next_row_)
            std::swap(top_, bottom_);
        else
            make_line(y, top_);
        make_line(y + 1, bottom_);
        if (polar_)
            make_uprights();
        next_row_ = y + 1;
    }

    /// Computes the polygon of texel x of the current row.
    void polygon(std::uint32_t x, Polygon& out) {
        out.clear();
        out.push_back(top_.points[x].plane);
        append(top_, x, out);
        out.push_back(top_.points[x + 1].plane);
        if (polar_)
            append(uprights_, x + 1, out);
        out.push_back(bottom_.points[x + 1].plane);
        append_reversed(bottom_, x, out);
        out.push_back(bottom_.points[x].plane);
        if (polar_)
            append_reversed(uprights_, x, out);
        // Around u = 0 a polar texel may hold the pole or the seam of longitudes.
        if (polar_ && borders_[x] <= 0.5 && borders_[x + 1] >= 0.5)
            unroll(out);
    }

private:
    /// Longer chords get more corners: their ends say too little about the edge between them.
    static constexpr double ChordsPerRadian = 32.0;
    /// Area that chords may cut off, relative to a texel's area.
    static constexpr double NegligibleArea = 1e-6;

    /// A point of the face: its place on the face and in the plane, and values for the area under
    /// an edge.
    struct Point {
        glm::dvec2 uv{0.0};
        glm::dvec2 plane{0.0};
        /// Polar faces: (z, x) seen from the opposite pole.
        glm::dvec2 stereographic{0.0};
        /// Side faces: integral of the height from u = 0, in turns.
        double integral = 0.0;
    };
    /// A sequence of edges. Edge i has the inner corners [begins[i], begins[i + 1]).
    struct Edges {
        /// Ends of level edges.
        std::vector<Point> points;
        std::vector<glm::dvec2> corners;
        std::vector<std::size_t> begins;
    };

    [[nodiscard]] double coordinate(std::uint32_t i) const { return 2.0 * borders_[i] - 1.0; }

    [[nodiscard]] Point point(double u, double v) const {
        const double squared = u * u + v * v;
        const double root = std::sqrt(1.0 + squared);
        if (!polar_) {
            const double angle = std::atan(u);
            const double sine = u / std::sqrt(1.0 + u * u);
            return {{u, v},
                    {turn_ + angle / TwoPi, v / root},
                    {},
                    std::asin(v * sine / std::sqrt(1.0 + v * v)) / TwoPi};
        }
        const double side = face_ == Face::PositiveY ? 1.0 : -1.0;
        const glm::dvec2 zx(-side * v, u);
        return {{u, v},
                {0.5 - std::atan2(zx.y, zx.x) / TwoPi, side * squared / (root * (1.0 + root))},
                zx / (1.0 + root),
                0.0};
    }

    /// Only for polar faces.
    [[nodiscard]] static bool is_pole(const glm::dvec2& plane) { return plane.y == 0.0; }

    /// Returns the longitude `turn` in turns, moved by whole turns until it is within half a turn
    /// of the longitude before.
    [[nodiscard]] static double unrolled(double turn, double before) {
        return turn - std::round(turn - before);
    }

    /// Returns the integral of height over turns along the great circle from a to b.
    [[nodiscard]] double area_under(const Point& a, const Point& b) const {
        if (!polar_)
            return b.integral - a.integral;
        // The spherical excess of the triangle with the pole, from stereographic coordinates.
        const double tangent =
            (a.stereographic.x * b.stereographic.y - a.stereographic.y * b.stereographic.x) /
            (1.0 + glm::dot(a.stereographic, b.stereographic));
        const double squared = tangent * tangent;
        const double angle =
            squared < 1e-4
                ? tangent * (1.0 - squared * (1.0 / 3.0 - squared * (1.0 / 5.0 - squared / 7.0)))
                : std::atan(tangent);
        return (face_ == Face::PositiveY ? -2.0 : 2.0) * angle / TwoPi;
    }

    /// Adds the corner in the middle of the chord from a to b, if the chord cuts off more than
    /// `negligible`.
    void add_middle(const Point& a, const Point& b, double negligible,
                    std::vector<glm::dvec2>& corners) const {
        const double width = unrolled(b.plane.x, a.plane.x) - a.plane.x;
        const double missing = area_under(a, b) - 0.5 * (a.plane.y + b.plane.y) * width;
        if (std::abs(missing) > negligible)
            corners.emplace_back(a.plane.x + 0.5 * width,
                                 0.5 * (a.plane.y + b.plane.y) + 2.0 * missing / width);
    }

    void add_edge(const Point& from, const Point& to, std::vector<glm::dvec2>& corners) const {
        if (polar_ && (is_pole(from.plane) || is_pole(to.plane)))
            return; // a meridian
        const double angle = TwoPi * std::abs(unrolled(to.plane.x, from.plane.x) - from.plane.x);
        const int n = static_cast<int>(std::ceil(angle * ChordsPerRadian));
        const double negligible = negligible_ / std::max(n, 1);
        Point a = from;
        for (int i = 1; i < n; ++i) {
            const glm::dvec2 uv = from.uv + (to.uv - from.uv) * (static_cast<double>(i) / n);
            const Point b = point(uv.x, uv.y);
            add_middle(a, b, negligible, corners);
            corners.push_back(b.plane);
            a = b;
        }
        add_middle(a, to, negligible, corners);
    }

    void make_line(std::uint32_t y, Edges& line) const {
        line.points.clear();
        line.corners.clear();
        line.begins.assign(1, 0);
        for (std::uint32_t x = 0; x <= resolution_; ++x) {
            line.points.push_back(point(coordinate(x), coordinate(y)));
            if (x == 0)
                continue;
            add_edge(line.points[x - 1], line.points[x], line.corners);
            line.begins.push_back(line.corners.size());
        }
    }

    /// Makes the edges between the two lines. On side faces these are meridians.
    void make_uprights() {
        uprights_.corners.clear();
        uprights_.begins.assign(1, 0);
        for (std::uint32_t x = 0; x <= resolution_; ++x) {
            add_edge(top_.points[x], bottom_.points[x], uprights_.corners);
            uprights_.begins.push_back(uprights_.corners.size());
        }
    }

    static void append(const Edges& edges, std::size_t edge, Polygon& out) {
        for (std::size_t i = edges.begins[edge]; i < edges.begins[edge + 1]; ++i)
            out.push_back(edges.corners[i]);
    }
    static void append_reversed(const Edges& edges, std::size_t edge, Polygon& out) {
        for (std::size_t i = edges.begins[edge + 1]; i > edges.begins[edge]; --i)
            out.push_back(edges.corners[i - 1]);
    }

    /// Makes longitudes continuous along the outline of a polar texel.
    void unroll(Polygon& out) {
        raw_.assign(out.begin(), out.end());
        out.clear();
        if (is_pole(raw_.front()))
            std::rotate(raw_.begin(), raw_.begin() + 1, raw_.end());
        double turn = raw_.front().x;
        for (std::size_t i = 0; i < raw_.size(); ++i) {
            if (is_pole(raw_[i])) {
                // Edges into and out of the pole are meridians. Between them the outline runs along
                // the pole.
                out.emplace_back(turn, 0.0);
                turn = unrolled(raw_[(i + 1) % raw_.size()].x, turn);
                out.emplace_back(turn, 0.0);
            } else {
                turn = unrolled(raw_[i].x, turn);
                out.emplace_back(turn, raw_[i].y);
            }
        }
        // An outline around the pole ends one whole turn from its start. The line of the pole
        // closes it.
        const glm::dvec2 first = out.front();
        turn = unrolled(first.x, turn);
        if (std::abs(turn - first.x) > 0.5) {
            out.emplace_back(turn, first.y);
            out.emplace_back(turn, 0.0);
            out.emplace_back(first.x, 0.0);
        }
    }

    Face face_;
    double turn_;
    bool polar_;
    std::uint32_t resolution_;
    /// Borders of texels in [0, 1].
    std::vector<double> borders_;
    /// Area that an edge's chords may cut off.
    double negligible_;
    std::uint32_t next_row_ = 0;
    Edges top_, bottom_, uprights_;
    Polygon raw_;
};

/// Returns the image's row borders as heights in the face's measure.
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

/// Returns the solid angles of one face's cells, [R * R] row by row.
std::vector<double> cell_solid_angles(std::uint32_t resolution, Sampling sampling) {
    if (sampling == Sampling::TexelCentres)
        return texel_solid_angles(resolution);
    const std::vector<double> borders = cell_borders(resolution, sampling);
    std::vector<double> angles;
    angles.reserve(static_cast<std::size_t>(resolution) * resolution);
    for (std::size_t y = 0; y < resolution; ++y) {
        for (std::size_t x = 0; x < resolution; ++x)
            angles.push_back(solid_angle(borders[x], borders[y], borders[x + 1], borders[y + 1]));
    }
    return angles;
}

} // namespace

CubeMap cube_from_lat_long(const EnvironmentImage& image, std::uint32_t resolution,
                           Sampling sampling) {
    CubeMap map(resolution);
    const std::vector<double> solid_angles = cell_solid_angles(resolution, sampling);
    const std::vector<double> column_borders = cell_borders(image.width, image.sampling);
    for (const Face face : AllFaces) {
        const std::vector<double> heights = row_heights(image, face);
        tbb::parallel_for(
            tbb::blocked_range<std::uint32_t>(0, resolution), [&](const auto& rows_of_texels) {
                GridLines columns(column_borders, true);
                GridLines rows(heights, false);
                GridCutter cutter;
                TexelRow texels(face, resolution, sampling);
                Polygon polygon;
                for (std::uint32_t y = rows_of_texels.begin(); y != rows_of_texels.end(); ++y) {
                    texels.move_to(y);
                    for (std::uint32_t x = 0; x < resolution; ++x) {
                        texels.polygon(x, polygon);
                        glm::dvec3 sum(0.0);
                        cutter.cut(polygon, columns, rows,
                                   [&](std::size_t column, std::size_t row, const Polygon& piece) {
                                       const double overlap = area(piece);
                                       // An infinite pixel that only touches the texel must not
                                       // matter.
                                       if (overlap != 0.0)
                                           sum += glm::dvec3(
                                                      image.pixels[row * image.width + column]) *
                                                  overlap;
                                   });
                        map.at(face, x, y) =
                            sum *
                            (TwoPi / solid_angles[static_cast<std::size_t>(y) * resolution + x]);
                    }
                }
            });
    }
    return map;
}

} // namespace relumine::cubemap::detail
