// Clusters that are bright, but not sharp: a window, a soft box. Their shadows have wide edges,
// which an added floor shows on an even ground.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/relighter.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::relight {

struct BrightClusters {
    /// Ascending.
    std::vector<std::uint32_t> clusters;
    /// Their light without sharp lights, in cells of at least 0.7 degrees, neighbours side by side.
    std::vector<SharpLight> lights;
};

/// Finds the clusters, 64 at most, that each give 1/200 or more of the light of a surface in the
/// open, without their sharp lights. Returns none where all together give less than 1/20. Cells are
/// cut where their power times their width is largest, until there are 32.
///
/// Cost:    O(clusters + texels of those found).
[[nodiscard]] BrightClusters bright_clusters(const Relighter& relighter, const glm::vec3& normal);

/// Returns what receivers have of some clusters, without sharp lights: radiance for albedo 1,
/// [num_receivers - first] in the receivers' own order.
[[nodiscard]] std::vector<glm::vec3> radiance_from(std::span<const std::uint32_t> clusters,
                                                   const Relighter& relighter, std::size_t first);

} // namespace relumine::relight
