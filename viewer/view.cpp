#include "viewer/view.h"

#include <chrono>
#include <utility>
#include <vector>

#include <imgui.h>

#include "relight/contribution.h"
#include "viewer/cube_texture.h"
#include "viewer/environment_renderer.h"
#include "viewer/panels.h"
#include "viewer/scene_renderer.h"
#include "viewer/script_player.h"
#include "viewer/window.h"

namespace relumine::viewer {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The OpenGL side of the state.
class Pictures {
public:
    explicit Pictures(const ViewState& state)
        : scene_(state.mesh), environment_(state.desk.editor().relighter().transfer().quadtree) {}

    /// Sends changes by edits to the graphics card.
    void update(ViewState& state) {
        const relight::LightEditor& editor = state.desk.editor();
        if (const auto version = state.desk.version(); version != version_) {
            version_ = version;
            std::vector<glm::vec3> colors(editor.radiance().begin(), editor.radiance().end());
            for (std::size_t i = 0; i < colors.size(); ++i)
                colors[i] *= state.albedo[i];
            scene_.upload_radiance(colors);
            texture_.upload(editor.environment(), state.desk.take_changed_texels());
        }
        // The heat map stays as it was while a layer is dragged: it costs as much as a relighting.
        if (state.heat_is_stale && state.receiver && state.environment_look.heat &&
            !state.desk.is_dragging() && !state.desk.is_painting()) {
            environment_.upload_heat(
                relight::contribution_map(editor.relighter(), {&*state.receiver, 1}));
            state.heat_is_stale = false;
        }
    }

    void draw(const ViewState& state, const Window& window, const PanelLayout& layout) const {
        window.set_viewport(layout.scene);
        scene_.draw(state.camera, layout.scene, texture_, state.scene_look);
        window.set_viewport(layout.environment);
        EnvironmentLook look = state.environment_look;
        look.heat = look.heat && state.receiver;
        environment_.draw(state.lat_long, layout.environment, texture_, look);
    }

private:
    SceneRenderer scene_;
    EnvironmentRenderer environment_;
    CubeTexture texture_;
    std::uint64_t version_ = 0;
};

void handle(Shortcut shortcut, ViewState& state, const PanelLayout& layout) {
    switch (shortcut) {
    case Shortcut::Undo:
        state.desk.undo();
        state.heat_is_stale = true;
        break;
    case Shortcut::Redo:
        state.desk.redo();
        state.heat_is_stale = true;
        break;
    case Shortcut::Delete:
        if (state.desk.selected() && !state.desk.is_dragging() && !state.desk.is_painting())
            state.desk.remove(*state.desk.selected());
        break;
    case Shortcut::FrameAll:
        state.camera = camera_on_all(state.mesh, layout.scene);
        break;
    case Shortcut::Wireframe:
        state.scene_look.wireframe = !state.scene_look.wireframe;
        break;
    case Shortcut::Quadtree:
        state.environment_look.quadtree = !state.environment_look.quadtree;
        break;
    }
}

/// Counts frames without any input, so that an idle window takes no power.
class Idleness {
public:
    void count() {
        const ImGuiIO& io = ImGui::GetIO();
        const bool busy = io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f ||
                          io.MouseWheel != 0.0f || ImGui::IsAnyMouseDown() ||
                          ImGui::IsAnyItemActive();
        idle_frames_ = busy ? 0 : idle_frames_ + 1;
    }
    [[nodiscard]] double wait_seconds() const { return idle_frames_ > 5 ? 0.1 : 0.0; }

private:
    int idle_frames_ = 0;
};

} // namespace

ViewReport view(ViewState& state, const ViewOptions& options) {
    Window window(options.width, options.height, "Relumine", options.script.has_value());
    Pictures pictures(state);
    ScriptPlayer player(options.script.value_or(std::vector<ScriptCommand>{}));
    Idleness idleness;
    state.camera = camera_on_all(state.mesh, window.layout().scene);
    ViewReport report{.renderer = window.renderer()};
    double seconds = 0.0;

    bool is_last = false;
    while (!is_last && !window.should_close() && !options.stop.stop_requested()) {
        ScriptPlayer::Frame scripted;
        if (options.script) {
            scripted = player.step(state);
            is_last = player.is_done();
        }
        window.begin_frame(options.script ? 0.0 : idleness.wait_seconds(), scripted.pointer);
        const auto start = Clock::now();
        for (const std::filesystem::path& path : window.take_dropped_files())
            drop(state, path);
        for (const Shortcut shortcut : window.take_shortcuts())
            handle(shortcut, state, window.layout());

        // The panels come first, so that this frame shows what the pointer does in it.
        const PanelLayout layout = window.layout();
        scene_panel(state, layout);
        environment_panel(state, layout);
        layer_panel(state, layout);
        status_panel(state, layout);
        drop_dialogue(state);
        idleness.count();
        pictures.update(state);
        pictures.draw(state, window, layout);
        window.end_frame();
        if (!scripted.screenshot.empty())
            relight::save_picture(scripted.screenshot, window.screenshot());
        if (is_last && !options.screenshot.empty())
            relight::save_picture(options.screenshot, window.screenshot());
        window.show();
        state.frame_seconds = seconds_since(start);
        seconds += state.frame_seconds;
        ++report.num_frames;
    }
    if (report.num_frames > 0)
        report.mean_frame_seconds = seconds / static_cast<double>(report.num_frames);
    report.drag_seconds.assign(state.desk.drag_seconds().begin(), state.desk.drag_seconds().end());
    return report;
}

} // namespace relumine::viewer
