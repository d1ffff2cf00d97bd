#include "prt/progress.h"

#include "prt/precompute.h"

namespace relumine::prt {

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
