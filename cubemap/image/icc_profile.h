// Colours that an ICC profile states by a matrix and a curve.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cubemap/image/color_space.h"

namespace relumine::cubemap {

/// Returns the space of a profile. Empty for linear Rec. 709, and for a profile that is not
/// understood, which a remark says.
[[nodiscard]] std::optional<ColorSpace> space_of_icc(std::span<const std::byte> profile,
                                                     std::vector<std::string>& remarks);

} // namespace relumine::cubemap
