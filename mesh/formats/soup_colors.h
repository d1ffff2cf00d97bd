// Colours of vertices and faces: from the numbers of a file to light.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/formats/polygon_soup.h"
#include "mesh/vertex_colors.h"

namespace relumine::mesh {

/// Stands for the colour of a vertex that has none, while others have one.
[[nodiscard]] glm::vec3 no_color();

/// Brings colours to [0, 1] that are bytes by the look of them: up to 255, and whole numbers or
/// some of them 16 or more. Whole numbers up to 65535 are of 16 bits. Others stay as they are.
///
/// Returns: the number that meant 1.
float scale_to_one(std::vector<glm::vec3>& colors);

/// Makes the colours of a soup linear. Vertices without one are white, and colours below 0 are 0.
/// `curve` counts in place of what the format's custom is. Says what was done.
void settle_colors(PolygonSoup& soup, std::optional<ColorCurve> curve);

} // namespace relumine::mesh
