#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/first_picture_stages.h"
#include "app/options/bounce_option.h"
#include "app/options/environment_options.h"
#include "app/options/eye_options.h"
#include "app/options/output_options.h"
#include "app/options/plan_option.h"
#include "app/scenes/lit_scene.h"
#include "files/counted.h"
#include "files/extension.h"
#include "relumine/in/shared_work.h"
#include "relumine/light/harmonics_file.h"
#include "relumine/light/light_lists.h"
#include "relumine/light/lit_part.h"
#include "relumine/out/first_sight.h"

namespace relumine::app {

namespace {

/// Nine coefficients a channel, the first four of which are those of order 2.
constexpr std::uint32_t HarmonicsOrder = 3;

struct RelightArguments {
    SceneOptions scene;
    EnvironmentOptions environment;
    /// A light list, alone or added to the environment
    std::string lights;
    OutputOptions output;
    BounceOption bounces;
    /// A file for the arriving light; empty: none
    std::string harmonics;
    /// count is 0 until --part is given.
    prt::Part part = {.index = 0, .count = 0};
};

void keep_bounces(Lighting& lighting, std::span<const glm::vec3> bounced) {
    lighting.radiance = bounced;
    lighting.reflected = {};
    lighting.soft.clear();
    lighting.lights.clear();
    lighting.floor_lights.clear();
    lighting.open_floor.reset();
}

/// Parts are numbers alone: what shapes a picture does not suit them.
void require_numbers(const RelightArguments& options, const Command& command) {
    constexpr std::array<std::string_view, 17> Fitting = {
        "SCENE",     "ENV",      "--output",  "--part",  "--clusters-only",
        "--layout",  "--from",   "--fix-env", "--flip",  "--face-resolution",
        "--tilt",    "--rotate", "--json",    "--quiet", "--verbose",
        "--threads", "--bounces"};
    for (const std::string& name : command.given_options())
        if (std::find(Fitting.begin(), Fitting.end(), name) == Fitting.end())
            throw UsageError(name, "expected no such option with --part");
    if (options.environment.path.empty())
        throw UsageError("ENV", "expected an environment with --part");
    if (options.bounces.limits().num_bounces.value_or(0) != 0)
        throw UsageError("--bounces", "expected 0 with --part");
}

/// What is to light the scene, and what is known of it before.
struct Given {
    Light light;
    /// For people, and for --json
    std::string text;
    Report report;
};

Given given_light(const RelightArguments& options, Session& session) {
    Given given;
    Stopwatch watch;
    std::vector<lights::DistantLight> list;
    if (!options.lights.empty())
        list = lights::load_lights(options.lights).lights;
    given.report = {{"lights", list.size()}, {"seconds_list", watch.lap()}};
    if (!options.environment.path.empty()) {
        Environment environment = load_environment(options.environment, session);
        given.text =
            fmt::format("environment {:.0f}, resample {:.0f}, ", 1e3 * environment.seconds_load,
                        1e3 * environment.seconds_resample);
        files::update(given.report, {{"face_resolution", environment.map.resolution},
                                     {"environment", environment.assumptions},
                                     {"seconds_load", environment.seconds_load},
                                     {"seconds_resample", environment.seconds_resample}});
        given.light = Light(std::move(environment));
    }
    given.light.lights = std::move(list);
    return given;
}

/// "sky.exr (R = 256) and 3 lights of sun.json"
std::string name_of(const RelightArguments& options, const LitScene& lit, std::size_t num_lights) {
    if (options.environment.path.empty() && options.lights.empty())
        return "its own lamps";
    std::string list = fmt::format("{} of {}", files::counted(num_lights, "light"), options.lights);
    if (options.environment.path.empty())
        return list;
    return fmt::format("{} (R = {}){}", options.environment.path, environment_of(lit).resolution,
                       options.lights.empty() ? "" : " and " + list);
}

void check_harmonics(const std::string& path, const Scene& scene) {
    try {
        require_harmonics_path(path, scene);
    } catch (const std::invalid_argument& error) {
        throw UsageError("--harmonics", error.what());
    }
}

/// A picture that was made.
struct Lit {
    const Given& given;
    const LitScene& lit;
    const Painter& painter;
    std::size_t num_lights;
    UpdateReport times;
    std::optional<BounceReport> bounces;
    double seconds_load_scene, seconds_light, seconds_output, seconds;
};

/// ", lamps 12.3", and nothing where there are none
std::string time_text(const char* name, bool is_there, double seconds) {
    return is_there ? fmt::format(", {} {:.1f}", name, 1e3 * seconds) : "";
}

void report_light(const RelightArguments& options, Session& session, const Lit& made) {
    const Scene& scene = made.lit.scene();
    const UpdateReport& times = made.times;
    session.say(fmt::format(
        "{}: {} under {} in {:.2f} s{}: scene {:.0f}, {}bin {:.1f}, trace {:.1f} ({}), relight "
        "{:.1f}{}{}{}, output {:.0f} ms{}{}",
        options.output.path, files::counted(scene.receivers.num_own(), "receiver"),
        name_of(options, made.lit, made.num_lights), made.seconds,
        session.team != nullptr ? fmt::format(" by {} processes", session.team->part().count) : "",
        1e3 * made.seconds_load_scene, made.given.text, 1e3 * times.seconds_bin,
        1e3 * times.seconds_trace, files::counted(times.num_sharp_lights, "light"),
        1e3 * times.seconds_relight, time_text("lamps", !scene.lamps.empty(), times.seconds_lamps),
        time_text("highlights", made.lit.mirrors().is_needed(), times.seconds_highlights),
        text_of(made.bounces), 1e3 * made.seconds_output,
        options.scene.clusters_only ? ", through the clusters" : "",
        options.output.exposure_text(made.painter)));
    Report report = {{"receivers", scene.receivers.num_own()},
                     {"clusters", scene.transfer.num_clusters()},
                     {"traced", !options.scene.clusters_only},
                     {"seconds_load_scene", made.seconds_load_scene},
                     {"seconds_light", made.seconds_light},
                     {"seconds_bin", times.seconds_bin},
                     {"seconds_trace", times.seconds_trace},
                     {"seconds_relight", times.seconds_relight},
                     {"seconds_lamps", times.seconds_lamps},
                     {"seconds_highlights", times.seconds_highlights},
                     {"bounces", made.bounces ? made.bounces->num_bounces : 0},
                     {"seconds_bounces", made.bounces ? made.bounces->seconds : 0.0},
                     {"sharp_lights", times.num_sharp_lights},
                     {"exposure", made.painter.exposure_ev(options.output.path)},
                     {"seconds_output", made.seconds_output},
                     {"seconds", made.seconds}};
    files::update(report, made.given.report);
    if (session.team != nullptr)
        files::update(report,
                      {{"processes", session.team->part().count}, {"peak_bytes", peak_bytes()}});
    session.report(report);
}

/// Returns what draws a first sight of a mesh in place of the picture that takes longer. Empty
/// where none is wanted.
std::function<void(const Mesh&)> first_sight(const RelightArguments& options, const Light& light,
                                             Session& session) {
    const std::string extension = files::extension_of(options.output.path);
    if ((extension != ".png" && extension != ".exr") || options.bounces.are_alone() ||
        options.scene.colors != SurfaceColors())
        return {};
    return [&options, &light, &session, watch = Stopwatch(),
            progress = session.progress("first sight")](const Mesh& mesh) {
        if (progress)
            progress(0.0);
        Scene scene = quick_scene(mesh);
        options.output.check_fits(scene);
        const relumine::OutputOptions picture = quick_picture(options.output.for_scene(scene));
        LitScene lit(std::move(scene), {.highlight_rays = picture.highlight_rays});
        lit.dim(picture.emission);
        lit.light(light);
        save(lit, options.output.path, picture);
        if (progress)
            progress(1.0);
        session.say(fmt::format("{}: a first sight, small and without bounces, after {:.1f} s; the "
                                "picture follows",
                                options.output.path, watch.total()));
        session.poll();
    };
}

/// Lights the scene with an environment, a list, or both; alone or with the processes of a team,
/// whose first one writes the output.
void light_scene(const RelightArguments& options, Session& session) {
    Stopwatch watch;
    options.scene.check();
    Given given;
    SceneOptions with_sight = options.scene;
    if (options.scene.is_first_picture()) {
        const relumine::OutputOptions& picture = options.output.picture;
        session.begin_run("relight", first_picture_stages(1.0 * picture.width * picture.height));
        given = given_light(options, session);
        with_sight.before = first_sight(options, given.light, session);
        watch.lap();
    }
    LitScene lit = lit_scene(with_sight, session);
    const Scene& scene = lit.scene();
    if (options.environment.path.empty() && options.lights.empty() && scene.lamps.empty())
        throw UsageError("relight", "expected ENV, --lights or both, or a scene with lamps");
    options.output.check_fits(scene);
    if (!options.harmonics.empty())
        check_harmonics(options.harmonics, scene);
    const double seconds_load_scene = watch.lap();
    session.poll();
    if (!options.scene.is_first_picture())
        given = given_light(options, session);
    const std::size_t num_lights = given.light.lights.size();
    watch.lap();
    const relumine::OutputOptions output = options.output.for_scene(scene);
    lit.dim(output.emission);
    const UpdateReport times = lit.light(std::move(given.light));
    session.poll();
    if (session.is_first()) {
        options.output.warn_of_picture(scene, session);
        warn_of_eye_inside(lit, options.output.picture.eye, session);
        if (!options.scene.is_first_picture()) // which has said so
            for (const std::string& line : scene.settings.left_out)
                session.warn(fmt::format("{}: {}", scene.settings.source, line));
    }
    const std::optional<BounceReport> bounces =
        options.bounces.bounce(lit, output, options.scene.path);
    Lighting lighting = lit.lighting();
    const double seconds_light = watch.lap();
    if (!session.is_first()) {
        if (!options.harmonics.empty())
            save_harmonics(lit, options.harmonics); // of the first process, with these parts
        return;
    }
    const std::vector<glm::vec3> bounced = relumine::bounced(lit);
    if (options.bounces.are_alone())
        keep_bounces(lighting, bounced);
    Painter painter(lit, output);
    painter.on_progress(session.progress("picture"));
    painter.save(options.output.path, lighting);
    session.end_run();
    if (!options.harmonics.empty())
        save_harmonics(lit, options.harmonics);
    const double seconds_output = watch.lap();

    report_light(options, session,
                 {.given = given,
                  .lit = lit,
                  .painter = painter,
                  .num_lights = num_lights,
                  .times = times,
                  .bounces = bounces,
                  .seconds_load_scene = seconds_load_scene,
                  .seconds_light = seconds_light,
                  .seconds_output = seconds_output,
                  .seconds = watch.total()});
}

/// Lights a part of the receivers.
void light_one_part(const RelightArguments& options, const Command& command, Session& session) {
    require_numbers(options, command);
    require_part_name(options.output.path);
    check_output(options.output.path, {options.scene.path, options.environment.path});
    Stopwatch watch;
    Environment environment = load_environment(options.environment, session);
    std::size_t num_receivers = 0;
    const UpdateReport times = light_part({.scene = options.scene.path,
                                           .part = options.part,
                                           .output = options.output.path,
                                           .clusters_only = options.scene.clusters_only,
                                           .is_direct = options.bounces.limits().num_bounces == 0},
                                          std::move(environment.map), &num_receivers);
    const double seconds = watch.total();
    session.say(fmt::format("{}: part {} of {}, {} receivers under {} in {:.2f} s",
                            options.output.path, options.part.index + 1, options.part.count,
                            num_receivers, options.environment.path, seconds));
    session.report({{"part", options.part.index + 1},
                    {"parts", options.part.count},
                    {"receivers", num_receivers},
                    {"sharp_lights", times.num_sharp_lights},
                    {"seconds_relight", times.seconds_relight},
                    {"peak_bytes", peak_bytes()},
                    {"seconds", seconds}});
}

void run(const RelightArguments& options, const Command& command, Session& session) {
    if (session.team != nullptr && options.part.count != 0)
        throw UsageError("--part", "expected none where processes share the work");
    if (options.part.count != 0)
        return light_one_part(options, command, session);
    std::vector<std::string> inputs = {options.scene.path};
    for (const std::string& path : {options.environment.path, options.lights})
        if (!path.empty())
            inputs.push_back(path);
    if (session.is_first()) {
        options.output.check(inputs);
        if (!options.harmonics.empty())
            check_output(options.harmonics, inputs);
    }
    light_scene(options, session);
}

} // namespace

void add_relight(Command& program, Session& session) {
    Command command = program.add_command(
        "relight",
        "light a scene with an environment or a light list: a picture, a mesh or numbers");
    auto options = std::make_shared<RelightArguments>();
    options->scene.add_to(command);
    options->environment.add_to(command).required(false);
    command.add(
        row("--lights", options->lights,
            "a light list (.json, from `relumine lights` or `env convert --split-sun`), a shadow "
            "ray for each light; with ENV, both light together",
            {.file = true}));
    options->output.add_to(command);
    command.add(row("--part",
                    [options](const std::string& text) { options->part = parse_part(text); },
                    "light part I of N of the receivers, from 1/N to N/N; -o names the part, and "
                    "`relumine join` makes the numbers (.npy) of all parts",
                    {.type = "I/N"}));
    command.add(row("--harmonics", options->harmonics,
                    "write the light that arrives at each receiver, for any normal, as spherical "
                    "harmonics: .npy, .exr (layers; not of vertices), .json (three.js; of points "
                    "and grids)",
                    {.file = true}));
    options->bounces.add_to(command, true, true);
    session.add_common_options(command);
    command.on_run([options, command, &session] {
        if (!options->harmonics.empty())
            options->scene.harmonics = HarmonicsOrder;
        options->scene.highlight_rays = options->output.picture.highlight_rays;
        options->scene.lights_alone = options->environment.path.empty();
        run(*options, command, session);
    });
}

} // namespace relumine::app
