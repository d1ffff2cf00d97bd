// What `relumine precompute` says of its checkpoint, if there is one.
#pragma once

#include <filesystem>

#include "app/session.h"

namespace relumine::app {

/// Where one of several processes was killed, mpirun ends the others before they can meet again.
/// The first one names the checkpoint, or where it is gone, the second one: one of them is left.
void say_how_to_go_on(const std::filesystem::path& output, const Session& session);

/// Says that work with --resume begins anew where it has no checkpoint. Whoever asks to go on
/// should know that nothing was kept, as after a wrong --output.
void say_new_beginning(const std::filesystem::path& output, const Session& session);

} // namespace relumine::app
