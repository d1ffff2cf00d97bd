#include "viewer/view.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include <imgui.h>

#include "files/seconds.h"
#include "relumine/ask/questions.h"
#include "relumine/light/layer_compositor.h"
#include "viewer/cube_texture.h"
#include "viewer/environment_renderer.h"
#include "viewer/panels.h"
#include "viewer/refiner.h"
#include "viewer/scene_renderer.h"
#include "viewer/script.h"
#include "viewer/window.h"

namespace relumine::viewer {

namespace {

using Clock = std::chrono::steady_clock;

/// What a refined picture depends on.
struct Scenery {
    std::uint64_t version = 0;
    OrbitCamera camera = {};
    PixelRectangle size = {};
    bool background = true;
    bool operator==(const Scenery&) const = default;
};

Moment moment_of(const ViewState& state, const PixelRectangle& size) {
    const OrbitCamera& camera = state.camera;
    Moment moment{.camera = picture_camera(camera),
                  .width = static_cast<std::uint32_t>(std::max(size.width, 1)),
                  .height = static_cast<std::uint32_t>(std::max(size.height, 1)),
                  .radiance = {},
                  .lights = {},
                  .backdrop = {}};
    Lighting lighting = state.desk.lit().lighting(state.balls == nullptr);
    const Scene& scene = state.desk.lit().scene();
    const FloorLook look = floor_look(scene, lighting, state.picture);
    moment.open_floor = open_floor(scene, lighting, look, camera.eye());
    moment.lobes = std::move(lighting.lobes);
    moment.harmonics = std::move(lighting.harmonics);
    if (state.shading.textures.has_mirrors() && lighting.environment != nullptr) {
        moment.mirrored.assign(lighting.drawn().begin(), lighting.drawn().end());
        moment.environment = std::make_shared<const cubemap::CubeMap>(*lighting.environment);
        moment.num_environment_lights = lighting.num_environment_lights;
    }
    moment.lights = std::move(lighting.lights);
    moment.radiance = std::move(lighting.soft);
    if (state.balls != nullptr)
        moment.radiance = state.balls->radiance(state.desk.lit());
    else if (moment.lights.empty())
        moment.radiance.assign(lighting.drawn().begin(), lighting.drawn().end());
    if (state.scene_look.background)
        moment.backdrop =
            on_floor(backdrop_of(state), scene, lighting, look, camera.eye(), state.picture);
    return moment;
}

/// Whether the pointer has something in its hand.
bool is_held(const ViewState& state) {
    return state.hand.is_dragging() || state.hand.is_painting() || state.thing.is_dragging();
}

/// The OpenGL side of the state.
class Pictures {
public:
    explicit Pictures(const ViewState& state)
        : desk_(state.desk), scene_(state.mesh, state.shading.floor),
          environment_(state.desk.lit().relighter().transfer().quadtree),
          mesh_version_(state.desk.mesh_version()), roughness_(state.roughness),
          refiner_(state.mesh, state.rays, state.shading) {
        desk_.on_move([this] { refiner_.stop(); });
    }
    ~Pictures() {
        desk_.on_move([] {});
    }
    Pictures(const Pictures&) = delete;
    Pictures& operator=(const Pictures&) = delete;

