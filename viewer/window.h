// The window: GLFW, an OpenGL 3.3 core context and Dear ImGui, made and destroyed together.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "relumine/out/pictures.h"
#include "viewer/panel_layout.h"

namespace relumine::viewer {

/// A pointer that a script moves.
struct Pointer {
    glm::vec2 pixel{0.0f};
    bool down = false;
};

enum class Shortcut { Undo, Redo, Delete, FrameAll, Wireframe, Quadtree, SavePicture };

class Window {
public:
    /// Opens the window. If `scripted`, it ignores a person's mouse, and frames come as fast as
    /// they are drawn.
    ///
    /// Throws:  std::runtime_error when there is no display or no OpenGL 3.3.
    Window(int width, int height, const std::string& title, bool scripted);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    [[nodiscard]] bool should_close() const;
    /// In pixels of the window; the frame buffer may be finer.
    [[nodiscard]] PanelLayout layout() const;

    /// Takes events (waits up to `wait_seconds` for one) and begins a frame of Dear ImGui. A
    /// script's pointer replaces the real one.
    void begin_frame(double wait_seconds, const std::optional<Pointer>& pointer);
    /// Returns a part of the window in pixels of the frame buffer, from the lower left corner.
    [[nodiscard]] PixelRectangle in_framebuffer(const PixelRectangle& part) const;
    /// Sets the OpenGL viewport to a part of the window.
    void set_viewport(const PixelRectangle& part) const;
    /// Draws Dear ImGui's frame over the pictures.
    void end_frame();
    /// Returns the picture that is about to be shown. Call it before show().
    [[nodiscard]] relight::Picture screenshot() const;
    void show();

    /// Returns the files that were dropped since the last call.
    [[nodiscard]] std::vector<std::filesystem::path> take_dropped_files();
    [[nodiscard]] std::vector<Shortcut> take_shortcuts();
    /// Returns where the keys W, A, S, D, Q and E steer while the right button is down: right, up
    /// and forward, each from -1 to 1, with Shift from -4 to 4.
    [[nodiscard]] glm::vec3 steering() const;

    /// OpenGL's own words about the renderer.
    [[nodiscard]] std::string renderer() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace relumine::viewer
