// Environments of any brightness in the colours of a screen.
// Based on: E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, "Photographic Tone Reproduction for
// Digital Images", SIGGRAPH 2002, the global operator.
#pragma once

#include <compare>
#include <limits>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/luminance.h"

namespace relumine::relight {

/// The luminance of a part of a picture, and the part's weight.
struct LuminanceSample {
    double luminance = 0.0, weight = 1.0;
    // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 sees one in the comparison with 0
    auto operator<=>(const LuminanceSample&) const = default;
};

struct ToneMapOptions {
    cubemap::LuminanceWeights weights = cubemap::Rec709Weights;
    /// Darker samples are raised to this share of the largest luminance. At 0 black samples do not
    /// count.
    double floor = 0.0;
    /// At least this share of the samples' weight is brighter than white. At 0 all samples stay
    /// below white.
    double white_share = 0.0;
};

class ToneMap {
public:
    /// The geometric mean of the samples' luminance becomes middle grey. Without light nothing
    /// changes.
    explicit ToneMap(std::vector<LuminanceSample> samples, const ToneMapOptions& options = {});

    /// Returns a colour in [0, 1] for radiance that is not negative.
    [[nodiscard]] glm::vec3 operator()(const glm::dvec3& radiance) const;

private:
    cubemap::LuminanceWeights weights_;
    double key_ = 1.0;
    /// The scaled luminance that becomes white.
    double white_ = std::numeric_limits<double>::infinity();
};

} // namespace relumine::relight
