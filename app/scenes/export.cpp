// `relumine export runtime`: a scene for programs that only relight.
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/output_options.h"
#include "files/counted.h"
#include "relumine/in/scene.h"
#include "relumine/in/shared_work.h"
#include "relumine/light/bounces.h"
#include "relumine/out/output.h"

namespace relumine::app {

namespace {

struct ExportArguments {
    std::string scene;
    std::string output;
};

void export_for_runtime(const ExportArguments& options, Session& session) {
    require_extension("--output", options.output, {".relight"});
    check_output(options.output, {options.scene});
    prt::RelightingScene lean{.scene = load_scene(options.scene)};
    session.poll();
    if (lean.scene.bounces)
        lean.albedo = bounces_of(lean.scene, bounce_albedo(lean.scene)).albedo;
    const bool has_highlights = lean.scene.transfer.glossy.has_value();
    const bool has_lamps = !lean.scene.lamps.empty();
    const std::size_t num_receivers = lean.scene.receivers.num_own();
    const std::uintmax_t before = std::filesystem::file_size(options.scene);
    const std::uint64_t size = prt::save_relighting_scene(options.output, std::move(lean));
    if (has_highlights)
        session.warn(
            fmt::format("{}: highlights are left out: they are for one eye", options.scene));
    if (has_lamps)
        session.warn(fmt::format("{}: the scene's own lamps are left out", options.scene));
    session.say(fmt::format("{}: {}, {:.1f} MB ({:.1f} MB before)", options.output,
                            files::counted(num_receivers, "receiver"),
                            1e-6 * static_cast<double>(size), 1e-6 * static_cast<double>(before)));
    session.report({{"receivers", num_receivers}, {"bytes", size}, {"bytes_before", before}});
}

} // namespace

void add_export(Command& program, Session& session) {
    Command group =
        program.add_command("export", "scenes for other programs: `export runtime`, `export web`");
    Command command = group.add_command(
        "runtime", "what the library relumine_runtime takes of a scene: SCENE.prt -> OUT.relight");
    auto options = std::make_shared<ExportArguments>();
    command.add(row("SCENE", options->scene, "scene of `relumine precompute`",
                    {.file = true, .required = true}));
    command.add(row("-o,--output", options->output, "the file to write, .relight",
                    {.file = true, .required = true}));
    session.add_common_options(command);
    command.on_run([options, &session] { export_for_runtime(*options, session); });
}

} // namespace relumine::app
