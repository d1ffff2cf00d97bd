#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/bounce_option.h"
#include "app/options/output_options.h"
#include "app/scenes/lit_scene.h"
#include "files/counted.h"
#include "files/extension.h"
#include "files/json_reader.h"
#include "files/output_file.h"
#include "relumine/ask/fit.h"
#include "relumine/in/environment_files.h"
#include "relumine/in/mesh_files.h"
#include "relumine/light/layers.h"
#include "relumine/light/light_lists.h"
#include "relumine/out/pictures.h"

namespace relumine::app {

namespace {

struct FitArguments {
    SceneOptions scene;
    std::string target;
    std::string output;
    /// 0: an environment
    std::size_t num_lights = 0;
    /// A light list or light layers; empty: none are given
    std::string given;
    EnvironmentFit environment;
    /// What the target shows: albedo, exposure and camera
    relumine::OutputOptions shown;
    BounceOption bounces;
};

/// The options of a picture that also say how a target was made.
OptionTable shown_options(relumine::OutputOptions& shown) {
    OptionTable table;
    constexpr std::array<const char*, 7> Names = {
        "--albedo", "--exposure", "--camera", "--eye", "--target", "--fov", "--floor-albedo"};
    for (OptionRow& row : options_of(shown))
        if (std::find(Names.begin(), Names.end(), row.name) != Names.end())
            table.push_back(std::move(row));
    return table;
}

bool is_picture(const std::string& path) {
    const std::string extension = extension_of(path);
    return extension == ".exr" || extension == ".hdr";
}

float brightness_of(const FitArguments& options) {
    return static_cast<float>(std::exp2(-options.shown.exposure_ev.value_or(0.0)));
}

/// The picture before its exposure. Refuses one whose camera is not known.
Picture read_picture(const FitArguments& options, const Command& command, const Scene& scene) {
    bool has_camera = !prt::on_vertices(scene.layout) || own_camera(scene).has_value();
    for (const std::string& name : command.given_options())
        has_camera = has_camera || name == "--camera" || name == "--eye" || name == "--fov";
    if (!has_camera)
        throw UsageError("TARGET", "expected the camera of the picture, --camera or --eye and "
                                   "--target, got none");
    Picture picture = cubemap::load_picture(options.target);
    for (glm::vec3& pixel : picture.pixels)
        pixel *= brightness_of(options);
    return picture;
}

FitTarget read_target(const FitArguments& options, const Command& command, const LitScene& lit) {
    relumine::OutputOptions shown = options.shown;
    const Scene& scene = lit.scene();
    if (is_picture(options.target))
        return target_of_picture(lit, read_picture(options, command, scene), shown);
    const bool are_numbers = extension_of(options.target) == ".npy";
    std::vector<glm::vec3> values =
        are_numbers ? relight::load_npy(options.target).values : mesh::load(options.target).colors;
    if (!are_numbers && values.empty())
        throw std::invalid_argument("expected vertex colours, got none");
    for (glm::vec3& value : values)
        value *= brightness_of(options);
    // Numbers are radiance, unless something else is said.
    if (are_numbers && std::holds_alternative<AutomaticAlbedo>(shown.albedo)) {
        shown.albedo = glm::vec3(1.0f);
        shown.floor_albedo = shown.floor_albedo.value_or(glm::vec3(1.0f));
    }
    return target_of_values(scene, values, picture_albedo(scene, shown));
}

/// Lights whose gains are asked for, and how they are written with them.
struct GivenLights {
    std::vector<Light> lights;
    lights::LightList list;
    cubemap::LightLayers layers;

    GivenLights(const std::string& path, std::uint32_t face_resolution) {
        const files::JsonReader reader(path);
        const files::Json json = reader.parse(files::read(path));
        if (json.find("layers") == nullptr) {
            list = lights::load_lights(path);
            for (const lights::DistantLight& light : list.lights)
                lights.emplace_back(std::vector{light});
            return;
        }
        layers = cubemap::load_layers(path);
        for (const cubemap::LightLayer& layer : layers.layers) {
            if (std::holds_alternative<cubemap::Gain>(layer.effect))
                throw std::runtime_error(
                    fmt::format("{}: expected layers that shine, got \"{}\", which multiplies",
                                path, layer.name));
            lights.emplace_back(light_of(layer, face_resolution));
        }
    }

