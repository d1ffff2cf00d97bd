// The light that points in space get from surfaces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/bounces/point_rows.h"
#include "relight/bounces/bounce_kernel.h"
#include "relight/harmonics/harmonics.h"

namespace relumine::relight {

/// Basis functions along the directions of points, each times the solid angle of one. `order` is 1,
/// 2 or 3 everywhere; the rows must outlive the object.
class PointBasis {
public:
    explicit PointBasis(const prt::PointRows& rows);

    /// Returns the coefficients of the light that each point gets, given what surfaces send.
    ///
    /// Shape:   `sent` is [num_receivers] by place; the result is [num_points][order^2].
    /// Cost:    O(points * directions).
    /// Threads: parallel; the same bits for any number of threads.
    [[nodiscard]] std::vector<glm::vec3> gathered(std::span<const PaddedRgb> sent,
                                                  std::uint32_t order) const;

    /// Adds to the derivative by what surfaces send, given that by the coefficients: the transpose.
    ///
    /// Shape:   `weights` is [num_points][order^2], `by_sent` [num_receivers] by place.
    void scatter(std::span<const glm::dvec3> weights, std::uint32_t order,
                 std::span<glm::dvec3> by_sent) const;

private:
    const prt::PointRows& rows_;
    /// [num_directions]
    std::vector<std::array<float, MaxHarmonics>> values_;
};

} // namespace relumine::relight
