#include "app/scenes/checkpoint_words.h"

#include <system_error>

#include <fmt/format.h>

#include "relumine/in/shared_work.h"

namespace relumine::app {

void say_how_to_go_on(const std::filesystem::path& output, const Session& session) {
    const prt::Team& team = session.processes();
    if (!team.has_others() || team.part().index > 1)
        return;
    const auto message = [folder = prt::CheckpointFile::folder_for(output)] {
        std::error_code error;
        return std::filesystem::exists(folder, error)
                   ? fmt::format("ended before the work was done; the same command with --resume "
                                 "goes on from {}",
                                 folder.string())
                   : "ended before the work was done; nothing was written";
    };
    set_waiting_message(message, session.is_first_alive);
}

void say_new_beginning(const std::filesystem::path& output, const Session& session) {
    const std::filesystem::path folder = prt::CheckpointFile::folder_for(output);
    if (std::error_code error; !std::filesystem::exists(folder, error))
        session.say(
            fmt::format("--resume: {} is not there, the work begins anew", folder.string()));
}

} // namespace relumine::app
