// The stages of a mesh's first picture, and what each takes.
#pragma once

#include <vector>

#include "app/run_estimate.h"

namespace relumine::app {

/// Returns the stages of `relight MESH ENV` by the names under which they tell their progress. The
/// shares are the means of three assets', with a picture of 1024 x 768 (docs/command-line.md).
///
/// num_pixels: of the picture.
[[nodiscard]] inline std::vector<RunEstimate::Stage> first_picture_stages(double num_pixels) {
    constexpr double PixelsOfShare = 1024.0 * 768.0;
    return {{"first sight", 0.08},
            {"refine", 0.11},
            {"receivers", 0.01},
            {"precompute", 0.09},
            {"highlights", 0.02},
            {"bounces", 0.27},
            {"picture", 0.42 * num_pixels / PixelsOfShare}};
}

} // namespace relumine::app
