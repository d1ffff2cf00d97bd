// One bounce: sums over the columns of a matrix of bounces.
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

/// Writes rows begin .. end - 1 of A sent to `result`. All arrays are by place.
void gather_rows(const prt::BounceMatrix& matrix, std::span<const PaddedRgb> sent,
                 std::size_t begin, std::size_t end, std::span<PaddedRgb> result);

} // namespace relumine::relight
