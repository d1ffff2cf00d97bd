// The interactive window: `relumine view`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "viewer/script.h"
#include "viewer/view_state.h"

namespace relumine::viewer {

struct ViewOptions {
    int width = 1440;
    int height = 860;
    /// Played to its end, then the window closes.
    std::optional<std::vector<ScriptCommand>> script = {};
    /// File for a picture of the script's last frame; empty: none.
    std::filesystem::path screenshot = {};
    /// Closes the window.
    std::stop_token stop = {};
    /// The view to begin with. Empty: the whole mesh.
    std::optional<OrbitCamera> camera = {};
};

/// What happened while the window was open.
struct ViewReport {
    /// OpenGL's own words.
    std::string renderer;
    std::size_t num_frames = 0;
    double mean_frame_seconds = 0.0;
    /// Relighting, for every event of a drag.
    std::vector<double> drag_seconds = {};
};

/// Shows the state, one frame at least, until the window is closed or the script ends.
///
/// Throws:  std::runtime_error when no window can be opened, for a command that a script cannot do,
///          and for a screenshot that cannot be written.
ViewReport view(ViewState& state, const ViewOptions& options = {});

} // namespace relumine::viewer
