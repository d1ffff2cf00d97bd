// The cells that the clustering has still to test.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <vector>

#include "prt/transfer/quadtree.h"

namespace relumine::prt {

/// A queue for each level.
///
/// Coarse cells first is breadth-first order: every sample is traced once, but the samples of a
/// whole level are in memory. Fine cells first ends a subtree before the next begins: memory stays
/// small, but samples on the border of two subtrees are traced for both.
class PendingCells {
public:
    enum class Order { CoarseFirst, FineFirst };

    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t size(std::uint32_t level) const { return levels_[level].size(); }
    void push(const Cell& cell);

    /// Takes cells of one level from the front of its queue: at least one, and more while
    /// `fits(cell)`. Must not be empty.
    [[nodiscard]] std::vector<Cell> take(Order order, const std::function<bool(const Cell&)>& fits);

    /// Returns all cells. Pushed again in this order they make the same queues.
    [[nodiscard]] std::vector<Cell> cells() const;

private:
    std::array<std::deque<Cell>, MaxLevel + 1> levels_;
    std::size_t size_ = 0;
};

} // namespace relumine::prt
