#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
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
    std::string screenshot;
    /// The window's size, the exposure, the tone curve and the floor of pictures count.
    relumine::OutputOptions picture = {.width = 1440, .height = 860};
    EyeOptions eye = {.budget_ms = 25.0, .seen_only = true};
};

#ifdef RELUMINE_VIEWER_MISSING

void run(const Options& /*options*/, Session& /*session*/) {
    throw std::runtime_error(
        "view: this relumine was built without its window; missing were: " RELUMINE_VIEWER_MISSING);
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
    const std::string camera = viewer::camera_options(state.camera);
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

void run(const Options& options, Session& session) {
    check(options.picture);
    viewer::ViewOptions view{.screenshot = options.screenshot, .stop = session.stop()};
    view.width = static_cast<int>(options.picture.width);
    view.height = static_cast<int>(options.picture.height);
    const std::optional<double> exposure_ev = options.picture.exposure_ev;
    if (!options.screenshot.empty())
        check_output(options.screenshot,
                     {options.scene.path, options.environment.path, options.script});
    if (!options.script.empty())
        view.script = viewer::load_script(options.script);
    else if (!options.screenshot.empty())
        view.script = viewer::parse_script("wait 2", "--screenshot");

    LitScene lit = lit_scene(options.scene, session);
    const bool shows_points = lit.scene().receivers.num_points() != 0;
    if (!shows_points)
        require_vertices(lit.scene(), options.scene.path);
    lit.dim(options.picture.emission);
    session.poll();
    const auto load = [&](const std::filesystem::path& path) {
        EnvironmentOptions environment = options.environment;
        environment.path = path.string();
        environment.rotate_degrees = 0.0; // the window turns it itself
        return load_environment(environment, session);
    };
    const std::string& path = options.environment.path;
    lit.edit({.base = base_of(path.empty()
                                  ? Environment{.map = plain_grey(), .file = {}, .assumptions = {}}
                                  : load(path)),
              .rotation_degrees = options.environment.rotate_degrees});
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
                            .load_environment = load};
    state.balls = balls ? &*balls : nullptr;
    state.eye_options = options.eye;
    if (has_live_highlights(lit.scene())) {
        state.live_eye = std::make_unique<LiveEye>(lit);
        warn_of_smooth_surfaces(state.live_eye->num_too_smooth(), session);
        state.roughness = state.live_eye->mean_roughness();
    }
    if (!options.layers.empty() && !viewer::open(state, options.layers))
        throw std::runtime_error(state.message);
    state.scene_look.exposure_ev = static_cast<float>(
        exposure_ev ? *exposure_ev : Painter(lit, {}).choose_exposure_ev(lit.lighting()));
    state.environment_look.exposure_ev = state.scene_look.exposure_ev;
    state.scene_look.tone = options.picture.tone;
    state.environment_look.tone = state.scene_look.tone;
    const viewer::ViewReport result = viewer::view(state, view);
    report(result, state, lit, session);
    session.poll();
}

#endif

} // namespace

void add_view(Command& program, Session& session) {
    Command command = program.add_command("view", "light the scene by hand, in a window");
    auto options = std::make_shared<Options>();
    options->scene.add_to(command);
    options->environment.add_to(command).required(false);
    options->bounces.add_to(command);
    command.add(
        row("--layers", options->layers, "light layers to begin with, .json", {.file = true}));
    for (OptionRow& each : options_of(options->picture))
        if ((each.part == "camera" && each.name != "--size") || each.name == "--exposure" ||
            each.name == "--tone-map" || each.name == "--floor" || each.name == "--photo-height" ||
            each.name == "--emission")
            command.add(std::move(each));
    command.add(glossy_tolerance_row(options->eye));
    command.add(glossy_budget_row(options->eye));
    command.add(size_row(options->picture.width, options->picture.height, "the window's size",
                         {.min = 320}));
    command.add(row("--script", options->script,
                    "play a script instead of waiting for a person (docs/viewer.md)",
                    {.file = true}));
    command.add(row("--screenshot", options->screenshot,
                    "write the last frame of the script, or the first there is, as .png or .exr",
                    {.file = true}));
    session.add_common_options(command);
    command.on_run([options, &session] { run(*options, session); });
}

} // namespace relumine::app
