// The texels of the side faces in the plane of turns and heights.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "cubemap/grid_cut.h"
#include "cubemap/resample/lat_long_plane.h"
#include "cubemap/resample/resample.h"

namespace relumine::cubemap::detail {

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

} // namespace relumine::cubemap::detail
