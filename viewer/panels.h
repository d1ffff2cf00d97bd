// The window's panels, drawn with Dear ImGui between its NewFrame() and Render(). OpenGL has drawn
// the two pictures before. The panels are the tools, the outlines over the pictures, and the
// pointer's effects there.
#pragma once

#include "viewer/panel_layout.h"
#include "viewer/view_state.h"

namespace relumine::viewer {

void scene_panel(ViewState& state, const PanelLayout& layout);
void environment_panel(ViewState& state, const PanelLayout& layout);
void layer_panel(ViewState& state, const PanelLayout& layout);
void status_panel(const ViewState& state, const PanelLayout& layout);
/// Asks how to use a dropped picture, as long as there is one.
void drop_dialogue(ViewState& state);

/// Begins a panel without a frame of its own at a place; end it with ImGui::End(). With
/// `over_picture`, nothing is drawn behind it.
void begin_panel(const char* name, const PixelRectangle& place, bool over_picture = false);

// What follows stays on the same line if it fits there: so wide, a button or a checkbox with a
// label.
void next_item(float width);
void next_button(const char* label);
void next_checkbox(const char* label);

} // namespace relumine::viewer
