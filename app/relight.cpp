#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/environment_options.h"
#include "app/output_options.h"
#include "prt/scene_file.h"
#include "relight/relighter.h"

namespace relumine::app {

namespace {

struct Options {
    std::string scene;
    EnvironmentOptions environment;
    OutputOptions output;
};

void run(const Options& options, Session& session) {
    options.output.check();
    Stopwatch watch;
    const prt::Scene scene = prt::load_scene(options.scene);
    const double seconds_load_scene = watch.lap();
    session.poll();

    LoadedEnvironment environment = load_environment(options.environment, session);
    const std::uint32_t resolution = environment.map.resolution;
    relight::Relighter relighter(scene.transfer);
    const relight::RelightTimes times = relighter.set_environment(std::move(environment.map));
    session.poll();

    watch.lap();
    options.output.save(scene, relighter.radiance(), relighter.environment());
    const double seconds_output = watch.lap();

    session.say(fmt::format(
        "{}: {} receivers under {} (R = {}): load {:.0f}, resample {:.0f}, bin {:.1f}, relight {:.1f} ms",
        options.output.path, scene.transfer.num_receivers(), options.environment.path, resolution,
        1e3 * environment.seconds_load, 1e3 * environment.seconds_resample, 1e3 * times.seconds_bin,
        1e3 * times.seconds_relight));
    session.report({{"receivers", scene.transfer.num_receivers()},
                    {"clusters", scene.transfer.num_clusters()},
                    {"face_resolution", resolution},
                    {"environment", environment.assumptions},
                    {"seconds_load_scene", seconds_load_scene},
                    {"seconds_load", environment.seconds_load},
                    {"seconds_resample", environment.seconds_resample},
                    {"seconds_bin", times.seconds_bin},
                    {"seconds_relight", times.seconds_relight},
                    {"seconds_output", seconds_output}});
}

} // namespace

void add_relight(CLI::App& program, Session& session) {
    CLI::App& command =
        *program.add_subcommand("relight", "light a scene with an environment: a picture, a mesh or numbers");
    auto options = std::make_shared<Options>();
    command.add_option("SCENE", options->scene, "scene file from `relumine precompute`")->required();
    options->environment.add_to(command);
    options->output.add_to(command);
    session.add_common_options(command);
    command.callback([options, &session] { run(*options, session); });
}

} // namespace relumine::app
