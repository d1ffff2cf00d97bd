// A picture with several samples a pixel, to be shown in a part of the window.
#pragma once

#include "viewer/gl_objects.h"

namespace relumine::viewer {

/// Draws go to a buffer of its own, so edges are smooth whatever the window's buffer is.
class MultisampleTarget {
public:
    /// Sends all that is drawn from now on here. The viewport is the whole buffer.
    void begin(int width, int height);
    /// Puts the picture into the window's buffer with its lower left corner at a pixel, and sends
    /// all that is drawn from now on there.
    void show_at(int x, int y) const;

private:
    GlFramebuffer framebuffer_;
    GlRenderbuffer color_;
    GlRenderbuffer depth_;
    int width_ = 0, height_ = 0;
};

} // namespace relumine::viewer