    void save(const std::string& path, std::span<const double> gains) {
        for (std::size_t i = 0; i < list.lights.size(); ++i)
            list.lights[i].irradiance *= gains[i];
        for (std::size_t i = 0; i < layers.layers.size(); ++i) {
            layers.layers[i].on = gains[i] > 0.0;
            if (gains[i] > 0.0)
                layers.layers[i].gain_ev += std::log2(gains[i]);
        }
        if (layers.layers.empty())
            lights::save_lights(path, list);
        else
            cubemap::save_layers(path, layers);
    }

private:
    /// The layer alone, over black.
    static cubemap::CubeMap light_of(cubemap::LightLayer layer, std::uint32_t face_resolution) {
        layer.on = true;
        return LayerCompositor({.base = std::make_shared<const LightBase>(
                                    std::make_shared<const cubemap::CubeMap>(face_resolution)),
                                .layers = {std::move(layer)}})
            .whole();
    }
};

void save_list(const FitArguments& options, const std::vector<lights::DistantLight>& list) {
    if (list.empty())
        throw std::invalid_argument("expected a target that lights can reach, got one that is "
                                    "100 % off under every light");
    lights::save_lights(options.output, {.lights = list, .method = "fit"});
}

/// Finds the light and writes it. Returns what was found, for people.
std::string find_light(const FitArguments& options, LitScene& lit, const FitTarget& target,
                       const prt::Work& work) {
    if (options.num_lights != 0) {
        const std::vector<lights::DistantLight> list =
            fit_lights(lit, target, options.num_lights, work);
        save_list(options, list);
        return files::counted(list.size(), "light");
    }
    if (options.given.empty()) {
        cubemap::save_environment(options.output,
                                  fit_environment(lit, target, options.environment, work));
        return fmt::format("an environment (R = {})", options.environment.face_resolution);
    }
    // Fine enough for the layers' edges.
    constexpr std::uint32_t LayerResolution = 256;
    GivenLights given(options.given, LayerResolution);
    const std::vector<double> gains = fit_gains(lit, target, given.lights, work);
    Light sum;
    std::optional<cubemap::CubeMap> map;
    for (std::size_t i = 0; i < gains.size(); ++i) {
        for (lights::DistantLight light : given.lights[i].lights) {
            light.irradiance *= gains[i];
            sum.lights.push_back(light);
        }
        if (const auto* of_layer = std::get_if<cubemap::CubeMap>(&given.lights[i].environment)) {
            if (!map)
                map.emplace(LayerResolution);
            for (std::size_t texel = 0; texel < map->texels.size(); ++texel)
                map->texels[texel] += static_cast<float>(gains[i]) * of_layer->texels[texel];
        }
    }
    if (map)
        sum.environment = std::move(*map);
    const bool bounces = lit.bounces().is_set();
    lit.light(std::move(sum));
    if (bounces)
        lit.bounce();
    given.save(options.output, gains);
    return fmt::format("{} of {}", files::counted(gains.size(), "gain"), options.given);
}

void check(const FitArguments& options) {
    if (options.num_lights != 0 || !options.given.empty())
        require_extension("--output", options.output, {".json"});
    else
        require_environment_name("--output", options.output);
    require_extension("TARGET", options.target,
                      {".npy", ".ply", ".glb", ".gltf", ".obj", ".off", ".exr", ".hdr"});
    std::vector<std::string> inputs = {options.scene.path, options.target};
    if (!options.given.empty())
        inputs.push_back(options.given);
    check_output(options.output, inputs);
}

/// Says what was found and how near it comes.
void tell(const FitArguments& options, const std::string& found, double distance, double seconds,
          Session& session) {
    session.say(fmt::format("{}: {} in {:.1f} s; the light is off by {:.3g} % of {}",
                            options.output, found, seconds, 100.0 * distance, options.target));
    constexpr double Far = 0.25;
    if (distance > Far)
        session.warn(fmt::format("{}: no such light comes nearer than {:.3g} %", options.target,
                                 100.0 * distance));
    session.report({{"relative_l2", distance}, {"seconds", seconds}});
}

/// Finds lights for the points that a picture of vertices shows.
void fit_to_picture(const FitArguments& options, const Command& command, LitScene& lit,
                    Session& session) {
    Stopwatch watch;
    const Picture picture = read_picture(options, command, lit.scene());
    double distance = 0.0;
    const std::vector<lights::DistantLight> list = fit_lights_to_picture(
        lit, picture, options.shown, options.num_lights, distance, session.work("light that fits"));
    session.end_progress();
    save_list(options, list);
    tell(options, files::counted(list.size(), "light"), distance, watch.total(), session);
}

void run(FitArguments& options, const Command& command, Session& session) {
    check(options);
    // An environment changes from step to step, and with it what would be traced.
    options.scene.clusters_only =
        options.scene.clusters_only || (options.num_lights == 0 && options.given.empty());
    LitScene lit = lit_scene(options.scene, session);
    lit.dim({{.gain = glm::vec3(0.0f)}}); // what is looked for comes from outside
    Stopwatch watch;
    try {
        if (options.num_lights != 0 && is_picture(options.target) &&
            prt::on_vertices(lit.scene().layout))
            return fit_to_picture(options, command, lit, session);
        const FitTarget target = read_target(options, command, lit);
        if (options.num_lights == 0 &&
            options.bounces.applies_to(lit.scene(), options.scene.path)) {
            lit.light(cubemap::CubeMap(1));
            static_cast<void>(options.bounces.bounce(lit, options.shown, options.scene.path));
        }
        const std::string found = find_light(options, lit, target, session.work("light that fits"));
        session.end_progress();
        tell(options, found, distance_to(target, lit), watch.total(), session);
    } catch (const OptionError&) { // names the option already
        throw;
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", options.target, error.what()));
    }
}

} // namespace

void add_fit(Command& program, Session& session) {
    Command command = program.add_command(
        "fit", "find the light under which a scene looks as painted colours or a picture show it");
    auto options = std::make_shared<FitArguments>();
    options->scene.add_to(command);
    command
        .add(row("TARGET", options->target,
                 "how the scene looks: numbers of its receivers (.npy), a mesh with vertex "
                 "colours (.ply, .glb, .obj), a picture (.exr, .hdr) with its --camera",
                 {.file = true}))
        .required(true);
    command.add(row("--output,-o", options->output,
                    "an environment (.exr, .hdr); with --lights a light list, or the given lights "
                    "with their gains (.json)",
                    {.file = true, .required = true}));
    command.add(row(
        "--lights",
        [options](const std::string& text) {
            constexpr std::uint32_t MostLights = 128;
            const bool is_file = !parse_number(text);
            const auto count = is_file ? 0 : parse_count(text).value_or(0);
            if (!is_file && (count < 1 || count > MostLights))
                refuse_text(fmt::format("1 to {} lights, or a file of lights", MostLights), text);
            options->num_lights = count;
            options->given = is_file ? text : "";
        },
        "in place of an environment find N distant lights, or how bright each light of a FILE has "
        "to be: of a light list, or of light layers over black",
        {.file = true, .type = "N|FILE"}));
    command.add(row("--face-resolution", options->environment.face_resolution,
                    "R of the environment, 6 x R x R texels", {.min = 1, .max = 256}));
    command.add_all(shown_options(options->shown));
    options->bounces.add_to(command);
    session.add_common_options(command);
    command.on_run([options, command, &session] { run(*options, command, session); });
}

} // namespace relumine::app
