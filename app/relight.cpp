#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/environment_options.h"
#include "app/lit_scene.h"
#include "app/output_options.h"
#include "relight/relighter.h"

namespace relumine::app {

namespace {

struct Options {
    SceneOptions scene;
    EnvironmentOptions environment;
    OutputOptions output;
};

void run(const Options& options, Session& session) {
    options.output.check({options.scene.path, options.environment.path});
    Stopwatch watch;
    const LitScene lit(options.scene);
    const prt::Scene& scene = lit.scene();
    const double seconds_load_scene = watch.lap();
    session.poll();

    LoadedEnvironment environment = load_environment(options.environment, session);
    const std::uint32_t resolution = environment.map.resolution;
    relight::Relighter relighter(scene.transfer, lit.shadow_rays());
    const relight::RelightTimes times = relighter.set_environment(std::move(environment.map));
    session.poll();

    watch.lap();
    options.output.save(lit, relighter.radiance(), relighter.environment());
    const double seconds_output = watch.lap();

    session.say(fmt::format("{}: {} receivers under {} (R = {}): load {:.0f}, resample {:.0f}, bin {:.1f}, "
                            "trace {:.1f} ({} lights), relight {:.1f} ms",
                            options.output.path, scene.transfer.num_receivers(), options.environment.path,
                            resolution, 1e3 * environment.seconds_load, 1e3 * environment.seconds_resample,
                            1e3 * times.seconds_bin, 1e3 * times.seconds_trace, times.num_sharp_lights,
                            1e3 * times.seconds_relight));
    session.report({{"receivers", scene.transfer.num_receivers()},
                    {"clusters", scene.transfer.num_clusters()},
                    {"face_resolution", resolution},
                    {"environment", environment.assumptions},
                    {"seconds_load_scene", seconds_load_scene},
                    {"seconds_load", environment.seconds_load},
                    {"seconds_resample", environment.seconds_resample},
                    {"seconds_bin", times.seconds_bin},
                    {"seconds_trace", times.seconds_trace},
                    {"seconds_relight", times.seconds_relight},
                    {"sharp_lights", times.num_sharp_lights},
                    {"seconds_output", seconds_output}});
}

} // namespace

void add_relight(CLI::App& program, Session& session) {
    CLI::App& command =
        *program.add_subcommand("relight", "light a scene with an environment: a picture, a mesh or numbers");
    auto options = std::make_shared<Options>();
    options->scene.add_to(command);
    options->environment.add_to(command);
    options->output.add_to(command);
    session.add_common_options(command);
    command.callback([options, &session] { run(*options, session); });
}

} // namespace relumine::app
