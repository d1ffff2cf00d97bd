// What numbers of pixels mean: the curve of sRGB, IEC 61966-2-1, between a screen's values and
// light, and the range of 16-bit floats.
#pragma once

#include <cmath>

namespace relumine::files {

/// The largest finite 16-bit float.
inline constexpr float LargestHalf = 65504.0f;

/// Returns the light of a screen's value; both from 0 to 1.
template<typename Real>
[[nodiscard]] Real linear_of_srgb(Real encoded) {
    return encoded <= Real(0.04045) ? encoded / Real(12.92)
                                    : std::pow((encoded + Real(0.055)) / Real(1.055), Real(2.4));
}

/// Returns the screen's value of light; both from 0 to 1.
template<typename Real>
[[nodiscard]] Real srgb_of_linear(Real linear) {
    return linear <= Real(0.0031308)
               ? Real(12.92) * linear
               : Real(1.055) * std::pow(linear, Real(1) / Real(2.4)) - Real(0.055);
}

} // namespace relumine::files
