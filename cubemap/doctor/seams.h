// Faults at a layout's seams: a lat-long's poles and wrap-around, a cube's edges.
#pragma once

#include <string>
#include <vector>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// A place whose pixels do not match their neighbours.
struct SeamFault {
    /// "top row", "left and right edge" or "edge of +X and +Y".
    std::string where = {};
    /// Change of luminance across the seam, in stops.
    double step_ev = 0.0;
    /// Change of luminance right beside the seam, in stops.
    double usual_step_ev = 0.0;
};

/// Returns the faults of an image's seams:
/// - left and right columns that do not meet at longitude 180 degrees;
/// - rows at the poles that are brighter or darker than the rows beside them, or that show
///   different things around the one point they stand for;
/// - edges of cube faces, in a cube or cross, whose two sides do not belong together.
///
/// Medians and high quantiles are compared, so edges of things and small lights make no fault.
/// Images below 32 x 16, and layouts without such places, have no faults. Radiance must be finite
/// and not negative.
[[nodiscard]] std::vector<SeamFault> seam_faults(const EnvironmentImage& image);

} // namespace relumine::cubemap
