// Plays a script: changes of the state and of the pointer, frame by frame.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "viewer/script.h"
#include "viewer/view_state.h"
#include "viewer/window.h"

namespace relumine::viewer {

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
    /// Goes on by one frame.
    ///
    /// Throws:  std::runtime_error that names the line, for a layer that does not exist or a file
    ///          that cannot be opened.
    Frame step(ViewState& state);

private:
    void apply(const ScriptCommand& command, ViewState& state, std::size_t num_frames,
               Frame& frame);
    void drag_layer(const ScriptCommand& command, ViewState& state, std::size_t num_frames);
    void resize_layer(const ScriptCommand& command, ViewState& state, std::size_t num_frames);
    /// The part of the present command that is done after this frame, up to 1.
    [[nodiscard]] double part_done(std::size_t num_frames) const {
        return static_cast<double>(frame_ + 1) / static_cast<double>(num_frames);
    }

    std::vector<ScriptCommand> commands_;
    std::size_t next_ = 0;
    /// Frame within the present command.
    std::size_t frame_ = 0;
    /// Where a drag of a layer began.
    glm::dvec3 from_{0.0};
    /// Size of a layer when a resize began.
    double size_from_ = 0.0;
};

} // namespace relumine::viewer
