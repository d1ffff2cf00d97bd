#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/environment_options.h"
#include "app/output_options.h"
#include "lights/light_export.h"
#include "lights/place_lights.h"
#include "lights/region_picture.h"
#include "relight/picture.h"

namespace relumine::app {

namespace {

struct Options {
    EnvironmentOptions environment;
    std::string path;
    std::string picture;
    std::string format; ///< empty: by the output's extension
    std::string method = std::string(lights::name(lights::Method::VarianceCut));
    std::size_t num_lights = 64;
    std::uint64_t seed = 1;
    lights::ExportOptions export_options;
};

lights::LightFormat format_of(const Options& options) {
    if (!options.format.empty())
        return *lights::light_format_named(options.format);
    if (const auto format = lights::light_format_of(options.path))
        return *format;
    std::string known;
    for (const lights::LightFormat format : lights::AllLightFormats)
        known += fmt::format("{}, ", lights::extension(format));
    throw std::runtime_error(fmt::format("{}: expected {}or --format, got '{}'", options.path, known,
                                         std::filesystem::path(options.path).extension().string()));
}

/// Refuses what cannot be written before any work is done.
void check_outputs(const Options& options) {
    if (options.path.empty() && options.picture.empty())
        throw CLI::RequiredError("-o or --picture");
    if (!options.path.empty()) {
        static_cast<void>(format_of(options));
        check_output(options.path, {options.environment.path});
    }
    if (options.picture.empty())
        return;
    const std::string extension = std::filesystem::path(options.picture).extension().string();
    if (extension != ".png" && extension != ".exr")
        throw std::runtime_error(
            fmt::format("{}: expected .png or .exr, got '{}'", options.picture, extension));
    const auto place_of = [](const std::string& path) {
        return std::filesystem::weakly_canonical(std::filesystem::absolute(path));
    };
    if (!options.path.empty() && place_of(options.picture) == place_of(options.path))
        throw std::runtime_error(
            fmt::format("{}: expected a picture other than the light list", options.picture));
    check_output(options.picture, {options.environment.path});
}

/// A lat-long as it is in the file; everything else, and what is turned or given another resolution, by way of a cube map.
cubemap::EnvironmentImage load_lat_long(const EnvironmentOptions& options, const Session& session) {
    cubemap::EnvironmentImage image = load_image(options, session);
    if (image.layout == cubemap::Layout::LatLong && options.face_resolution == 0 &&
        options.rotate_degrees == 0.0)
        return image;
    return lights::lat_long_of(cube_map_of(image, options));
}

lights::Placement place(const Options& options, lights::Method method, const cubemap::EnvironmentImage& map) {
    try {
        return lights::place(method, map, options.num_lights, options.seed);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", options.environment.path, error.what()));
    }
}

void run(const Options& options, const Session& session) {
    check_outputs(options);
    const lights::Method method = *lights::method_named(options.method);
    Stopwatch watch;
    const cubemap::EnvironmentImage map = load_lat_long(options.environment, session);
    const double seconds_load = watch.lap();
    session.poll();
    const lights::Placement placement = place(options, method, map);
    const double seconds_place = watch.lap();
    session.poll();

    if (!options.path.empty()) {
        lights::LightList list{.lights = placement.lights,
                               .environment =
                                   std::filesystem::path(options.environment.path).filename().string(),
                               .method = options.method};
        if (method == lights::Method::Importance)
            list.seed = options.seed;
        lights::export_lights(options.path, list, format_of(options), options.export_options);
    }
    if (!options.picture.empty()) {
        lights::LatLongPicture picture = lights::region_picture(map, placement);
        relight::save_picture(
            options.picture,
            {.width = picture.width, .height = picture.height, .pixels = std::move(picture.pixels)});
    }

    const glm::dvec3 power = lights::total_irradiance(placement.lights);
    std::vector<double> shares;
    for (const lights::DistantLight& light : placement.lights)
        shares.push_back(lights::luminance(light.irradiance));
    const auto [dimmest, brightest] = std::minmax_element(shares.begin(), shares.end());
    const double all = lights::luminance(power);
    const double scale = all > 0.0 ? 1.0 / all : 0.0;
    session.say(fmt::format("{} lights by {} from {} x {} pixels in {:.1f} ms", placement.lights.size(),
                            options.method, map.width, map.height, 1e3 * seconds_place));
    session.say(
        fmt::format("power ({:.6g}, {:.6g}, {:.6g}), a light's share of the luminance {:.3g} to {:.3g} %",
                    power.r, power.g, power.b, 100.0 * scale * *dimmest, 100.0 * scale * *brightest));
    session.report({{"method", options.method},
                    {"lights", placement.lights.size()},
                    {"width", map.width},
                    {"height", map.height},
                    {"power", {power.r, power.g, power.b}},
                    {"smallest_share", scale * *dimmest},
                    {"largest_share", scale * *brightest},
                    {"seconds_load", seconds_load},
                    {"seconds_place", seconds_place}});
}

} // namespace

void add_lights(CLI::App& program, Session& session) {
    CLI::App& command =
        *program.add_subcommand("lights", "a few distant lights that stand for an environment");
    auto options = std::make_shared<Options>();
    options->environment.add_to(command);
    command.add_option("-o,--output", options->path,
                       "light list: .json .csv .pbrt (pbrt-v4) .xml (Mitsuba 3) .usda .py (Blender) .gltf");
    command.add_option("--picture", options->picture,
                       "the environment with regions and lights drawn: .png or .exr");
    command.add_option("-n,--number", options->num_lights, "how many lights")
        ->check(number_between(1, 1e9))
        ->capture_default_str();
    std::vector<std::string> methods;
    methods.reserve(lights::AllMethods.size());
    for (const lights::Method method : lights::AllMethods)
        methods.emplace_back(lights::name(method));
    command
        .add_option("--method", options->method,
                    "median-cut: regions of equal energy (Debevec); variance: regions whose energy lies "
                    "close together (Viriyothai and Debevec); importance: random directions, stratified")
        ->check(CLI::IsMember(methods))
        ->capture_default_str();
    command.add_option("--seed", options->seed, "of importance sampling")
        ->check(number_between(0, 0x1p53))
        ->capture_default_str();
    std::vector<std::string> formats;
    formats.reserve(lights::AllLightFormats.size());
    for (const lights::LightFormat format : lights::AllLightFormats)
        formats.emplace_back(lights::name(format));
    command.add_option("--format", options->format, "format of the light list, whatever its extension")
        ->check(CLI::IsMember(formats));
    command.add_flag("--soft", options->export_options.soft,
                     "lights as wide as the part of the sphere they stand for (USD, Blender)");
    command
        .add_option("--lumens-per-watt", options->export_options.lumens_per_watt,
                    "glTF: intensity in lux is irradiance times this; 1 keeps the environment's unit, 683 is "
                    "photometric")
        ->check(number_between(1e-6, 1e6))
        ->capture_default_str();
    session.add_common_options(command);
    command.callback([options, &session] { run(*options, session); });
}

} // namespace relumine::app
