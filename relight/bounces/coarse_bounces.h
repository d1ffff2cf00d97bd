// Bounces between groups of receivers: what many bounces add up to, nearly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prt/bounces/bounce_matrix.h"
#include "relight/bounces/bounce_kernel.h"
#include "relight/bounces/bounce_light.h"

namespace relumine::relight {

/// The matrix of bounces for light that is even within groups of receivers with neighbouring
/// places, then for groups of groups, and so on. Light that goes round for long is even, and small
/// matrices know it; the matrix itself decides about the rest [multigrid method of the second kind:
/// Hackbusch 1985, "Multi-Grid Methods and Applications", chapter 16].
class CoarseBounces {
public:
    /// Leaves the rows before `first` out, from which no other row gets light. Where processes
    /// share the rows, each makes the groups of its own, and all get all groups.
    ///
    /// Cost:    a pass over the emitters.
    CoarseBounces(const prt::BounceMatrix& matrix, std::size_t first,
                  const SharedRows& shared = {});

    /// `albedo` is [num_rows - first] by place.
    void set_albedo(std::span<const PaddedRgb> albedo);

    [[nodiscard]] std::size_t group_size() const { return levels_.front().group_size; }
    [[nodiscard]] std::size_t num_groups() const { return levels_.front().num_groups(); }

    /// Sums all further bounces of light that is sent once: A sent + A rho A sent + ...
    ///
    /// Shape:   `sent` is [num_groups], means over the receivers of a group; the result is
    ///          [num_groups] and good until the next call.
    /// Error:   a few per cent: more would be wasted on light that is not even.
    std::span<const PaddedRgb> sum_of_bounces(std::span<const PaddedRgb> sent) {
        return sum_of_bounces(0, sent);
    }

private:
    struct Entry {
        std::uint32_t group = 0;
        float weight = 0.0f;
    };
    struct Level {
        /// Rows of the finer level, or receivers, in a group.
        std::size_t group_size = 1;
        std::vector<std::uint64_t> row_begin = {0};
        std::vector<Entry> entries = {};
        // All [num_groups].
        std::vector<PaddedRgb> albedo = {}, sent = {}, sum = {}, next = {}, given = {};

        [[nodiscard]] std::size_t num_groups() const { return row_begin.size() - 1; }
        /// Writes A (given + albedo sum) to `next`.
        void multiply();
    };
    static std::size_t size_of_groups(const prt::BounceMatrix& matrix, std::size_t first,
                                      const SharedRows& shared);
    using Rows = std::vector<std::vector<Entry>>;
    template<typename HasGroup, typename AddRow>
    static Rows rows_of_groups(std::size_t num_rows, std::size_t group_size,
                               const HasGroup& has_group, const AddRow& add_row);
    static void share(Rows& rows, std::size_t group_size, prt::Team& team);
    static Level level_of(const Rows& rows, std::size_t group_size);
    std::span<const PaddedRgb> sum_of_bounces(std::size_t level, std::span<const PaddedRgb> sent);
    std::span<const PaddedRgb> sum_of_last_level(std::span<const PaddedRgb> sent);

    std::vector<Level> levels_;
};

} // namespace relumine::relight
