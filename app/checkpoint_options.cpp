#include "app/checkpoint_options.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>

namespace relumine::app {

void CheckpointOptions::add_to(Command& command) {
    command.add_flag(
        "--resume", resume_,
        "go on from the last checkpoint of the same work, SCENE.prt.checkpoint, where there is "
        "one; without it the work begins anew and its checkpoints replace that one");
    command
        .add_option(
            "--checkpoint-seconds", seconds_,
            "time between two checkpoints; 0: none. The last goes away when the scene is written")
        .between(0.0, 86400.0)
        .show_default();
}

std::unique_ptr<prt::CheckpointFile> CheckpointOptions::open(const std::string& output,
                                                             prt::Fingerprint fingerprint,
                                                             Session& session) const {
    if (seconds_ == 0.0 && !resume_)
        return nullptr;
    // A disk that stays full need not be told of every twenty seconds.
    const auto warn = [&session, last = std::string()](const std::string& message) mutable {
        if (std::exchange(last, message) != message)
            session.warn(message);
    };
    const double never = 1e9;
    auto checkpoint = std::make_unique<prt::CheckpointFile>(
        output, std::move(fingerprint),
        prt::CheckpointFile::Options{
            .resume = resume_,
            .interval = std::chrono::duration<double>(seconds_ == 0.0 ? never : seconds_),
            .on_problem = warn});
    if (checkpoint->exists())
        session.detail(
            fmt::format("going on from {}", prt::CheckpointFile::folder_for(output).string()));
    return checkpoint;
}

} // namespace relumine::app
