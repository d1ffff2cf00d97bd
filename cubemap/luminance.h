// Luminance of a colour.
#pragma once

#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// The shares of linear red, green and blue in a luminance. They add up to 1.
struct LuminanceWeights {
    double red = 0.0, green = 0.0, blue = 0.0;
};

/// The weights of ITU-R BT.709.
inline constexpr LuminanceWeights Rec709Weights{0.2126, 0.7152, 0.0722};
/// The weights of ITU-R BT.709 as [D05] prints them. Light lists use these, like that paper and its
/// successors.
inline constexpr LuminanceWeights MedianCutWeights{0.2125, 0.7154, 0.0721};

/// Returns the luminance of a colour whose channels are numbers, or of light whose channels are
/// vectors.
template<class Channel>
[[nodiscard]] Channel luminance(const Channel& red, const Channel& green, const Channel& blue,
                                const LuminanceWeights& weights = Rec709Weights) {
    return weights.red * red + weights.green * green + weights.blue * blue;
}

/// Returns the luminance of linear RGB.
[[nodiscard]] inline double luminance(const glm::dvec3& rgb,
                                      const LuminanceWeights& weights = Rec709Weights) {
    return luminance(rgb.x, rgb.y, rgb.z, weights);
}

} // namespace relumine::cubemap
