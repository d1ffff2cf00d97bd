// Bounces between groups of receivers: what many bounces add up to, nearly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relight/bounces/bounce_kernel.h"
#include "relight/bounces/bounce_product.h"

namespace relumine::relight {

/// The matrix of bounces for light that is even within groups of receivers, then for groups of
/// groups, and so on. Light that goes round for long is even within groups that are well chosen,
/// and small matrices know it; the matrix itself decides about the rest [multigrid method of the
/// second kind: Hackbusch 1985, "Multi-Grid Methods and Applications", chapter 16].
///
/// A group has receivers with neighbouring places in which the same light comes together: some
/// bounces of random light leave them alike, in each of four draws. So a group does not reach
/// through a wall, and a box has groups of its own [adaptive aggregation: Brezina et al. 2006,
/// "Adaptive Algebraic Multigrid"].
class CoarseBounces {
public:
    /// Leaves the rows before product.first() out, from which no other row gets light. Where
    /// processes share the rows, each makes the groups' rows of its own, and all get all.
    ///
    /// Shape:   `albedo` is [rows] by place.
    /// Cost:    some ten products with the matrix.
    CoarseBounces(BounceProduct& product, std::span<const PaddedRgb> albedo);
    ~CoarseBounces();
    CoarseBounces(CoarseBounces&&) noexcept;
    CoarseBounces& operator=(CoarseBounces&&) noexcept;

    [[nodiscard]] std::size_t num_groups() const;
    /// [rows - first] the group of each row. Groups lie within tasks of RowsPerTask rows.
    [[nodiscard]] std::span<const std::uint32_t> group_of() const;
    /// [num_groups] one over the receivers of each.
    [[nodiscard]] std::span<const float> shares() const;

    /// Sums all further bounces of light that arrives: A rho light + A rho A rho light + ...
    ///
    /// Shape:   `light` is [num_groups], means over the receivers of a group; the result is
    ///          [num_groups] and good until the next call.
    /// Error:   a few per cent: more would be wasted on light that is not even.
    std::span<const PaddedRgb> sum_of_bounces(std::span<const PaddedRgb> light);

private:
    struct Level;
    std::span<const PaddedRgb> sum_of_bounces(std::size_t level, std::span<const PaddedRgb> light);

    std::vector<Level> levels_;
};

} // namespace relumine::relight
