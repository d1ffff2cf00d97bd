#include "app/options/checkpoint_options.h"

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

} // namespace relumine::app
