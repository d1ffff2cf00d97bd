// The overlaps of lat-long pixels and cube texels, in the plane of turns and heights.
//
// A direction of longitude l and polar angle p has the coordinates f = 1/2 - l / 2 pi (the image's
// own x) and y = -cos p. By Archimedes' theorem the solid angle of a region is 2 pi times its area
// in this plane, and lat-long pixels are plain rectangles.
//
// The upright edges of a side face are lines of this plane, and its level edges are curves over f.
// The texels of a face are cut once into strips that lie in one column of pixels each; then a texel
// is the area between two curves, which is cut at the rows in closed form. On +Y and -Y all edges
// are curves. Chords replace curves, with a corner that makes the area under the curve right.
// Neighbouring texels share the chords, so the texels tile the plane.
//
// A texel within one pixel has the pixel's radiance, bit by bit.
//
//     face   f at (u, v)                     y
//     +Z     1/2 + atan(u) / 2 pi            v / sqrt(1 + u^2 + v^2)
//     +X, -Z, -X: as +Z, with 1/4 and 1/2 subtracted from f and 1/4 added to it
//     +Y     1/2 - atan2(u, -v) / 2 pi       1 - cos p
//     -Y: as +Y, mirrored at the horizon
//
// On +Y the height is measured from the pole. Otherwise it would lose all its digits there.
#include "cubemap/resample/resample_lat_long.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "cubemap/grid_cut.h"
#include "cubemap/image/image_layout.h"
#include "files/parallel.h"

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
                {0.5 - std::atan2(zx.y, zx.x) / TwoPi, squared / (root * (1.0 + root))},
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
        return -2.0 * angle / TwoPi;
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

/// Returns the image's row borders as heights in the measure of +Y or of the side faces.
std::vector<double> row_heights(const EnvironmentImage& image, Face face) {
    std::vector<double> heights = cell_borders(image.height, image.sampling);
    for (double& border : heights) {
        const double polar = std::numbers::pi * border;
        border = is_polar(face) ? 2.0 * std::pow(std::sin(0.5 * polar), 2) : -std::cos(polar);
    }
    return heights;
}

/// Returns the integral of clamp(height, low, high) - low along a chord of the given width.
double area_within(double from, double to, double width, double low, double high) {
    if (from > to)
        std::swap(from, to);
    if (to <= low)
        return 0.0;
    if (from >= high)
        return width * (high - low);
    if (from >= low && to <= high)
        return width * (0.5 * (from + to) - low);
    // The integral over the height instead: it is quadratic inside, linear above.
    const auto integral = [&](double height) {
        if (height <= low)
            return 0.0;
        const double inside = std::min(height, high) - low;
        return inside * (0.5 * inside + std::max(height - high, 0.0));
    };
    return width * (integral(to) - integral(from)) / (to - from);
}

/// The texels of a side face, cut along the columns of the image into strips.
struct Strips {
    Strips(Face face, std::uint32_t resolution, Sampling sampling,
           const std::vector<double>& column_borders) {
        const double turn = turn_of(face);
        const std::vector<double> borders = cell_borders(resolution, sampling);
        const auto turn_at = [&](std::uint32_t x) {
            return turn + std::atan(2.0 * borders[x] - 1.0) / TwoPi;
        };
        // Chords of 1/32 radian with Simpson's rule are right to 1e-9 of their area.
        constexpr double WidestTurn = 1.0 / (32.0 * TwoPi);
        // A strip that rounding left has no area.
        constexpr double NarrowestTurn = 1e-13;
        GridLines lines(column_borders, true);
        double left = turn_at(0);
        cosines.push_back(std::cos(TwoPi * (left - turn)));
        for (std::uint32_t x = 0; x < resolution; ++x) {
            starts.push_back(columns.size());
            const double end = turn_at(x + 1);
            while (left < end) {
                const std::ptrdiff_t column = lines.cell(left + NarrowestTurn);
                double right = std::min({end, lines.line(column + 1), left + WidestTurn});
                if (end - right < NarrowestTurn)
                    right = end;
                columns.push_back(static_cast<std::uint32_t>(lines.wrapped(column)));
                widths.push_back(right - left);
                cosines.push_back(std::cos(TwoPi * (0.5 * (left + right) - turn)));
                cosines.push_back(std::cos(TwoPi * (right - turn)));
                left = right;
            }
        }
        starts.push_back(columns.size());
    }

