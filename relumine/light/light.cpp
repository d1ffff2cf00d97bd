#include "relumine/light/light.h"

#include <algorithm>
#include <set>

namespace relumine {

void LightHistory::restart(const LightState& first) {
    marks_.assign(1, first);
    at_ = 0;
}

bool LightHistory::is_unmarked(const LightState& now) const {
    return !marks_.empty() && marks_[at_] != now;
}

const LightState* LightHistory::undo(const LightState& now) {
    if (is_unmarked(now))
        return &marks_[at_];
    return at_ > 0 ? &marks_[--at_] : nullptr;
}

void LightHistory::mark(const LightState& state) {
    marks_.resize(std::min(at_ + 1, marks_.size()));
    if (!marks_.empty() && marks_[at_] == state)
        return;
    marks_.push_back(state);
    // Count from the newest mark back: how many fit?
    std::set<const LightBase*> bases = {state.base.get()};
    std::size_t bytes = 0;
    std::size_t first = marks_.size();
    while (first > 0) {
        const LightBase* base = marks_[first - 1].base.get();
        if (base != nullptr && bases.insert(base).second)
            bytes += base->map()->texels.size() * sizeof(glm::vec3);
        if (bytes > max_bytes_ && first + 2 <= marks_.size())
            break;
        --first;
    }
    marks_.erase(marks_.begin(), marks_.begin() + static_cast<std::ptrdiff_t>(first));
    at_ = marks_.size() - 1;
}

} // namespace relumine
