// How `relumine precompute` survives what stops it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/session.h"
#include "prt/scene/checkpoint_file.h"

namespace relumine::app {

/// --resume and --checkpoint-seconds.
class CheckpointOptions {
public:
    void add_to(Command& command);

    /// The checkpoint beside `output`; none where it is switched off. Throws std::runtime_error
    /// when one is to be resumed from that does not fit.
    [[nodiscard]] std::unique_ptr<prt::CheckpointFile>
    open(const std::string& output, prt::Fingerprint fingerprint, Session& session) const;

private:
    bool resume_ = false;
    double seconds_ = 20.0;
};

} // namespace relumine::app
