#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/environments/generate_sequence.h"
#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "data_gen/sequences.h"
#include "files/output_file.h"
#include "relumine/in/environment_files.h"
#include "relumine/in/mesh_files.h"

namespace relumine::app {

namespace {

struct GenerateArguments {
    std::string name;
    std::string folder;
    std::size_t num_vertices = 50000;
    std::uint32_t face_resolution = 256;
    GenerateSequenceOptions sequence;
};

void write_scene(const data_gen::Scene& scene, const GenerateArguments& options, Session& session,
                 std::vector<Report>& files) {
    mesh::TriangleMesh mesh = scene.make(options.num_vertices);
    session.poll();
    files::make_folder(options.folder);
    const bool has_materials = !mesh.materials.empty();
    const std::filesystem::path path =
        std::filesystem::path(options.folder) /
        fmt::format("{}.{}", scene.name, has_materials ? "glb" : "ply");
    constexpr float Plaster = 0.5f; // white would keep all light that bounces
    if (!has_materials && mesh.colors.empty())
        mesh.colors.assign(mesh.num_vertices(), glm::vec3(Plaster));
    mesh::save(path, mesh);
    session.say(fmt::format("{}: {} vertices, {} triangles", path.string(), mesh.num_vertices(),
                            mesh.num_triangles()));
    files.push_back({{"file", path.string()},
                     {"vertices", mesh.num_vertices()},
                     {"triangles", mesh.num_triangles()}});
}

void write_environment(const data_gen::Environment& environment, const GenerateArguments& options,
                       Session& session, std::vector<Report>& files) {
    const cubemap::CubeMap map = environment.make(options.face_resolution);
    session.poll();
    files::make_folder(options.folder);
    const std::filesystem::path folder = options.folder;
    for (const auto& [path, layout] :
         {std::pair{folder / fmt::format("{}.exr", environment.name), cubemap::Layout::Cube},
          std::pair{folder / fmt::format("{}_latlong.exr", environment.name),
                    cubemap::Layout::LatLong}}) {
        cubemap::save_environment(path, map, layout);
        session.say(
            fmt::format("{}: {}, R = {}", path.string(), cubemap::name(layout), map.resolution));
        files.push_back({{"file", path.string()}, {"face_resolution", map.resolution}});
    }
}

void run(const GenerateArguments& options, bool resolution_given, Session& session) {
    if (options.name == "sequence") {
        generate_sequence(options.sequence, options.folder,
                          resolution_given ? std::optional(options.face_resolution) : std::nullopt,
                          session);
        return;
    }
    if (!options.sequence.kind.empty())
        throw UsageError("KIND", fmt::format("expected none but after `sequence`, got '{}'",
                                             options.sequence.kind));
    std::vector<Report> files;
    for (const data_gen::Scene& scene : data_gen::scenes())
        if (options.name == scene.name || options.name == "all")
            write_scene(scene, options, session, files);
    for (const data_gen::Environment& environment : data_gen::environments())
        if (options.name == environment.name || options.name == "all")
            write_environment(environment, options, session, files);
    session.report({{"files", files}});
}

} // namespace

void add_generate(Command& program, Session& session) {
    Command command = program.add_command(
        "generate",
        "make scenes (.ply, .glb), environments and sequences of them (.exr) from nothing");
    auto options = std::make_shared<GenerateArguments>();
    std::vector<std::string> names = {"all", "sequence"};
    std::string list = "\n\nNAME is `all`, `sequence` or one of:\n";
    for (const data_gen::Scene& scene : data_gen::scenes()) {
        names.emplace_back(scene.name);
        list += fmt::format("  {:12} {}\n", scene.name, scene.description);
    }
    for (const data_gen::Environment& environment : data_gen::environments()) {
        names.emplace_back(environment.name);
        list += fmt::format("  {:12} {}\n", environment.name, environment.description);
    }
    list += "\n`generate sequence KIND` makes one environment per frame, KIND.0000.exr and on. "
            "KIND is one of:\n";
    for (const data_gen::Sequence& sequence : data_gen::sequences())
        list += fmt::format("  {:12} {}\n", sequence.name, sequence.description);
    command.footer(list);
    command.add(row("NAME", options->name, "what to make, see below",
                    {.required = true, .type = "NAME", .choices = names}));
    options->sequence.add_to(command);
    command.add(row("-o,--output", options->folder, "folder to write to; made where it is missing",
                    {.folder = true, .required = true}));
    command.add(row("--vertices", options->num_vertices,
                    "vertices of a scene, met within a few per cent",
                    {.min = data_gen::MinSceneVertices, .max = data_gen::MaxSceneVertices}));
    const Option resolution = command.add(row("--face-resolution", options->face_resolution,
                                              "R of an environment: cube 6 x R x R, lat-long "
                                              "4R x 2R; of a sequence 128 when it is not "
                                              "given, of `turn` that of its environment",
                                              {.min = 1, .max = 16384}));
    session.add_common_options(command);
    command.on_run(
        [options, resolution, &session] { run(*options, resolution.is_given(), session); });
}

} // namespace relumine::app
