// Environment files on the command line: which options they take and how they become cube maps.
#pragma once

#include <string>

#include "app/session.h"
#include "relumine/in/environment.h"

namespace relumine::app {

/// The ENV argument and its options.
struct EnvironmentOptions : relumine::EnvironmentOptions {
    std::string path = {};

    /// Adds ENV and its options; returns ENV, which is required until its caller says otherwise.
    Option add_to(Command& command);
};

/// The image as the file has it. Says on -v what was assumed, and always when pixels were fixed.
[[nodiscard]] cubemap::EnvironmentImage load_image(const EnvironmentOptions& options,
                                                   const Session& session);

/// Warns of what is odd about an image from load_image(). Returns true if there was something.
/// `light_from_below` is that of the turned image.
bool warn_about(const EnvironmentOptions& options, const cubemap::EnvironmentImage& image,
                double light_from_below, Session& session);

/// Loads, resamples and turns. Says on -v what was assumed, always what --fix-env replaced, and
/// warns of what is odd.
[[nodiscard]] Environment load_environment(const EnvironmentOptions& options, Session& session);

} // namespace relumine::app
