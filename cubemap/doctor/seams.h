// Places where layouts break: a lat-long's poles and wrap-around, a cube's edges.
#pragma once

#include <string>
#include <vector>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// A place whose pixels are out of line with their neighbours.
struct SeamFault {
    /// "top row", "left and right edge", "edge of +X and +Y"
    std::string where = {};
    /// How much luminance changes there
    double step_ev = 0.0;
    /// How much it changes right beside
    double usual_step_ev = 0.0;
};

/// What is wrong with an image's seams: columns that do not meet at longitude 180 degrees; rows at
/// the poles that are brighter or darker than the rows beside, or that show different things around
/// the one point they stand for; edges of cube faces (in a cube or cross) where what meets does not
/// belong together. Medians and high quantiles are compared, so that edges of things and small
/// lights make no fault. Images below 32 x 16, and layouts without such places, have none. Radiance
/// must be finite and not negative.
[[nodiscard]] std::vector<SeamFault> seam_faults(const EnvironmentImage& image);

} // namespace relumine::cubemap
