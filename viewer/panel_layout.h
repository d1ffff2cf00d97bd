// Where the parts of the window lie. The layout depends on the window's size alone, so a script
// knows its pixels.
#pragma once

namespace relumine::viewer {

/// A rectangle of the window in pixels, from the top left corner.
struct PixelRectangle {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
    bool operator==(const PixelRectangle&) const = default;

    [[nodiscard]] bool contains(double px, double py) const {
        return px >= x && py >= y && px < x + width && py < y + height;
    }
};

/// The scene is on the left, under its tools. The environment is on the right, under its own tools,
/// with the layers below. A line of figures is at the bottom.
struct PanelLayout {
    PixelRectangle scene_tools;
    PixelRectangle scene;
    PixelRectangle environment_tools;
    /// Twice as wide as high.
    PixelRectangle environment;
    PixelRectangle layers;
    PixelRectangle status;
};

[[nodiscard]] PanelLayout panel_layout(int width, int height);

} // namespace relumine::viewer