    /// Sends changes by edits to the graphics card.
    void update(ViewState& state, const PixelRectangle& viewport) {
        const LitScene& lit = state.desk.lit();
        if (state.live_eye && state.roughness != roughness_) {
            refiner_.stop();
            roughness_ = state.roughness;
            state.desk.set_roughness(roughness_);
            state.live_eye->take_surfaces();
        }
        if (mesh_version_ != state.desk.mesh_version()) {
            mesh_version_ = state.desk.mesh_version();
            scene_.upload_mesh(state.mesh);
            if (state.live_eye)
                state.live_eye = std::make_unique<LiveEye>(lit);
        }
        const auto version = state.desk.version();
        const bool is_relit = version != version_;
        version_ = version;
        if (is_relit) {
            if (const std::vector<EmissionGain>& gains = lit.lamps().gains(); gains != gains_)
                take_emission(state.shading, lit.scene(), gains);
            find_floor(state);
            texture_.upload(environment_of(lit), state.desk.take_changed_texels());
            const auto seen = seen_environment(lit.environment().state());
            hides_layers_ = seen != nullptr;
            if (seen)
                behind_.upload(*seen, cubemap::all_texels(seen->resolution));
            if (state.live_eye)
                state.live_eye->take_light();
        }
        const std::array<glm::vec4, 4> sides = picture_sides(state.camera, viewport);
        if (is_relit || (state.live_eye && sides != sides_)) {
            sides_ = sides;
            std::vector<glm::vec3> colors;
            if (state.balls != nullptr) {
                colors = state.balls->radiance(lit);
            } else {
                const std::span<const glm::vec3> seen =
                    state.live_eye
                        ? state.live_eye->look(state.camera.eye(), state.eye_options, sides)
                        : lit.radiance();
                colors.assign(seen.begin(), seen.end());
            }
            for (std::size_t i = 0; i < colors.size(); ++i)
                if (floor_.look == FloorLook::Grey || i < state.shading.floor.first_vertex)
                    colors[i] *= state.shading.albedo[i];
            for (std::size_t i = 0; i < state.shading.emission.size(); ++i)
                colors[i] += state.shading.emission[i];
            scene_.upload_radiance(colors);
        }
        // The heat map stays as it was while a layer is dragged: it costs as much as a relighting.
        if (state.heat_is_stale && state.receiver && state.environment_look.heat &&
            !is_held(state)) {
            environment_.upload_heat(contribution_map(lit, {&*state.receiver, 1}));
            state.heat_is_stale = false;
        }
    }

    /// Takes what lamps glow with now. Nothing is drawn meanwhile.
    void take_emission(Shading& shading, const Scene& scene,
                       const std::vector<EmissionGain>& gains) {
        refiner_.stop();
        shading.emission = emission_of(scene, gains);
        shading.emission_gains = triangle_gains(scene, gains);
        gains_ = gains;
    }

    /// Draws the scene finely where nothing has moved for a moment, or at once.
    void refine(const ViewState& state, const PixelRectangle& size, bool at_once) {
        constexpr double Pause = 0.2; // seconds
        const Scenery now{.version = version_,
                          .camera = state.camera,
                          .size = size,
                          .background = state.scene_look.background};
        if (now != seen_) {
            refiner_.stop();
            seen_ = now;
            since_ = Clock::now();
            is_refined_ = is_refining_ = false;
        }
        if (at_once) {
            scene_.upload_picture(refiner_.draw(moment_of(state, size)));
            is_refined_ = is_refining_ = true;
        } else if (!is_refining_ && files::seconds_since(since_) > Pause && !is_held(state)) {
            refiner_.start(moment_of(state, size));
            is_refining_ = true;
        }
        if (const std::optional<relight::Picture> picture = refiner_.take()) {
            scene_.upload_picture(*picture);
            is_refined_ = true;
        }
    }

    /// Shows what the graphics card draws.
    void show_live() { is_refined_ = false; }

    void draw(const ViewState& state, const Window& window, const PanelLayout& layout) {
        const PixelRectangle place = window.in_framebuffer(layout.scene);
        if (is_refined_ && !state.scene_look.wireframe) {
            window.set_viewport(layout.scene);
            scene_.draw_picture(state.scene_look);
        } else {
            target_.begin(place.width, place.height);
            scene_.draw(state.camera, layout.scene, hides_layers_ ? behind_ : texture_,
                        state.scene_look, floor_);
            target_.show_at(place.x, place.y);
        }
        window.set_viewport(layout.environment);
        EnvironmentLook look = state.environment_look;
        look.heat = look.heat && state.receiver;
        environment_.draw(state.lat_long, layout.environment, texture_, look);
    }

private:
    /// Looks at the light; how the floor is shown depends on the environment below the layers.
    void find_floor(const ViewState& state) {
        const LitScene& lit = state.desk.lit();
        const Lighting lighting = lit.lighting(false);
        if (!floor_base_ || floor_base_ != lit.environment().state().base) {
            floor_base_ = lit.environment().state().base;
            floor_.look = floor_look(lit.scene(), lighting, state.picture);
        }
        if (floor_.look == FloorLook::Grey)
            return;
        floor_.ground = picture_ground(lit.scene(), state.picture);
        floor_.open = *lighting.open_floor;
        floor_.color = studio_color(lighting, state.picture);
    }

