// One bounce between all receivers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "files/parallel.h"
#include "prt/bounces/bounce_matrix.h"
#include "relight/bounces/bounce_kernel.h"
#include "relight/bounces/bounce_light.h"

namespace relumine::relight {

/// Rows that one task handles. Sums over rows are added task by task, so threads do not matter.
inline constexpr std::size_t RowsPerTask = prt::RowsPerRun;

/// Calls function(begin, end) for the rows first .. last - 1, in tasks of RowsPerTask, in parallel.
template<typename Function>
void for_rows(std::size_t first, std::size_t last, const Function& function) {
    files::parallel_for(std::size_t{0}, (last - first + RowsPerTask - 1) / RowsPerTask,
                        [&](std::size_t task) {
                            const std::size_t begin = first + task * RowsPerTask;
                            function(begin, std::min(last, begin + RowsPerTask));
                        });
}

/// Returns an albedo under which light does not grow for ever, nearly the largest.
[[nodiscard]] inline float largest_safe_albedo(const prt::BounceMatrix& matrix) {
    constexpr float Margin = 0.999f;
    return matrix.spectral_radius > 0.0f ? Margin / matrix.spectral_radius
                                         : std::numeric_limits<float>::max();
}

/// Returns the place of each receiver, given Transfer::order.
[[nodiscard]] inline std::vector<std::uint32_t> places_of(std::span<const std::uint32_t> order) {
    std::vector<std::uint32_t> result(order.size());
    for (std::uint32_t place = 0; place < order.size(); ++place)
        result[order[place]] = place;
    return result;
}

/// Multiplies with a matrix of bounces. Where processes share the rows, all multiply together, and
/// all get all of the result.
class BounceProduct {
public:
    /// The matrix must outlive this object.
    ///
    /// Throws:  std::invalid_argument for a matrix that has not `num_receivers` rows.
    BounceProduct(const prt::BounceMatrix& matrix, std::size_t num_receivers,
                  const SharedRows& shared);

    [[nodiscard]] const prt::BounceMatrix& matrix() const { return matrix_; }
    [[nodiscard]] const SharedRows& shared() const { return shared_; }
    /// Rows before this one send nothing to others.
    [[nodiscard]] std::size_t first() const { return first_; }
    /// Whether any row gets light from another.
    [[nodiscard]] bool has_emitters() const;
    /// How many emitters a row has, whichever process has them.
    [[nodiscard]] std::size_t num_emitters(std::size_t row) const {
        return shared_.team != nullptr ? shared_.num_emitters[row] : matrix_.emitters[row].size();
    }

    /// result = A sent, for some rows. All values are by place.
    void multiply(std::span<const PaddedRgb> sent, std::size_t begin, std::size_t end,
                  std::span<PaddedRgb> result);

private:
    [[nodiscard]] bool is_own(std::size_t begin) const;
    void share_gathered(std::size_t begin, std::size_t end);

    const prt::BounceMatrix& matrix_;
    SharedRows shared_;
    std::size_t first_;
    std::vector<PaddedRgb> gathered_;
};

} // namespace relumine::relight