    /// The strips of texel column x are [starts[x], starts[x + 1]).
    std::vector<std::size_t> starts;
    /// Of the image, and width in turns, per strip.
    std::vector<std::uint32_t> columns;
    std::vector<double> widths;
    /// Cosines of the angle from the middle of the face: at the left end of strip i [2 i], in its
    /// middle and at its right end.
    std::vector<double> cosines;
};

/// A level edge of a row of texels, as heights over the strips.
class LevelLine {
public:
    /// The edge over one strip: two chords that meet in the middle.
    struct Piece {
        double left, middle, right;
        /// The rows of the image in which it lies, the last one included.
        std::uint32_t first_row, last_row;

        /// Returns the mean height.
        [[nodiscard]] double mean() const { return 0.25 * (left + 2.0 * middle + right); }
        /// Returns the integral of clamp(height, low, high) - low over the strip.
        [[nodiscard]] double area(double width, double low, double high) const {
            return area_within(left, middle, 0.5 * width, low, high) +
                   area_within(middle, right, 0.5 * width, low, high);
        }
    };

    /// Makes the line of a face's coordinate v, in [-1, 1]. `heights` are the borders of rows.
    void make(const Strips& strips, double v, const std::vector<double>& heights) {
        heights_.resize(strips.cosines.size());
        for (std::size_t i = 0; i < heights_.size(); ++i) {
            const double w = v * strips.cosines[i];
            heights_[i] = w / std::sqrt(1.0 + w * w);
        }
        pieces.resize(strips.widths.size());
        const auto num_rows = static_cast<std::uint32_t>(heights.size() - 1);
        std::uint32_t first = std::min(row_, num_rows - 1), last = first;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const double left = heights_[2 * i], right = heights_[2 * i + 2];
            // The area is Simpson's.
            const double middle = (8.0 * heights_[2 * i + 1] - left - right) / 6.0;
            const double low = std::min({left, middle, right}),
                         high = std::max({left, middle, right});
            while (first > 0 && low < heights[first])
                --first;
            while (first + 1 < num_rows && low >= heights[first + 1])
                ++first;
            while (last > 0 && high <= heights[last])
                --last;
            while (last + 1 < num_rows && high > heights[last + 1])
                ++last;
            pieces[i] = {left, middle, right, first, std::max(first, last)};
        }
        row_ = first;
    }

    std::vector<Piece> pieces;

private:
    std::vector<double> heights_;
    std::uint32_t row_ = 0;
};

/// The part of a texel that lies in one pixel.
struct Share {
    std::size_t column = 0, row = 0;
    double area = 0.0;
};
using Shares = std::vector<Share>;

/// Adds a share. Rounding may make an area negative, and an infinite pixel that only touches the
/// texel must not matter.
void add_share(Shares& shares, std::size_t column, std::size_t row, double area) {
    if (area > 0.0)
        shares.push_back({column, row, area});
}

/// The symmetries of a lat-long and a cube: the horizon mirrors both, and quarter turns about the
/// axis carry columns to columns if their number is a multiple of four. So the shares of one texel
/// are those of two or eight texels.
class Symmetry {
public:
    Symmetry(const EnvironmentImage& image, CubeMap& map)
        : image_(image), map_(map),
          has_quarters_(image.sampling == Sampling::TexelCentres && image.width % 4 == 0) {}

    /// The number of quarter turns that are symmetries: 4 or 1.
    [[nodiscard]] int num_turns() const { return has_quarters_ ? 4 : 1; }

    /// Fills the texels at (x, y) of `face`, a side face, and their images.
    void write_side(Face face, std::uint32_t x, std::uint32_t y, const Shares& shares) {
        // In the order of ascending turns.
        constexpr std::array<Face, 4> Sides = {Face::NegativeZ, Face::PositiveX, Face::PositiveZ,
                                               Face::NegativeX};
        const auto first = static_cast<std::size_t>(std::lround(4.0 * turn_of(face)));
        const std::uint32_t below = map_.resolution - 1 - y;
        for (int turn = 0; turn < num_turns(); ++turn) {
            const Face side = Sides[(first + static_cast<std::size_t>(turn)) % 4];
            map_.at(side, x, y) = mean(shares, turn, false);
            if (below != y)
                map_.at(side, x, below) = mean(shares, turn, true);
        }
    }

