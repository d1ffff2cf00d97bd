#include <algorithm>
#include <array>
#include <filesystem>
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
#include "app/options/bounce_option.h"
#include "app/options/environment_options.h"
#include "app/options/lit_scene.h"
#include "app/options/output_options.h"
#include "app/options/plan_option.h"
#include "lights/light_file.h"
#include "relumine/lit_part.h"

namespace relumine::app {

namespace {

struct RelightArguments {
    SceneOptions scene{.mesh_too = true};
    EnvironmentOptions environment;
    /// A light list, alone or added to the environment
    std::string lights;
    OutputOptions output;
    BounceOption bounces;
    bool only_bounces = false;
    /// count is 0 until --part is given.
    prt::Part part = {.index = 0, .count = 0};
};

void keep_bounces(Lighting& lighting, std::span<const glm::vec3> bounced, const std::string& path) {
    if (bounced.empty())
        throw std::runtime_error(
            fmt::format("{}: expected bounces for --only-bounces, got none", path));
    lighting.radiance = bounced;
    lighting.soft.clear();
    lighting.lights.clear();
}

/// What surfaces add to the light alone, if that is asked for.
Lighting chosen_lighting(const RelightArguments& options, const LitScene& lit) {
    Lighting lighting = lit.lighting();
    if (options.only_bounces)
        keep_bounces(lighting, lit.bounced(), options.scene.path);
    return lighting;
}

/// Adds the light of a list. `radiance` is the list's, and becomes the sum.
void add(Lighting& lighting, Lighting list, std::vector<glm::vec3>& radiance) {
    const auto sum = [](std::span<const glm::vec3> a, std::vector<glm::vec3>& b) {
        std::transform(a.begin(), a.end(), b.begin(), b.begin(), std::plus<>());
    };
    std::vector<glm::vec3> soft = list.lights.empty() ? radiance : std::move(list.soft);
    sum(lighting.lights.empty() ? lighting.radiance : std::span<const glm::vec3>(lighting.soft),
        soft);
    lighting.soft = std::move(soft);
    lighting.lights.insert(lighting.lights.end(), list.lights.begin(), list.lights.end());
    sum(lighting.radiance, radiance);
    lighting.radiance = radiance;
}

void light_with_environment(const RelightArguments& options, Session& session) {
    Stopwatch watch;
    LitScene lit = lit_scene(options.scene);
    if (!lit.has_clusters())
        throw std::runtime_error(
            fmt::format("{}: expected a scene file (`relumine precompute`) or --lights, got a mesh",
                        options.scene.path));
    const Scene& scene = lit.scene();
    options.output.check_fits(scene);
    const double seconds_load_scene = watch.lap();
    session.poll();

    // Of the sum, where there is a list, too.
    std::vector<glm::vec3> radiance;
    std::optional<Lighting> from_list;
    std::vector<glm::vec3> list_for_bounces;
    std::size_t num_lights = 0;
    if (!options.lights.empty()) {
        const lights::LightList list = lights::load_lights(options.lights);
        num_lights = list.lights.size();
        lit.light(list.lights);
        from_list = lit.lighting();
        radiance.assign(from_list->radiance.begin(), from_list->radiance.end());
        const std::span<const glm::vec3> direct = lit.relighter().diffuse_radiance();
        list_for_bounces.assign(direct.begin(), direct.end());
    }
    const double seconds_list = watch.lap();
    Environment environment = load_environment(options.environment, session);
    const double seconds_load = environment.seconds_load;
    const double seconds_resample = environment.seconds_resample;
    const std::string assumptions = environment.assumptions;
    const RelightTimes times = lit.light(std::move(environment));
    const std::uint32_t resolution = lit.environment().resolution;
    session.poll();
    const std::optional<BounceReport> bounces = options.bounces.bounce(
        lit, options.output.for_scene(scene), options.scene.path, list_for_bounces);
    watch.lap();
    Lighting lighting = chosen_lighting(options, lit);
    if (from_list && !options.only_bounces)
        add(lighting, std::move(*from_list), radiance);
    Painter painter(lit, options.output.for_scene(lit.scene()));
    painter.save(options.output.path, lighting);
    const double seconds_output = watch.lap();

    session.say(fmt::format(
        "{}: {} receivers under {} (R = {}){} in {:.2f} s: scene {:.0f}, environment {:.0f}, "
        "resample "
        "{:.0f}, bin {:.1f}, trace {:.1f} ({} lights), relight {:.1f}{}, output {:.0f} ms{}",
        options.output.path, scene.receivers.num_own(), options.environment.path, resolution,
        num_lights == 0 ? ""
                        : fmt::format(" and {} lights of {} ({:.1f} ms)", num_lights,
                                      options.lights, 1e3 * seconds_list),
        watch.total(), 1e3 * seconds_load_scene, 1e3 * seconds_load, 1e3 * seconds_resample,
        1e3 * times.seconds_bin, 1e3 * times.seconds_trace, times.num_sharp_lights,
        1e3 * times.seconds_relight, text_of(bounces), 1e3 * seconds_output,
        options.output.exposure_text(painter)));
    session.report({{"receivers", scene.receivers.num_own()},
                    {"clusters", scene.transfer.num_clusters()},
                    {"face_resolution", resolution},
                    {"environment", assumptions},
                    {"seconds_load_scene", seconds_load_scene},
                    {"seconds_load", seconds_load},
                    {"seconds_resample", seconds_resample},
                    {"seconds_bin", times.seconds_bin},
                    {"seconds_trace", times.seconds_trace},
                    {"seconds_relight", times.seconds_relight},
                    {"bounces", bounces ? bounces->num_bounces : 0},
                    {"seconds_bounces", bounces ? bounces->seconds : 0.0},
                    {"sharp_lights", times.num_sharp_lights},
                    {"exposure", painter.exposure_ev(options.output.path)},
                    {"lights", num_lights},
                    {"seconds_list", seconds_list},
                    {"seconds_output", seconds_output},
                    {"seconds", watch.total()}});
}

void light_with_list(const RelightArguments& options, Session& session) {
    Stopwatch watch;
    const lights::LightList list = lights::load_lights(options.lights);
    LitScene lit = lit_scene(options.scene);
    options.output.check_fits(lit.scene());
    const double seconds_load_scene = watch.lap();
    session.poll();
    lit.light(list.lights);
    options.bounces.bounce(lit, options.output.for_scene(lit.scene()), options.scene.path);
    const double seconds_light = watch.lap();
    session.poll();
    Painter painter(lit, options.output.for_scene(lit.scene()));
    painter.save(options.output.path, chosen_lighting(options, lit));
    const double seconds_output = watch.lap();

    session.say(fmt::format(
        "{}: {} receivers under {} lights of {} in {:.2f} s: scene {:.0f}, light {:.1f}, output "
        "{:.0f} ms, {}{}",
        options.output.path, lit.radiance().size(), list.lights.size(), options.lights,
        watch.total(), 1e3 * seconds_load_scene, 1e3 * seconds_light, 1e3 * seconds_output,
        options.scene.clusters_only ? "through the clusters" : "each with its shadow rays",
        options.output.exposure_text(painter)));
    session.report({{"receivers", lit.radiance().size()},
                    {"lights", list.lights.size()},
                    {"traced", !options.scene.clusters_only},
                    {"seconds_load_scene", seconds_load_scene},
                    {"seconds_light", seconds_light},
                    {"exposure", painter.exposure_ev(options.output.path)},
                    {"seconds_output", seconds_output},
                    {"seconds", watch.total()}});
}

/// Parts are numbers alone: what shapes a picture does not suit them.
void require_numbers(const RelightArguments& options, const Command& command) {
    constexpr std::array<std::string_view, 16> Fitting = {
        "SCENE",    "ENV",      "--output",  "--part",  "--clusters-only",
        "--layout", "--from",   "--fix-env", "--flip",  "--face-resolution",
        "--tilt",   "--rotate", "--json",    "--quiet", "--verbose",
        "--threads"};
    for (const std::string& name : command.given_options())
        if (std::find(Fitting.begin(), Fitting.end(), name) == Fitting.end())
            throw UsageError(name, "expected no such option with --part");
    if (options.environment.path.empty())
        throw UsageError("ENV", "expected an environment with --part");
}

/// Lights the receivers with all processes of the team; the first one writes the output.
void light_with_team(const RelightArguments& options, Session& session) {
    Stopwatch watch;
    SharedLight light = shared_light(options.scene, *session.team);
    const Scene& scene = light.lit().scene();
    options.output.check_fits(scene);
    const bool has_environment = !options.environment.path.empty();

    Lighting from_list;
    std::vector<glm::vec3> radiance, list_for_bounces;
    std::size_t num_lights = 0;
    if (!options.lights.empty()) {
        const lights::LightList list = lights::load_lights(options.lights);
        num_lights = list.lights.size();
        light.set_lights(list.lights);
        if (has_environment) {
            from_list = light.lighting();
            radiance.assign(from_list.radiance.begin(), from_list.radiance.end());
            list_for_bounces = light.diffuse_radiance();
        }
    }
    std::optional<Environment> environment;
    RelightTimes times;
    if (has_environment) {
        environment = load_environment(options.environment, session);
        times = light.light(std::move(environment->map));
    }
    const std::optional<BounceReport> bounces = options.bounces.bounce(
        light, options.output.for_scene(scene), options.scene.path, list_for_bounces);
    Lighting lighting = light.lighting();
    if (!light.is_first())
        return;
    if (options.only_bounces)
        keep_bounces(lighting, light.bounced(), options.scene.path);
    else if (!radiance.empty())
        add(lighting, std::move(from_list), radiance);
    if (environment && environment->file.image != nullptr)
        lighting.sharp = relight::backdrop_of(environment->file);
    Painter painter(light.lit(), options.output.for_scene(scene));
    painter.save(options.output.path, lighting);
    const double seconds = watch.total();
    session.say(fmt::format("{}: {} receivers under {} in {:.2f} s by {} processes{}{}",
                            options.output.path, scene.receivers.num_own(),
                            has_environment ? options.environment.path : options.lights, seconds,
                            session.team->part().count, text_of(bounces),
                            options.output.exposure_text(painter)));
    session.report({{"receivers", scene.receivers.num_own()},
                    {"processes", session.team->part().count},
                    {"lights", num_lights},
                    {"bounces", bounces ? bounces->num_bounces : 0},
                    {"sharp_lights", times.num_sharp_lights},
                    {"exposure", painter.exposure_ev(options.output.path)},
                    {"peak_bytes", peak_bytes()},
                    {"seconds", seconds}});
}

/// Lights a part of the receivers.
void light_one_part(const RelightArguments& options, const Command& command, Session& session) {
    require_numbers(options, command);
    check_output(options.output.path, {options.scene.path, options.environment.path});
    Stopwatch watch;
    Environment environment = load_environment(options.environment, session);
    std::size_t num_receivers = 0;
    const RelightTimes times = light_part({.scene = options.scene.path,
                                           .part = options.part,
                                           .output = options.output.path,
                                           .clusters_only = options.scene.clusters_only},
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
    const bool has_environment = !options.environment.path.empty();
    if (!has_environment && options.lights.empty())
        throw UsageError("relight", "expected ENV, --lights or both");
    std::vector<std::string> inputs = {options.scene.path};
    for (const std::string& path : {options.environment.path, options.lights})
        if (!path.empty())
            inputs.push_back(path);
    if (session.team == nullptr || session.team->part().index == 0)
        options.output.check(inputs);
    if (session.team != nullptr)
        return light_with_team(options, session);
    if (has_environment)
        light_with_environment(options, session);
    else
        light_with_list(options, session);
}

} // namespace

void add_relight(Command& program, Session& session) {
    Command command = program.add_command(
        "relight",
        "light a scene with an environment or a light list: a picture, a mesh or numbers");
    auto options = std::make_shared<RelightArguments>();
    options->scene.add_to(command);
    options->environment.add_to(command).required(false);
    command
        .add_option(
            "--lights", options->lights,
            "a light list (.json, from `relumine lights` or `env convert --split-sun`), a shadow "
            "ray for each light; with ENV, both light together")
        .file();
    options->output.add_to(command);
    command
        .add_option(
            "--part", [options](const std::string& text) { options->part = parse_part(text); },
            "light part I of N of the receivers, from 1/N to N/N; -o names the part, and "
            "`relumine join` makes the numbers (.npy) of all parts")
        .type_name("I/N");
    options->bounces.add_to(command);
    command.add_flag("--only-bounces", options->only_bounces,
                     "what surfaces add to the direct light, alone");
    session.add_common_options(command);
    command.on_run([options, command, &session] { run(*options, command, session); });
}

} // namespace relumine::app
