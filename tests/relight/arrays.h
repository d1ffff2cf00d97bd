// Small arrays that several tests of relighting need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// 0, 1, ... n - 1
inline std::vector<std::uint32_t> all_of(std::size_t n) {
    std::vector<std::uint32_t> all(n);
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

/// Radiance as it is now, whatever its owner does next.
inline std::vector<glm::vec3> copy(std::span<const glm::vec3> radiance) {
    return {radiance.begin(), radiance.end()};
}

} // namespace relumine::relight
