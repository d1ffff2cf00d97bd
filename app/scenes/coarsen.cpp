// `relumine coarsen`: a scene with fewer clusters.
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/output_options.h"
#include "relumine/in/coarsen.h"

namespace relumine::app {

namespace {

struct CoarsenArguments {
    std::string scene;
    std::string output;
    float tolerance = 0.03f;
};

void coarsen(const CoarsenArguments& options, Session& session) {
    require_extension("--output", options.output, {".prt"});
    check_output(options.output, {options.scene});
    Scene scene = load_scene(options.scene);
    session.poll();
    const std::size_t num_before = scene.transfer.num_clusters();
    const std::uintmax_t bytes_before = std::filesystem::file_size(options.scene);
    const float own = rms_tolerance(scene);
    if (options.tolerance < own)
        throw std::runtime_error(
            fmt::format("{}: made with --tolerance {:.4g}, expected at least as much, got {:.4g}",
                        options.scene, own, options.tolerance));
    scene = coarsened(std::move(scene), options.tolerance, session.work("joining clusters"));
    session.end_progress();
    const std::size_t num_clusters = scene.transfer.num_clusters();
    const std::uint64_t bytes = save_scene(options.output, scene);
    session.say(fmt::format("{}: {} clusters of {}, {:.1f} MB of {:.1f} MB", options.output,
                            num_clusters, num_before, 1e-6 * static_cast<double>(bytes),
                            1e-6 * static_cast<double>(bytes_before)));
    session.report({{"clusters", num_clusters},
                    {"clusters_before", num_before},
                    {"bytes", bytes},
                    {"bytes_before", bytes_before}});
}

} // namespace

void add_coarsen(Command& program, Session& session) {
    Command command =
        program.add_command("coarsen", "fewer light clusters: SCENE.prt -> smaller OUT.prt");
    auto options = std::make_shared<CoarsenArguments>();
    command.add(row("SCENE", options->scene, "scene of `relumine precompute`",
                    {.file = true, .required = true}));
    command.add(row("-o,--output", options->output, "the scene to write, .prt",
                    {.file = true, .required = true}));
    command.add(row("--tolerance", options->tolerance,
                    "as for precompute, 1/sr; no smaller than the scene's",
                    {.min = 1e-6, .max = 1.0}));
    session.add_common_options(command);
    command.on_run([options, &session] { coarsen(*options, session); });
}

} // namespace relumine::app
