// The transfer of many directions to some receivers, as columns of a matrix.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/light_fit/scaled_receivers.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// t_j(x) = V(x, w_j) max(n.w_j, 0)/pi from directions w_j to receivers, traced, times each
/// receiver's scale.
///
/// Shape:   [directions][receivers], 4 bytes per element.
/// Unit:    1/sr.
class TransferMatrix {
public:
    /// `receivers` belong to the relighter's scene. The relighter needs shadow rays. Fastest when
    /// neighbouring directions lie close together.
    TransferMatrix(const Relighter& relighter, std::span<const glm::dvec3> directions,
                   const ScaledReceivers& receivers);

    [[nodiscard]] std::size_t num_directions() const { return num_directions_; }

    [[nodiscard]] std::span<const float> column(std::size_t direction) const {
        return {elements_.data() + direction * num_receivers_, num_receivers_};
    }

    /// Returns the products of all columns with a vector over the receivers. Bitwise the same for
    /// any number of threads.
    [[nodiscard]] std::vector<float> products(std::span<const float> vector) const;

    [[nodiscard]] static float dot(std::span<const float> a, std::span<const float> b);

private:
    std::size_t num_directions_;
    std::size_t num_receivers_;
    std::vector<float> elements_;
};

} // namespace relumine::relight
