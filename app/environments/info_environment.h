// `relumine info ENV`: the environment's doctor.
#pragma once

#include <optional>
#include <string>

#include "app/session.h"
#include "relumine/in/environment_files.h"

namespace relumine::app {

struct EnvironmentInfoOptions {
    std::string path;
    /// Layout of the image. Empty: taken from the file.
    std::optional<cubemap::Layout> layout;
    /// The .png to draw. Empty: none.
    std::string picture;
};

/// Says what an environment is and what may be wrong with it; docs/environment-doctor.md explains
/// every line.
void describe_environment(const EnvironmentInfoOptions& options, const Session& session);

} // namespace relumine::app
