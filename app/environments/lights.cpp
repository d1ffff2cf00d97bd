#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/environment_options.h"
#include "app/options/output_options.h"
#include "app/options/receiver_options.h"
#include "files/counted.h"
#include "files/joined.h"
#include "relumine/ask/environment_doctor.h"
#include "relumine/ask/reference.h"
#include "relumine/light/light_lists.h"
#include "relumine/light/light_parts.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/pictures.h"

namespace relumine::app {

namespace {

/// The name of relight::transfer_lights() beside those of lights::AllMethods.
constexpr const char* TransferMethod = "transfer";
/// Where the random numbers of importance sampling begin
constexpr std::uint64_t Seed = 1;

struct LightsArguments {
    EnvironmentOptions environment;
    std::string path;
    std::string picture;
    std::string method = std::string(lights::name(lights::Method::VarianceCut));
    std::size_t number = 64;
    /// A .prt file. The error of the lights on it is printed, and the transfer method chooses for
    /// it. Empty: none.
    std::string scene;
    lights::ExportOptions export_options;
};

lights::LightFormat format_of(const LightsArguments& options) {
    if (const auto format = lights::light_format_of(options.path))
        return *format;
    std::vector<std::string> known;
    known.reserve(lights::AllLightFormats.size());
    for (const lights::LightFormat format : lights::AllLightFormats)
        known.emplace_back(lights::extension(format));
    throw UsageError("--output", fmt::format("expected a name that ends in {}, got '{}'",
                                             files::joined_by_or(known), options.path));
}

/// Refuses what cannot be written before any work is done.
void check_outputs(const LightsArguments& options) {
    if (options.path.empty() && options.picture.empty())
        throw UsageError("expected -o or --picture, got neither");
    if (!options.path.empty()) {
        static_cast<void>(format_of(options));
        check_output(options.path, {options.environment.path});
    }
    if (options.picture.empty())
        return;
    require_extension("--picture", options.picture, {".png", ".exr"});
    const auto place_of = [](const std::string& path) {
        return std::filesystem::weakly_canonical(std::filesystem::absolute(path));
    };
    if (!options.path.empty() && place_of(options.picture) == place_of(options.path))
        throw std::runtime_error(
            fmt::format("{}: expected a picture other than the light list", options.picture));
    check_output(options.picture, {options.environment.path});
}

/// A lat-long as it is in the file; everything else, and what is turned or given another
/// resolution, by way of a cube map.
cubemap::EnvironmentImage load_lat_long(const EnvironmentOptions& options, Session& session) {
    cubemap::EnvironmentImage image = load_image(options, session);
    const bool is_turned = world_from_image(image.layout, options) != glm::dmat3(1.0);
    if (image.layout == cubemap::Layout::LatLong && options.face_resolution == 0 && !is_turned) {
        warn_about(options, image, cubemap::statistics(image).light_from_below, session);
        return image;
    }
    const cubemap::CubeMap map = cube_map_of(image, options);
    warn_about(options, image, cubemap::light_from_below(map), session);
    return lights::lat_long_of(map);
}

/// Lights are chosen and judged on plain white surfaces: what arrives, whatever is reflected of it.
Scene without_materials(Scene scene) {
    scene.receivers.surfaces.clear();
    scene.transfer.glossy.reset();
    scene.bounces.reset();
    prt::set_surfaces(scene.transfer, scene.receivers);
    return scene;
}

/// A scene under the environment, for what depends on both.
struct Lit {
    LitScene scene;

    Lit(const std::string& path, const cubemap::CubeMap& environment)
        : scene(without_materials(load_scene(path)), {.path = path}) {
        scene.light(environment);
    }

