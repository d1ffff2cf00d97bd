// When a log hears of progress: often enough to plan by, seldom enough to be read.
#pragma once

namespace relumine::app {

/// Says when a line of progress is due, for one piece of work.
class ProgressLines {
public:
    /// Whether to write a line now, which then counts as written. A line comes with every tenth,
    /// but five seconds after the one before at least; the first one after half a minute at most,
    /// the next ones after ten minutes.
    ///
    /// fraction: done so far, never falling. seconds: since the work began.
    [[nodiscard]] bool is_due(double fraction, double seconds) {
        constexpr double Least = 5.0, MostAtFirst = 30.0, Most = 600.0;
        const int tenth = static_cast<int>(10.0 * fraction);
        const double silence = seconds - last_;
        if (silence < Least ||
            (tenth <= last_tenth_ && silence < (last_ > 0.0 ? Most : MostAtFirst)))
            return false;
        last_ = seconds;
        last_tenth_ = tenth;
        return true;
    }

private:
    double last_ = 0.0;
    int last_tenth_ = 0;
};

} // namespace relumine::app
