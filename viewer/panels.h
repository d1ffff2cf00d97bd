// The window's panels, drawn with Dear ImGui between its NewFrame() and Render(). The two pictures
// are drawn before, with OpenGL; here are the tools, the outlines over the pictures and what the
// pointer does there.
#pragma once

#include "viewer/panel_layout.h"
#include "viewer/view_state.h"

namespace relumine::viewer {

void scene_panel(ViewState& state, const PanelLayout& layout);
void environment_panel(ViewState& state, const PanelLayout& layout);
void layer_panel(ViewState& state, const PanelLayout& layout);
void status_panel(const ViewState& state, const PanelLayout& layout);
/// Asks what a dropped picture is to be, as long as there is one.
void drop_dialogue(ViewState& state);

/// A panel without a frame of its own at a place; end with ImGui::End(). `over_picture`: nothing
/// behind it.
void begin_panel(const char* name, const PixelRectangle& place, bool over_picture = false);

} // namespace relumine::viewer
