// Scripts that drive the window without a person: a list of commands, one a line, each of which
// changes the state or moves the pointer, frame by frame. docs/viewer.md lists the commands.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "viewer/view_state.h"
#include "viewer/window.h"

namespace relumine::viewer {

/// One line of a script.
struct ScriptCommand {
    /// The place in the list of commands.
    std::size_t verb = 0;
    /// A layer's name or a path.
    std::string text = {};
    /// In the order of the line; X,Y,Z counts as three.
    std::vector<double> numbers = {};
    /// Counted from 1.
    std::size_t line = 0;

    /// The command's word.
    [[nodiscard]] std::string_view name() const;
    /// Returns how many frames the command takes. A drag is spread over frames, one event each.
    [[nodiscard]] std::size_t num_frames() const;
};

/// Reads the lines of a script; `source` is for messages.
///
/// Throws:  std::runtime_error "source:line: expected X, got Y".
[[nodiscard]] std::vector<ScriptCommand> parse_script(std::string_view text,
                                                      const std::string& source);
[[nodiscard]] std::vector<ScriptCommand> load_script(const std::filesystem::path& path);

/// Plays a script.
class ScriptPlayer {
public:
    explicit ScriptPlayer(std::vector<ScriptCommand> commands) : commands_(std::move(commands)) {}

    /// The script's wishes for one frame of the window.
    struct Frame {
        std::optional<Pointer> pointer = {};
        /// Takes a screenshot when the frame is drawn; empty: none.
        std::filesystem::path screenshot = {};
    };

    [[nodiscard]] bool is_done() const { return next_ >= commands_.size(); }
    /// Goes on by one frame. `viewport` is the scene's picture in the window.
    ///
    /// Throws:  std::runtime_error that names the line, for a layer that does not exist or a file
    ///          that cannot be opened.
    Frame step(ViewState& state, const PixelRectangle& viewport);

private:
    std::vector<ScriptCommand> commands_;
    std::size_t next_ = 0;
    /// Frame within the present command.
    std::size_t frame_ = 0;
    /// Where a drag of a layer began, or in x its size when a resize began.
    glm::dvec3 from_{0.0};
};

} // namespace relumine::viewer
