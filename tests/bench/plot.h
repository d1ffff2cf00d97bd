// Line plots as SVG: cost against size, flicker over frames.
#pragma once

#include <string>
#include <vector>

namespace relumine::bench {

enum class Scale { Linear, Log };

/// A plot of curves over one pair of axes.
struct Plot {
    struct Series {
        std::string name;
        std::vector<double> x;
        /// [x.size()]
        std::vector<double> y;
        /// True: points joined by a line. False: points alone.
        bool line = true;
    };
    std::string title = {};
    std::string x_label = {};
    std::string y_label = {};
    Scale x_scale = Scale::Linear;
    Scale y_scale = Scale::Linear;
    std::vector<Series> series = {};
};

/// Returns the plot as a whole SVG document, 720 x 440, with axes, grid, ticks and a legend. Points
/// that are not finite, or not above zero on a logarithmic axis, are left out.
///
/// Throws:  std::invalid_argument for a series whose x and y differ in number.
[[nodiscard]] std::string svg(const Plot& plot);

} // namespace relumine::bench
