#include "prt/progress.h"

#include <algorithm>

namespace relumine::prt {

void Progress::start_stage(double begin, double end) {
    begin_ = std::max(begin, last_);
    const double scale = begin < 1.0 ? (1.0 - begin_) / (1.0 - begin) : 0.0;
    end_ = begin_ + scale * (end - begin);
}

void Progress::report(double part) {
    poll();
    if (!on_progress_)
        return;
    const std::scoped_lock lock(mutex_);
    const double fraction = begin_ + (end_ - begin_) * part;
    if (fraction > last_)
        on_progress_(last_ = fraction);
}

void Progress::poll() const {
    if (stop_.stop_requested())
        throw Cancelled();
}

} // namespace relumine::prt
