#include "prt/clusters/pending_cells.h"

#include <algorithm>

namespace relumine::prt {

void PendingCells::push(const Cell& cell) {
    levels_[cell.level].push_back(cell);
    ++size_;
}

std::vector<Cell> PendingCells::take(Order order, const std::function<bool(const Cell&)>& fits) {
    const auto has_cells = [](const std::deque<Cell>& queue) {
        return !queue.empty();
    };
    std::deque<Cell>& queue = order == Order::CoarseFirst
                                  ? *std::find_if(levels_.begin(), levels_.end(), has_cells)
                                  : *std::find_if(levels_.rbegin(), levels_.rend(), has_cells);
    std::vector<Cell> taken;
    while (!queue.empty() && (fits(queue.front()) || taken.empty())) {
        taken.push_back(queue.front());
        queue.pop_front();
    }
    size_ -= taken.size();
    return taken;
}

std::vector<Cell> PendingCells::cells() const {
    std::vector<Cell> cells;
    cells.reserve(size_);
    for (const std::deque<Cell>& queue : levels_)
        cells.insert(cells.end(), queue.begin(), queue.end());
    return cells;
}

} // namespace relumine::prt
