#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/bounce_option.h"
#include "app/options/environment_options.h"
#include "app/options/eye_options.h"
#include "app/options/output_options.h"
#include "app/options/receiver_options.h"
#include "app/scenes/lit_scene.h"
#include "relumine/light/light_parts.h"
#include "relumine/out/first_sight.h"
#include "relumine/out/level_camera.h"

#ifndef RELUMINE_VIEWER_MISSING
#include "viewer/view.h"
#endif

namespace relumine::app {

namespace {

struct Options {
    SceneOptions scene{.harmonics_of_points = relight::MaxHarmonicOrder};
    EnvironmentOptions environment;
    BounceOption bounces;
    std::string layers;
    std::string script;
    /// Empty: no picture is written.
    std::string output;
    /// The window's size, the exposure, the tone curve and the floor of pictures count.
    relumine::OutputOptions picture = {.width = 1440, .height = 860};
    EyeOptions eye = {.budget_ms = 25.0, .seen_only = true};
};

#ifdef RELUMINE_VIEWER_MISSING

void run(const Options& /*options*/, Session& /*session*/) {
    throw std::runtime_error("view: expected a build with its window, as Debian's package of "
                             "relumine is, got one without " RELUMINE_VIEWER_MISSING);
}

#else

/// Without an environment: an even grey, in which layers show.
cubemap::CubeMap plain_grey() {
    constexpr std::uint32_t Resolution = 256;
    return cubemap::CubeMap(Resolution, glm::vec3(0.25f));
}

viewer::Shading shading_of(const Scene& scene, std::span<const EmissionGain> gains) {
    return {.albedo = picture_albedo(scene),
            .floor = picture_floor(scene),
            .surfaces = scene.receivers.surfaces,
            .textures = relight::SurfaceColors(scene.mesh, scene.receivers.surfaces,
                                               scene.transfer.glossy.has_value()),
            .eye_cosines = prt::eye_cosines(scene.receivers),
            .emission = emission_of(scene, gains),
            .emission_gains = triangle_gains(scene, gains),
            .eye = scene.settings.view ? std::optional(scene.settings.view->eye) : std::nullopt,
            .bias = scene.settings.bias};
}

viewer::Shading shading_of(const ProbeBalls& balls, const Scene& scene) {
    return {
        .albedo = balls.albedo(scene), .floor = balls.floor(scene), .bias = scene.settings.bias};
}

void report(const viewer::ViewReport& result, const viewer::ViewState& state, const LitScene& lit,
            const Session& session) {
    const std::vector<double>& seconds = result.drag_seconds;
    const std::string camera = viewer::camera_options(state.camera, lit.scene().mesh.offset);
    double sum = 0.0;
    double worst = 0.0;
    for (const double value : seconds) {
        sum += value;
        worst = std::max(worst, value);
    }
    const double mean = seconds.empty() ? 0.0 : sum / static_cast<double>(seconds.size());
    session.say(
        fmt::format("{} frames, {:.1f} ms each ({}); {} drag events relit in {:.2f} ms on average, "
                    "{:.2f} ms at worst",
                    result.num_frames, 1e3 * result.mean_frame_seconds, result.renderer,
                    seconds.size(), 1e3 * mean, 1e3 * worst));
    session.report({{"renderer", result.renderer},
                    {"camera", camera},
                    {"frames", result.num_frames},
                    {"seconds_frame_mean", result.mean_frame_seconds},
                    {"clusters", lit.relighter().transfer().num_clusters()},
                    {"receivers", lit.radiance().size()},
                    {"face_resolution", environment_of(lit).resolution},
                    {"live_highlights", state.live_eye != nullptr},
                    {"drag_events", seconds.size()},
                    {"seconds_drag_mean", mean},
                    {"seconds_drag_worst", worst},
                    {"seconds_drag", seconds}});
}

/// What a window begins with, and what the next one takes over from it.
struct Beginning {
    LightState light;
    std::optional<viewer::OrbitCamera> camera = {};
    std::optional<viewer::SceneLook> scene_look = {};
    std::optional<viewer::EnvironmentLook> environment_look = {};
};

/// The window stays level.
void warn_of_roll(const Scene& scene, const Options& options, const Session& session) {
    if (const float roll = leveled(camera_of(scene, options.picture)).roll_degrees; roll != 0.0f)
        session.warn(fmt::format("{}: its camera is turned by {:.3g} degrees about its view, but "
                                 "the window stands level",
                                 options.scene.path, roll));
}

/// Reads environments as the options say.
auto loader(const Options& options, Session& session) {
    return [&](const std::filesystem::path& path) {
        EnvironmentOptions environment = options.environment;
        environment.path = path.string();
        environment.rotate_degrees = 0.0; // the window turns it itself
        return load_environment(environment, session);
    };
}

/// Shows a scene in the light of `beginning`, and leaves there what the person made of it.
/// `is_quick`: the whole scene follows.
void show(LitScene& lit, const Options& options, viewer::ViewOptions view, bool is_quick,
          Beginning& beginning, Session& session) {
    const bool shows_points = lit.scene().receivers.num_points() != 0;
    if (!shows_points)
        require_vertices(lit.scene(), options.scene.path);
    lit.dim(options.picture.emission);
    lit.environment().edit(beginning.light);
    if (!is_quick)
        options.bounces.bounce(lit, {}, options.scene.path);
    viewer::LightDesk desk(lit);
    std::optional<ProbeBalls> balls;
    std::optional<prt::RayScene> rays_of_balls;
    if (shows_points) {
        balls.emplace(lit.scene());
        rays_of_balls.emplace(balls->mesh());
    }
    viewer::ViewState state{.mesh = balls ? balls->mesh() : lit.scene().mesh,
                            .rays = balls ? *rays_of_balls : lit.rays().of_mesh(),
                            .desk = desk,
                            .shading = balls ? shading_of(*balls, lit.scene())
                                             : shading_of(lit.scene(), options.picture.emission),
                            .picture = options.picture,
                            .load_environment = loader(options, session)};
    state.balls = balls ? &*balls : nullptr;
    state.eye_options = options.eye;
    if (has_live_highlights(lit.scene())) {
        state.live_eye = std::make_unique<LiveEye>(lit);
        if (!is_quick)
            warn_of_smooth_surfaces(state.live_eye->num_too_smooth(), session);
        state.roughness = state.live_eye->mean_roughness();
    }
    if (!beginning.scene_look) {
        if (!options.layers.empty() && !viewer::open(state, options.layers))
            throw std::runtime_error(state.message);
        state.scene_look.exposure_ev = static_cast<float>(
            options.picture.exposure_ev ? *options.picture.exposure_ev
                                        : Painter(lit, {}).choose_exposure_ev(lit.lighting()));
        state.environment_look.exposure_ev = state.scene_look.exposure_ev;
        state.scene_look.tone = options.picture.tone;
        state.environment_look.tone = state.scene_look.tone;
    } else {
        state.scene_look = *beginning.scene_look;
        state.environment_look = *beginning.environment_look;
    }
    if (is_quick)
        state.message = "A first sight: the whole scene is on its way.";
    view.camera = beginning.camera;
    if (!is_quick)
        warn_of_roll(lit.scene(), options, session);
    const viewer::ViewReport result = viewer::view(state, view);
    if (is_quick)
        session.add_to_report("frames_of_first_sight", result.num_frames);
    beginning = {.light = lit.environment().state(),
                 .camera = state.camera,
                 .scene_look = state.scene_look,
                 .environment_look = state.environment_look};
    if (!is_quick)
        report(result, state, lit, session);
}

/// Returns the scene. Where it takes a precompute, a window shows a quick one until it is there.
/// None where a person closed that window.
std::optional<LitScene> whole_scene(const Options& options, viewer::ViewOptions view,
                                    Beginning& beginning, Session& session) {
    std::promise<Mesh> mesh;
    std::future<Mesh> sight = mesh.get_future();
    std::promise<void> go_on;
    SceneOptions scene = options.scene;
    scene.before = [&](const Mesh& found) {
        mesh.set_value(found);
        go_on.get_future().wait();
    };
    std::stop_source is_over;
    const std::stop_callback on_signal(session.stop(), [&] { is_over.request_stop(); });
    std::future<LitScene> whole = std::async(std::launch::async, [&] {
        const std::unique_ptr<std::stop_source, void (*)(std::stop_source*)> tell(
            &is_over, [](std::stop_source* over) { over->request_stop(); });
        return lit_scene(scene, session);
    });
    constexpr auto Moment = std::chrono::milliseconds(10);
    while (sight.wait_for(Moment) != std::future_status::ready && !is_over.stop_requested())
        continue;
    if (is_over.stop_requested())
        return whole.get();
    view.stop = is_over.get_token();
    view.script.reset(); // it plays to the whole scene
    view.screenshot.clear();
    try {
        // The precompute waits, so that the window is soon there.
        LitScene quick = [&] {
            const std::unique_ptr<std::promise<void>, void (*)(std::promise<void>*)> then(
                &go_on, [](std::promise<void>* others) { others->set_value(); });
            return LitScene(quick_scene(sight.get()),
                            {.highlight_rays = options.scene.highlight_rays});
        }();
        show(quick, options, view, true, beginning, session);
    } catch (...) {
        session.cancel();
        throw;
    }
    if (is_over.stop_requested())
        return whole.get();
    session.cancel();
    whole.wait();
    return std::nullopt;
}

void run(const Options& options, Session& session) {
    check(options.picture);
    viewer::ViewOptions view{.screenshot = options.output, .stop = session.stop()};
    view.width = static_cast<int>(options.picture.width);
    view.height = static_cast<int>(options.picture.height);
    if (!options.output.empty())
        check_output(options.output,
                     {options.scene.path, options.environment.path, options.script});
    if (!options.script.empty())
        view.script = viewer::load_script(options.script);
    else if (!options.output.empty())
        view.script = viewer::parse_script("wait 2", "--output");

    options.scene.check();
    const std::string& path = options.environment.path;
    Beginning beginning{
        .light = {.base = base_of(
                      path.empty() ? Environment{.map = plain_grey(), .file = {}, .assumptions = {}}
                                   : loader(options, session)(path)),
                  .rotation_degrees = options.environment.rotate_degrees}};
    std::optional<LitScene> lit = options.scene.is_first_picture()
                                      ? whole_scene(options, view, beginning, session)
                                      : lit_scene(options.scene, session);
    if (!lit)
        return;
    session.poll();
    show(*lit, options, view, false, beginning, session);
    session.poll();
}

#endif

} // namespace

void add_view(Command& program, Session& session) {
    Command command = program.add_command("view", "light the scene by hand, in a window");
    auto options = std::make_shared<Options>();
    options->scene.add_to(command);
    options->environment.add_to(command).required(false);
    command.add(
        row("LAYERS", options->layers, "light layers to begin with, .json", {.file = true}));
    options->bounces.add_to(command);
    for (OptionRow& each : options_of(options->picture))
        if ((each.part == "camera" && each.name != "--size") || each.name == "--exposure" ||
            each.name == "--tone-map" || each.name == "--floor" || each.name == "--photo-height" ||
            each.name == "--emission")
            command.add(std::move(each));
    const Option tolerance = command.add(glossy_tolerance_row(options->eye));
    command.add(size_row(options->picture.width, options->picture.height, "the window's size",
                         {.min = 320}));
    command.add(row("--script", options->script,
                    "play a script instead of waiting for a person (docs/viewer.md)",
                    {.file = true}));
    command.add(row("-o,--output", options->output,
                    "write the last frame of the script, or the first there is, as .png or .exr",
                    {.file = true}));
    session.add_common_options(command);
    command.on_run([options, tolerance, &session] {
        if (tolerance.is_given())
            options->eye.budget_ms = 0.0;
        run(*options, session);
    });
}

} // namespace relumine::app
