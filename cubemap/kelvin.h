// Colours of light by their temperature.
#pragma once

#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// The temperatures that kelvin_color() takes.
inline constexpr double LowestKelvin = 1000.0, HighestKelvin = 15000.0;

/// Returns the colour of a glowing black body: linear sRGB of luminance 1. What lies outside of
/// sRGB, below 1900 K, has no blue.
///
/// Based on: M. Krystek, "An algorithm to calculate correlated colour temperature", Color Research
///           and Application 10(1), 1985: rational functions of the temperature for the CIE 1960 u
///           and v, within 1e-4 of the Planckian locus in the range above.
[[nodiscard]] glm::vec3 kelvin_color(double kelvin);

} // namespace relumine::cubemap