    /// Relative L2 difference of what the lights give to all receivers, traced, from what the
    /// environment gives.
    [[nodiscard]] double error(std::span<const lights::DistantLight> list) const {
        const prt::Receivers& receivers = scene.scene().receivers;
        std::vector<std::uint32_t> all(receivers.size());
        std::iota(all.begin(), all.end(), 0u);
        const std::vector<glm::vec3> under_lights =
            relight::radiance_under(list, receivers.normals, scene.relighter().shadow_rays());
        const std::span<const glm::vec3> environment = scene.radiance();
        return relight::compare(all,
                                std::vector<glm::dvec3>(environment.begin(), environment.end()),
                                under_lights)
            .relative_l2;
    }
};

lights::Placement place(const LightsArguments& options, const cubemap::EnvironmentImage& map,
                        const Lit* lit, Session& session) {
    try {
        if (options.method != TransferMethod)
            return lights::place(*lights::method_named(options.method), map, options.number, Seed);
        lights::Placement result{.lights = relight::transfer_lights(
                                     lit->scene.relighter(), options.number,
                                     session.work(files::counted(options.number, "light"))),
                                 .regions = {}};
        session.end_progress();
        return result;
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", options.environment.path, error.what()));
    }
}

/// The scene of --scene under the environment; none without the option.
std::unique_ptr<Lit> light_scene(const LightsArguments& options,
                                 const cubemap::EnvironmentImage& map) {
    if (options.scene.empty())
        return nullptr;
    // load_lat_long() has turned the map.
    return std::make_unique<Lit>(
        options.scene,
        relumine::cube_map_of(map, {.face_resolution = options.environment.face_resolution}));
}

void save(const LightsArguments& options, const cubemap::EnvironmentImage& map,
          const lights::Placement& placement) {
    if (!options.path.empty()) {
        lights::LightList list{
            .lights = placement.lights,
            .environment = std::filesystem::path(options.environment.path).filename().string(),
            .method = options.method};
        if (options.method == lights::name(lights::Method::Importance))
            list.seed = Seed;
        lights::export_lights(options.path, list, format_of(options), options.export_options);
    }
    if (!options.picture.empty())
        relight::save_picture(options.picture, relight::region_picture(map, placement));
}

/// Says what the lights are and how they share the light; `list` has one at least.
Report describe(const LightsArguments& options, const cubemap::EnvironmentImage& map,
                const std::vector<lights::DistantLight>& list, double seconds_place,
                const Session& session) {
    const glm::dvec3 power = lights::total_irradiance(list);
    std::vector<double> shares;
    shares.reserve(list.size());
    for (const lights::DistantLight& light : list)
        shares.push_back(lights::luminance(light.irradiance));
    const auto [dimmest, brightest] = std::minmax_element(shares.begin(), shares.end());
    const double all = lights::luminance(power);
    const double scale = all > 0.0 ? 1.0 / all : 0.0;
    session.say(fmt::format("{} by {} from {} x {} pixels in {:.1f} ms",
                            files::counted(list.size(), "light"), options.method, map.width,
                            map.height, 1e3 * seconds_place));
    session.say(fmt::format(
        "power ({:.6g}, {:.6g}, {:.6g}), a light's share of the luminance {:.3g} to {:.3g} %",
        power.r, power.g, power.b, 100.0 * scale * *dimmest, 100.0 * scale * *brightest));
    return {{"method", options.method},
            {"lights", list.size()},
            {"width", map.width},
            {"height", map.height},
            {"power", power},
            {"smallest_share", scale * *dimmest},
            {"largest_share", scale * *brightest},
            {"seconds_place", seconds_place}};
}

void warn_of_lost_softness(const LightsArguments& options, Session& session) {
    if (options.export_options.soft && !options.path.empty() &&
        !lights::holds_soft_lights(format_of(options)))
        session.warn(fmt::format("{}: --soft has no effect: distant lights of {} have no size",
                                 options.path, lights::name(format_of(options))));
}

bool is_light_list(const std::string& path) {
    return std::filesystem::path(path).extension() == ".json";
}

/// Writes a light list in another format.
void convert_list(const LightsArguments& options, Session& session) {
    if (options.path.empty() || !options.picture.empty() || !options.scene.empty())
        throw UsageError("lights", "expected -o, and neither --picture nor --scene, with a light "
                                   "list as input");
    check_outputs(options);
    const lights::LightList list = lights::load_lights(options.environment.path);
    warn_of_lost_softness(options, session);
    lights::export_lights(options.path, list, format_of(options), options.export_options);
    const glm::dvec3 power = lights::total_irradiance(list.lights);
    session.say(fmt::format("{}: {} of {}", options.path,
                            files::counted(list.lights.size(), "light"), options.environment.path));
    session.report({{"lights", list.lights.size()}, {"power", power}});
}

void run(const LightsArguments& options, Session& session) {
    if (is_light_list(options.environment.path)) {
        convert_list(options, session);
        return;
    }
    check_outputs(options);
    warn_of_lost_softness(options, session);
    if (options.method == TransferMethod && options.scene.empty())
        throw UsageError("--method", "expected --scene SCENE.prt with transfer");
    Stopwatch watch;
    const cubemap::EnvironmentImage map = load_lat_long(options.environment, session);
    const double seconds_load = watch.lap();
    session.poll();
    const std::unique_ptr<Lit> lit = light_scene(options, map);
    watch.lap();
    const lights::Placement placement = place(options, map, lit.get(), session);
    const double seconds_place = watch.lap();
    if (placement.lights.empty())
        throw std::runtime_error(fmt::format("{}: expected light that reaches {}, got none",
                                             options.environment.path, options.scene));
    session.poll();

    save(options, map, placement);
    Report result = describe(options, map, placement.lights, seconds_place, session);
    result.set("seconds_load", seconds_load);
    if (lit) {
        const double error = lit->error(placement.lights);
        session.say(fmt::format("{}: {:.2g} % relative L2 on this asset",
                                files::counted(placement.lights.size(), "light"), 100.0 * error));
        result.set("relative_l2", error);
    }
    session.report(result);
}

/// -o, --picture and -n.
void add_output_options(Command& command, LightsArguments& options) {
    command.add(
        row("-o,--output", options.path,
            "light list: .json .csv .pbrt (pbrt-v4) .xml (Mitsuba 3) .usda .py (Blender) .gltf",
            {.file = true}));
    command.add(row("--picture", options.picture,
                    "the environment with regions and lights drawn: .png or .exr", {.file = true}));
    command.add(row("-n,--number", options.number, "how many lights", {.min = 1, .max = 1e9}));
}

/// --scene and --method.
void add_method_options(Command& command, LightsArguments& options) {
    command.add(
        row("--scene", options.scene,
            "scene file: says how well the lights light it; --method transfer chooses for it",
            {.file = true}));
    std::vector<std::string> methods;
    methods.reserve(lights::AllMethods.size());
    for (const lights::Method method : lights::AllMethods)
        methods.emplace_back(lights::name(method));
    methods.emplace_back(TransferMethod);
    command.add(
        row("--method", options.method,
            "median-cut: regions of equal energy (Debevec); variance: regions whose energy lies "
            "close together (Viriyothai and Debevec); importance: random directions, stratified; "
            "transfer: those that light --scene most like the environment",
            {.choices = methods}));
}

} // namespace

void add_lights(Command& program, Session& session) {
    Command command =
        program.add_command("lights", "a few distant lights that stand for an environment");
    auto options = std::make_shared<LightsArguments>();
    options->environment.add_to(command).description(
        "environment: " + cubemap::environment_extensions() +
        "; {face} in the name for six files px nx py ny pz nz; or a light list (.json), which -o "
        "writes in another format");
    add_output_options(command, *options);
    add_method_options(command, *options);
    command.add(
        row("--soft", options->export_options.soft,
            "lights as wide as the part of the sphere they stand for (USD, Blender; JSON and "
            "CSV have the solid angle)"));
    command.add(row("--lumens-per-watt", options->export_options.lumens_per_watt,
                    "glTF: intensity in lux is irradiance times this; 1 keeps the environment's "
                    "unit, 683 is photometric",
                    {.min = 1e-6, .max = 1e6}));
    session.add_common_options(command);
    command.on_run([options, &session] { run(*options, session); });
}

} // namespace relumine::app
