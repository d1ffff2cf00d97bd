// --bounces of the commands that light a scene.
#pragma once

#include <optional>
#include <string>

#include "app/command_line/command_line.h"
#include "relumine/relumine.h"

namespace relumine::app {

class BounceOption {
public:
    /// `by_default`: light bounces where nothing is said and the scene was made for it.
    /// `can_be_alone`: the word `only` is taken, too.
    void add_to(Command& command, bool by_default = true, bool can_be_alone = false);

    /// Returns whether light is to bounce: as often as was asked for, or where nothing was said and
    /// the scene has bounces. `path` is the scene's, for messages.
    ///
    /// Throws:  std::runtime_error where bounces were asked for and the scene has none.
    [[nodiscard]] bool applies_to(const Scene& scene, const std::string& path) const;

    /// Adds bounces to the present light; none where there is nothing to do.
    ///
    /// Throws:  also std::runtime_error for an albedo under which light grows for ever.
    std::optional<BounceReport> bounce(LitScene& lit, const relumine::OutputOptions& output,
                                       const std::string& path) const;

    [[nodiscard]] const BounceLimits& limits() const { return limits_; }
    /// Whether what surfaces add to the direct light is asked for alone: `--bounces only`.
    [[nodiscard]] bool are_alone() const { return are_alone_; }

private:
    bool is_given_ = false, by_default_ = true, are_alone_ = false;
    BounceLimits limits_;
};

/// ", 5 bounces 12.3 ms", or nothing.
[[nodiscard]] std::string text_of(const std::optional<BounceReport>& bounces);

} // namespace relumine::app
