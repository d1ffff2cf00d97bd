// --bounces of the commands that light a scene.
#pragma once

#include <optional>
#include <string>

#include "app/command_line.h"
#include "relumine/relumine.h"

namespace relumine::app {

class BounceOption {
public:
    void add_to(Command& command);

    /// Adds bounces to the present light: as many as were asked for, all where nothing was said and
    /// the scene has them. `path` is the scene's, for messages. None where there is nothing to do.
    std::optional<BounceReport> bounce(LitScene& lit, const relumine::OutputOptions& output,
                                       const std::string& path) const;

private:
    Option given_;
    BounceLimits limits_;
};

/// ", 5 bounces 12.3 ms", or nothing.
[[nodiscard]] std::string text_of(const std::optional<BounceReport>& bounces);

} // namespace relumine::app