    LightDesk& desk_;
    SceneRenderer scene_;
    FloorScene floor_;
    std::shared_ptr<const LightBase> floor_base_;
    EnvironmentRenderer environment_;
    MultisampleTarget target_;
    CubeTexture texture_;
    /// What the camera sees of it, where layers are hidden from it.
    CubeTexture behind_;
    bool hides_layers_ = false;
    std::uint64_t version_ = 0, mesh_version_ = 0;
    /// That of the scene's materials.
    float roughness_ = 0.0f;
    /// Those of the shading.
    std::vector<EmissionGain> gains_;
    /// The sides of the picture that the colours are for.
    std::array<glm::vec4, 4> sides_{};
    Scenery seen_;
    Clock::time_point since_ = Clock::now();
    bool is_refining_ = false, is_refined_ = false;
    Refiner refiner_;
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
        if (state.thing.is_dragging())
            state.thing.take_away();
        else if (state.desk.selected() && !is_held(state))
            remove(state.desk, *state.desk.selected());
        break;
    case Shortcut::FrameAll:
        state.camera = camera_on_all(state.desk.lit().scene(), layout.scene, state.picture);
        break;
    case Shortcut::Wireframe:
        state.scene_look.wireframe = !state.scene_look.wireframe;
        break;
    case Shortcut::Quadtree:
        state.environment_look.quadtree = !state.environment_look.quadtree;
        break;
    case Shortcut::SavePicture:
        save_picture(state, layout.scene, new_picture(state));
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

void panels(ViewState& state, const PanelLayout& layout) {
    scene_panel(state, layout);
    environment_panel(state, layout);
    layer_panel(state, layout);
    status_panel(state, layout);
    drop_dialogue(state);
}

} // namespace

ViewReport view(ViewState& state, const ViewOptions& options) {
    Window window(options.width, options.height, "Relumine", options.script.has_value());
    Pictures pictures(state);
    ScriptPlayer player(options.script.value_or(std::vector<ScriptCommand>{}));
    Idleness idleness;
    state.camera = options.camera ? *options.camera
                                  : camera_on_all(state.desk.lit().scene(), window.layout().scene,
                                                  state.picture);
    ViewReport report{.renderer = window.renderer()};
    double seconds = 0.0;

    bool is_last = false;
    do {
        ScriptPlayer::Frame scripted;
        if (options.script) {
            scripted = player.step(state, window.layout().scene);
            is_last = player.is_done();
        }
        const bool is_busy = options.script || !state.desk.lit().bounces().is_settled();
        window.begin_frame(is_busy ? 0.0 : idleness.wait_seconds(), scripted.pointer);
        const auto start = Clock::now();
        for (const std::filesystem::path& path : window.take_dropped_files())
            drop(state, path);
        for (const Shortcut shortcut : window.take_shortcuts())
            handle(shortcut, state, window.layout());

        state.steering = window.steering();

        // The panels come first, so that this frame shows what the pointer does in it.
        const PanelLayout layout = window.layout();
        panels(state, layout);
        idleness.count();
        const bool is_kept =
            !scripted.screenshot.empty() || (is_last && !options.screenshot.empty());
        if (is_kept)
            state.desk.bounce(true);
        else
            state.desk.bounce();
        pictures.update(state, layout.scene);
        if (!options.script || is_kept)
            pictures.refine(state, window.in_framebuffer(layout.scene), is_kept);
        else
            pictures.show_live();
        pictures.draw(state, window, layout);
        window.end_frame();
        if (!scripted.screenshot.empty())
            relight::save_picture(scripted.screenshot, window.screenshot());
        if (is_last && !options.screenshot.empty())
            relight::save_picture(options.screenshot, window.screenshot());
        window.show();
        state.frame_seconds = files::seconds_since(start);
        seconds += state.frame_seconds;
        ++report.num_frames;
    } while (!is_last && !window.should_close() && !options.stop.stop_requested());
    report.mean_frame_seconds = seconds / static_cast<double>(report.num_frames);
    for (const std::span<const double> seconds_of : {state.hand.seconds(), state.thing.seconds()})
        report.drag_seconds.insert(report.drag_seconds.end(), seconds_of.begin(), seconds_of.end());
    return report;
}

} // namespace relumine::viewer