    /// Fills the texels at (x, y) of +Y and their images.
    void write_polar(std::uint32_t x, std::uint32_t y, const Shares& shares) {
        const std::uint32_t last = map_.resolution - 1;
        for (int turn = 0; turn < num_turns(); ++turn) {
            map_.at(Face::PositiveY, x, y) = mean(shares, turn, false);
            map_.at(Face::NegativeY, x, last - y) = mean(shares, turn, true);
            x = std::exchange(y, last - x);
        }
    }

private:
    [[nodiscard]] glm::vec3 mean(const Shares& shares, int turn, bool is_mirrored) const {
        const auto pixel = [&](const Share& share) -> const glm::vec3& {
            std::size_t column = share.column + image_.width / 4 * static_cast<std::size_t>(turn);
            if (column >= image_.width)
                column -= image_.width;
            const std::size_t row = is_mirrored ? image_.height - 1 - share.row : share.row;
            return image_.pixels[row * image_.width + column];
        };
        if (shares.size() == 1)
            return pixel(shares.front());
        glm::dvec3 sum(0.0);
        double area = 0.0;
        for (const Share& share : shares) {
            sum += glm::dvec3(pixel(share)) * share.area;
            area += share.area;
        }
        return sum / area;
    }

    const EnvironmentImage& image_;
    CubeMap& map_;
    bool has_quarters_;
};

void fill_side(const EnvironmentImage& image, Face face, Sampling sampling, CubeMap& map) {
    const std::uint32_t resolution = map.resolution;
    const Strips strips(face, resolution, sampling, cell_borders(image.width, image.sampling));
    const std::vector<double> heights = row_heights(image, face);
    const std::vector<double> borders = cell_borders(resolution, sampling);
    Symmetry symmetry(image, map);
    files::parallel_for(
        files::IndexRange<std::uint32_t>(0, (resolution + 1) / 2), [&](const auto& rows) {
            LevelLine top, bottom;
            Shares shares;
            bottom.make(strips, 2.0 * borders[rows.begin()] - 1.0, heights);
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                std::swap(top, bottom);
                bottom.make(strips, 2.0 * borders[y + 1] - 1.0, heights);
                for (std::uint32_t x = 0; x < resolution; ++x) {
                    shares.clear();
                    for (std::size_t i = strips.starts[x]; i < strips.starts[x + 1]; ++i) {
                        const LevelLine::Piece &above = top.pieces[i], &below = bottom.pieces[i];
                        const double width = strips.widths[i];
                        if (above.first_row == below.last_row)
                            add_share(shares, strips.columns[i], above.first_row,
                                      width * (below.mean() - above.mean()));
                        else
                            for (std::uint32_t row = above.first_row; row <= below.last_row; ++row)
                                add_share(shares, strips.columns[i], row,
                                          below.area(width, heights[row], heights[row + 1]) -
                                              above.area(width, heights[row], heights[row + 1]));
                    }
                    symmetry.write_side(face, x, y, shares);
                }
            }
        });
}

