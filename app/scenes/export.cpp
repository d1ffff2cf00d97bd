// `relumine export runtime` and `export three`: scenes for programs that only relight.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/output_options.h"
#include "app/scenes/first_scene.h"
#include "files/counted.h"
#include "relumine/in/mesh_files.h"
#include "relumine/in/scene.h"
#include "relumine/in/shared_work.h"
#include "relumine/light/bounces.h"
#include "relumine/out/drawn_mesh.h"
#include "relumine/out/output.h"

namespace relumine::app {

namespace {

struct ExportArguments {
    std::string scene;
    std::string output;
};

/// Writes what the runtime takes of a scene. Returns the bytes.
std::uint64_t save_lean(const std::string& path, const std::string& source, Scene scene,
                        Session& session) {
    prt::RelightingScene lean{.scene = std::move(scene)};
    if (lean.scene.bounces)
        lean.albedo = bounces_of(lean.scene, bounce_albedo(lean.scene)).albedo;
    if (lean.scene.transfer.glossy)
        session.warn(fmt::format("{}: highlights are left out: they are for one eye", source));
    if (!lean.scene.lamps.empty())
        session.warn(fmt::format("{}: the scene's own lamps are left out", source));
    return prt::save_relighting_scene(path, std::move(lean));
}

void export_for_runtime(const ExportArguments& options, Session& session) {
    require_extension("--output", options.output, {".relight"});
    check_output(options.output, {options.scene});
    Scene scene = load_scene(options.scene);
    session.poll();
    const std::size_t num_receivers = scene.receivers.num_own();
    const std::uintmax_t before = std::filesystem::file_size(options.scene);
    const std::uint64_t size = save_lean(options.output, options.scene, std::move(scene), session);
    session.say(fmt::format("{}: {}, {:.1f} MB ({:.1f} MB before)", options.output,
                            files::counted(num_receivers, "receiver"),
                            1e-6 * static_cast<double>(size), 1e-6 * static_cast<double>(before)));
    session.report({{"receivers", num_receivers}, {"bytes", size}, {"bytes_before", before}});
}

/// Writes the mesh of a scene beside it: its vertices are the receivers.
void export_for_three(const ExportArguments& options, Session& session) {
    const bool is_scene = extension_of(options.scene) == ".prt";
    if (!is_scene && !mesh::has_mesh_extension(options.scene))
        throw UsageError("SCENE", fmt::format("expected a scene (.prt) or a mesh ({}), got '{}'",
                                              mesh::mesh_extensions(), options.scene));
    const std::filesystem::path folder(options.output);
    const std::string glb = folder / "scene.glb", lean = folder / "scene.relight";
    if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
        throw UsageError("--output", fmt::format("expected a folder, got '{}'", options.output));
    Scene scene = is_scene ? load_scene(options.scene) : precomputed_scene(options.scene, session);
    session.poll();
    if (!prt::on_vertices(scene.layout))
        throw std::runtime_error(fmt::format("{}: expected vertices as receivers, got {}",
                                             options.scene, prt::description(scene.layout)));
    std::filesystem::create_directories(folder);
    check_output(glb, {options.scene});
    const std::size_t num_receivers = scene.receivers.num_own();
    for (const std::string& what : mesh::save(glb, drawn_mesh(scene)))
        session.warn(fmt::format("{}: left out: {}", glb, what));
    const std::uint64_t size = save_lean(lean, options.scene, std::move(scene), session);
    session.say(fmt::format("{}, {}: {} vertices, {:.1f} and {:.1f} MB", glb, lean, num_receivers,
                            1e-6 * static_cast<double>(std::filesystem::file_size(glb)),
                            1e-6 * static_cast<double>(size)));
    session.report({{"receivers", num_receivers},
                    {"bytes", size},
                    {"bytes_mesh", std::filesystem::file_size(glb)}});
}

} // namespace

void add_export(Command& program, Session& session) {
    Command group = program.add_command(
        "export", "scenes for other programs: `export runtime`, `export three`, `export web`");
    const auto add = [&](const char* name, const char* what, OptionRow (*scene)(std::string&),
                         const char* output, auto run) {
        Command command = group.add_command(name, what);
        auto options = std::make_shared<ExportArguments>();
        command.add(scene(options->scene));
        command.add(row("-o,--output", options->output, output, {.file = true, .required = true}));
        session.add_common_options(command);
        command.on_run([options, run, &session] { run(*options, session); });
    };
    add(
        "runtime", "what the library relumine_runtime takes of a scene: SCENE.prt -> OUT.relight",
        [](std::string& path) {
            return row("SCENE", path, "scene of `relumine precompute`",
                       {.file = true, .required = true});
        },
        "the file to write, .relight", export_for_runtime);
    add(
        "three",
        "a glTF for three.js and its light: SCENE -> FOLDER/scene.glb, FOLDER/scene.relight",
        [](std::string& path) {
            return row("SCENE", path,
                       "scene of `relumine precompute`, or a mesh, which is precomputed without a "
                       "floor: " +
                           mesh::mesh_extensions(),
                       {.file = true, .required = true});
        },
        "the folder to write", export_for_three);
}

} // namespace relumine::app
