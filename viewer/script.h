// Scripts that drive the window without a person. docs/viewer.md describes the language.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace relumine::viewer {

enum class Action {
    Wait,
    AddDisc,
    AddRectangle,
    AddGain,
    DragLayer,
    ResizeLayer,
    SetGain,
    DragEnvironment,
    PaintEnvironment,
    LassoEnvironment,
    DragMesh,
    Click,
    Rotate,
    Undo,
    Redo,
    SceneExposure,
    EnvironmentExposure,
    Wireframe,
    Quadtree,
    Open,
    AddImage,
    Drop,
    SaveLayers,
    SaveEnvironment,
    Screenshot,
    Quit,
};

/// One line of a script.
struct ScriptCommand {
    Action action = Action::Wait;
    /// A layer's name or a path.
    std::string text = {};
    /// In the order of the line; X,Y,Z counts as three.
    std::vector<double> numbers = {};
    /// Counted from 1.
    std::size_t line = 0;
};

/// Returns how many frames a command takes. A drag is spread over frames, one event each.
[[nodiscard]] std::size_t num_frames(const ScriptCommand& command);

/// Reads the lines of a script; `source` is for messages.
///
/// Throws:  std::runtime_error "source:line: expected X, got Y".
[[nodiscard]] std::vector<ScriptCommand> parse_script(std::string_view text,
                                                      const std::string& source);
[[nodiscard]] std::vector<ScriptCommand> load_script(const std::filesystem::path& path);

} // namespace relumine::viewer
