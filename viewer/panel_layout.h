// Where the parts of the window lie. Depends on the window's size alone, so that a script knows its
// pixels.
#pragma once

namespace relumine::viewer {

/// Pixels of the window, from its top left corner.
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

/// Left the scene under its tools; right the environment under its own, the layers below; a line of
/// figures at the bottom.
struct PanelLayout {
    PixelRectangle scene_tools;
    PixelRectangle scene;
    PixelRectangle environment_tools;
    /// Twice as wide as high
    PixelRectangle environment;
    PixelRectangle layers;
    PixelRectangle status;
};

[[nodiscard]] PanelLayout panel_layout(int width, int height);

} // namespace relumine::viewer
