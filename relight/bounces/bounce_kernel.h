// One bounce: sums over the lists of a matrix of bounces.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <glm/vec3.hpp>

#include "prt/bounces/bounce_matrix.h"

namespace relumine::relight {

/// A colour in one register.
struct alignas(16) PaddedRgb {
    std::array<float, 4> rgb{};
};

[[nodiscard]] inline PaddedRgb padded(const glm::vec3& value) {
    return {{value.x, value.y, value.z, 0.0f}};
}

/// Writes, for the lists begin .. end - 1, the sum of the values of each list's places.
void sum_lists(const prt::PlaceLists& lists, std::span<const PaddedRgb> values, std::size_t begin,
               std::size_t end, std::span<PaddedRgb> sums);

} // namespace relumine::relight