/// Finds how a polygon of the plane covers the cells of a grid.
class Coverage {
public:
    /// Calls `visit(column, row, area)` for the cells under the polygon.
    template<typename Visit>
    void find(const Polygon& polygon, GridLines& columns, GridLines& rows, const Visit& visit) {
        glm::dvec2 low = polygon.front(), high = low;
        for (const glm::dvec2& corner : polygon) {
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
        const std::ptrdiff_t left = columns.cell(low.x), right = columns.cell(high.x),
                             top = rows.cell(low.y), bottom = rows.cell(high.y);
        const auto num_rows = static_cast<std::size_t>(bottom - top + 1);
        areas_.assign(static_cast<std::size_t>(right - left + 1) * num_rows, 0.0);
        // Clockwise with y down, edges to the right are the upper ones. What lies between two edges
        // is the difference of what lies above each.
        glm::dvec2 from = polygon.back();
        for (const glm::dvec2& to : polygon) {
            const glm::dvec2 &first = from.x < to.x ? from : to, &last = from.x < to.x ? to : from;
            const double sign = from.x < to.x ? -1.0 : 1.0;
            if (from.x != to.x) {
                const double slope = (last.y - first.y) / (last.x - first.x);
                glm::dvec2 start = first;
                std::ptrdiff_t column = left;
                while (column < right && columns.line(column + 1) <= start.x)
                    ++column;
                for (;; ++column) {
                    const bool ends = column == right || columns.line(column + 1) >= last.x;
                    const double x = ends ? last.x : columns.line(column + 1);
                    const double y = ends ? last.y : first.y + slope * (x - first.x);
                    double* areas = &areas_[static_cast<std::size_t>(column - left) * num_rows];
                    for (std::ptrdiff_t row = top; row <= bottom; ++row)
                        areas[row - top] += area_within(start.y, y, sign * (x - start.x),
                                                        rows.line(row), rows.line(row + 1));
                    if (ends)
                        break;
                    start = {x, y};
                }
            }
            from = to;
        }
        for (std::ptrdiff_t column = left; column <= right; ++column) {
            for (std::ptrdiff_t row = top; row <= bottom; ++row)
                visit(columns.wrapped(column), rows.wrapped(row),
                      areas_[static_cast<std::size_t>(column - left) * num_rows +
                             static_cast<std::size_t>(row - top)]);
        }
    }

private:
    std::vector<double> areas_;
};

/// Fills +Y and -Y.
void fill_poles(const EnvironmentImage& image, Sampling sampling, CubeMap& map) {
    const std::uint32_t resolution = map.resolution;
    const std::vector<double> column_borders = cell_borders(image.width, image.sampling);
    const std::vector<double> heights = row_heights(image, Face::PositiveY);
    Symmetry symmetry(image, map);
    const bool has_quarters = symmetry.num_turns() == 4;
    const std::uint32_t num_rows = has_quarters ? (resolution + 1) / 2 : resolution;
    files::parallel_for(files::IndexRange<std::uint32_t>(0, num_rows), [&](const auto& row_range) {
        GridLines columns(column_borders, true), rows(heights, false);
        GridCutter cutter;
        Coverage coverage;
        PolarRow texels(resolution, sampling);
        Polygon polygon;
        Shares shares;
        const auto take = [&](std::size_t column, std::size_t row, double part) {
            add_share(shares, column, row, part);
        };
        for (std::uint32_t y = row_range.begin(); y != row_range.end(); ++y) {
            texels.move_to(y);
            // Quarter turns take the middle row of an odd resolution to the middle column: only one
            // of them is found here, so that no two threads write the same texel.
            const bool has_centre = resolution % 2 == 1 && y == resolution / 2;
            const std::uint32_t num_columns =
                has_quarters ? resolution / 2 + (has_centre ? 1 : 0) : resolution;
            for (std::uint32_t x = 0; x < num_columns; ++x) {
                shares.clear();
                const auto box = texels.box(x);
                if (box) {
                    const std::ptrdiff_t column = columns.cell(box->low.x),
                                         row = rows.cell(box->low.y);
                    if (box->high.x <= columns.line(column + 1) &&
                        box->high.y <= rows.line(row + 1))
                        take(columns.wrapped(column), rows.wrapped(row), 1.0);
                }
                if (shares.empty()) {
                    texels.polygon(x, polygon);
                    if (box)
                        coverage.find(polygon, columns, rows, take);
                    else
                        cutter.cut(polygon, columns, rows,
                                   [&](std::size_t column, std::size_t row, const Polygon& piece) {
                                       take(column, row, area(piece));
                                   });
                }
                symmetry.write_polar(x, y, shares);
            }
        }
    });
}

} // namespace

CubeMap cube_from_lat_long(const EnvironmentImage& image, std::uint32_t resolution,
                           Sampling sampling) {
    CubeMap map(resolution);
    fill_poles(image, sampling, map);
    if (Symmetry(image, map).num_turns() == 4) {
        fill_side(image, Face::PositiveZ, sampling, map);
        return map;
    }
    for (const Face face : AllFaces) {
        if (!is_polar(face))
            fill_side(image, face, sampling, map);
    }
    return map;
}

} // namespace relumine::cubemap::detail
