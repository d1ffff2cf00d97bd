// The light that points in space get from surfaces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/bounces/point_rows.h"
#include "relight/bounces/bounce_kernel.h"
#include "relight/harmonics/harmonics.h"

namespace relumine::relight {

/// Basis functions along the directions of points, each times the solid angle of one.
class PointBasis {
public:
    /// `order` is 1, 2 or 3.
    PointBasis(const prt::PointRows& rows, std::uint32_t order);

    [[nodiscard]] std::size_t width() const { return num_harmonics(order_); }

    /// Returns the coefficients of the light that each point gets, given what surfaces send.
    ///
    /// Shape:   `sent` is [num_receivers] by place; the result is [num_points][width].
    /// Cost:    O(points * directions).
    /// Threads: parallel; the same bits for any number of threads.
    [[nodiscard]] std::vector<glm::vec3> gathered(std::span<const PaddedRgb> sent) const;

    /// Adds to the derivative by what surfaces send, given that by the coefficients: the transpose.
    ///
    /// Shape:   `weights` is [num_points][width], `by_sent` [num_receivers] by place.
    void scatter(std::span<const glm::dvec3> weights, std::span<glm::dvec3> by_sent) const;

private:
    [[nodiscard]] std::span<const float> at(std::size_t direction) const {
        return std::span(values_).subspan(direction * width(), width());
    }

    const prt::PointRows& rows_;
    std::uint32_t order_;
    /// [num_directions][width]
    std::vector<float> values_;
};

} // namespace relumine::relight
