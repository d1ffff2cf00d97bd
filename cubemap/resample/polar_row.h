// The texels of +Y in the plane of turns and heights.
#pragma once

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "cubemap/grid_cut.h"
#include "cubemap/resample/lat_long_plane.h"
#include "cubemap/resample/resample.h"

namespace relumine::cubemap::detail {

/// The texels of one row of +Y as polygons in the plane of turns and heights.
///
/// Edges are computed once and shared by the texels on both sides. An edge is one or a few chords.
/// A chord that would cut off too much gets a corner in its middle, which makes the area under the
/// edge exact (spherical excess of the triangle of edge and pole). So a polygon has its texel's
/// solid angle to a few 1e-6 at every resolution.
class PolarRow {
public:
    PolarRow(std::uint32_t resolution, Sampling sampling)
        : resolution_(resolution), borders_(cell_borders(resolution, sampling)),
          negligible_(NegligibleArea * 2.0 / (6.0 * resolution * resolution)) {}

    /// Makes row y the current row. This is cheaper if row y - 1 is current.
    void move_to(std::uint32_t y) {
        if (y != 0 && y == next_row_)
            std::swap(top_, bottom_);
        else
            make_line(y, top_);
        make_line(y + 1, bottom_);
        make_uprights();
        next_row_ = y + 1;
    }

    /// Computes the polygon of texel x of the current row.
    void polygon(std::uint32_t x, Polygon& out) {
        out.clear();
        out.push_back(top_.points[x].plane);
        append(top_, x, out);
        out.push_back(top_.points[x + 1].plane);
        append(uprights_, x + 1, out);
        out.push_back(bottom_.points[x + 1].plane);
        append_reversed(bottom_, x, out);
        out.push_back(bottom_.points[x].plane);
        append_reversed(uprights_, x, out);
        // Around u = 0 a texel may hold the pole or the seam of longitudes.
        if (borders_[x] <= 0.5 && borders_[x + 1] >= 0.5)
            unroll(out);
    }

    /// Returns the part of the plane that holds texel x of the current row. Nothing for texels at
    /// the pole or at the seam of longitudes, and for those across u = 0 or v = 0, whose edges may
    /// reach beyond their corners.
    struct Box {
        glm::dvec2 low, high;
    };
    [[nodiscard]] std::optional<Box> box(std::uint32_t x) const {
        const std::uint32_t y = next_row_ - 1;
        const bool touches = borders_[x] <= 0.5 && borders_[x + 1] >= 0.5;
        if ((touches && borders_[y + 1] >= 0.5) || (borders_[x] < 0.5 && borders_[x + 1] > 0.5) ||
            (borders_[y] < 0.5 && borders_[y + 1] > 0.5))
            return std::nullopt;
        const glm::dvec2 &a = top_.points[x].plane, &b = top_.points[x + 1].plane,
                         &c = bottom_.points[x].plane, &d = bottom_.points[x + 1].plane;
        return Box{glm::min(glm::min(a, b), glm::min(c, d)),
                   glm::max(glm::max(a, b), glm::max(c, d))};
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
        /// (z, x) seen from the opposite pole.
        glm::dvec2 stereographic{0.0};
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
        const glm::dvec2 zx(-v, u);
        return {{u, v},
                {0.5 - std::atan2(zx.y, zx.x) / RadiansPerTurn, squared / (root * (1.0 + root))},
                zx / (1.0 + root)};
    }

    [[nodiscard]] static bool is_pole(const glm::dvec2& plane) { return plane.y == 0.0; }

    /// Returns the longitude `turn` in turns, moved by whole turns until it is within half a turn
    /// of the longitude before.
    [[nodiscard]] static double unrolled(double turn, double before) {
        return turn - std::round(turn - before);
    }

    /// Returns the integral of height over turns along the great circle from a to b.
    [[nodiscard]] double area_under(const Point& a, const Point& b) const {
        // The spherical excess of the triangle with the pole, from stereographic coordinates.
        const double tangent =
            (a.stereographic.x * b.stereographic.y - a.stereographic.y * b.stereographic.x) /
            (1.0 + glm::dot(a.stereographic, b.stereographic));
        const double squared = tangent * tangent;
        const double angle =
            squared < 1e-4
                ? tangent * (1.0 - squared * (1.0 / 3.0 - squared * (1.0 / 5.0 - squared / 7.0)))
                : std::atan(tangent);
        return -2.0 * angle / RadiansPerTurn;
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
        if (is_pole(from.plane) || is_pole(to.plane))
            return; // a meridian
        const double angle =
            RadiansPerTurn * std::abs(unrolled(to.plane.x, from.plane.x) - from.plane.x);
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

    /// Makes the edges between the two lines.
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

    /// Makes longitudes continuous along the outline of a texel.
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

    std::uint32_t resolution_;
    /// Borders of texels in [0, 1].
    std::vector<double> borders_;
    /// Area that an edge's chords may cut off.
    double negligible_;
    std::uint32_t next_row_ = 0;
    Edges top_, bottom_, uprights_;
    Polygon raw_;
};

} // namespace relumine::cubemap::detail
