// How `relumine precompute` survives what stops it.
#pragma once

#include "app/session.h"

namespace relumine::app {

/// --resume and --checkpoint-seconds.
class CheckpointOptions {
public:
    void add_to(Command& command);

    [[nodiscard]] bool resume() const { return resume_; }
    [[nodiscard]] double seconds() const { return seconds_; }

private:
    bool resume_ = false;
    double seconds_ = 20.0;
};

} // namespace relumine::app
