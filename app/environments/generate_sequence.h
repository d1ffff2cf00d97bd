// `relumine generate sequence`: environments over time, one file per frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "app/session.h"

namespace relumine::app {

struct GenerateSequenceOptions {
    /// The argument KIND. Empty: not given.
    std::string kind;
    std::size_t num_frames = 100;
    /// The environment that the sequence turns.
    std::string environment;
    /// Layout of the frames. A cross holds the cube map's texels unchanged.
    std::string layout = "cross";

    void add_to(Command& command);
};

/// Writes FOLDER/KIND.0000.exr and on. Without a face resolution it is 128, or the environment's.
/// After Ctrl-C the frames that were written stay.
void generate_sequence(const GenerateSequenceOptions& options, const std::string& folder,
                       std::optional<std::uint32_t> face_resolution, Session& session);

} // namespace relumine::app
