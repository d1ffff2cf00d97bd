// The overlaps of lat-long pixels and cube texels, in the plane of turns and heights
// (lat_long_plane.h).
//
// The upright edges of a side face are lines of this plane, and its level edges are curves over f.
// The texels of a face are cut once into strips that lie in one column of pixels each; then a texel
// is the area between two curves, which is cut at the rows in closed form. On +Y and -Y all edges
// are curves. Chords replace curves, with a corner that makes the area under the curve right.
// Neighbouring texels share the chords, so the texels tile the plane.
//
// A texel within one pixel has the pixel's radiance, bit by bit.
#include "cubemap/resample/resample_lat_long.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "cubemap/grid_cut.h"
#include "cubemap/image/image_layout.h"
#include "cubemap/resample/lat_long_plane.h"
#include "cubemap/resample/polar_row.h"
#include "files/parallel.h"

namespace relumine::cubemap::detail {

namespace {

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

/// The texels of a side face, cut along the columns of the image into strips.
struct Strips {
    Strips(Face face, std::uint32_t resolution, Sampling sampling,
           const std::vector<double>& column_borders) {
        const double turn = turn_of(face);
        const std::vector<double> borders = cell_borders(resolution, sampling);
        const auto turn_at = [&](std::uint32_t x) {
            return turn + std::atan(2.0 * borders[x] - 1.0) / RadiansPerTurn;
        };
        // Chords of 1/32 radian with Simpson's rule are right to 1e-9 of their area.
        constexpr double WidestTurn = 1.0 / (32.0 * RadiansPerTurn);
        // A strip that rounding left has no area.
        constexpr double NarrowestTurn = 1e-13;
        GridLines lines(column_borders, true);
        double left = turn_at(0);
        cosines.push_back(std::cos(RadiansPerTurn * (left - turn)));
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
                cosines.push_back(std::cos(RadiansPerTurn * (0.5 * (left + right) - turn)));
                cosines.push_back(std::cos(RadiansPerTurn * (right - turn)));
                left = right;
            }
        }
        starts.push_back(columns.size());
    }

    /// The strips of texel column x are [starts[x], starts[x + 1]).
    std::vector<std::size_t> starts;
    /// The image's column under each strip, and the strip's width in turns.
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
