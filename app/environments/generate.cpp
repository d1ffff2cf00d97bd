#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/environment_options.h"
#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "data_gen/sequences.h"
#include "files/output_file.h"
#include "relumine/in/environment_files.h"
#include "relumine/in/mesh_files.h"

namespace relumine::app {

namespace {

/// Of `generate sequence`: environments over time, one file per frame.
struct GenerateSequenceOptions {
    /// The argument KIND. Empty: not given.
    std::string kind;
    std::size_t num_frames = 100;
    /// The environment that the sequence turns.
    std::string environment;
    /// Layout of the frames. A cross holds the cube map's texels unchanged.
    std::string layout = "cross";

    void add_to(Command& command);
};

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

void GenerateSequenceOptions::add_to(Command& command) {
    command.add(row("KIND", kind, "after `sequence`: which one, see below", {.type = "KIND"}));
    command.add(
        row("ENV", environment, "the environment that `sequence turn` turns", {.file = true}));
    command.add(row("--frames", num_frames, "frames of a sequence", {.min = 1, .max = 1000000}));
    command.add(row("--layout", layout,
                    "of a sequence's frames: cross (texels as they are), cube or latlong",
                    {.choices = {"cross", "cube", "latlong"}}));
}

const data_gen::Sequence& named(const std::string& kind) {
    for (const data_gen::Sequence& sequence : data_gen::sequences())
        if (sequence.name == kind)
            return sequence;
    throw UsageError("KIND", kind.empty() ? "expected what sequence to make, got none"
                                          : fmt::format("expected a sequence, got '{}'", kind));
}

data_gen::SequenceOptions sequence_options(const GenerateSequenceOptions& options,
                                           const data_gen::Sequence& sequence,
                                           std::optional<std::uint32_t> face_resolution,
                                           Session& session) {
    data_gen::SequenceOptions result{.num_frames = options.num_frames};
    if (face_resolution)
        result.face_resolution = *face_resolution;
    if (sequence.needs_probe != !options.environment.empty())
        throw UsageError("ENV", fmt::format("expected {} for `{}`",
                                            sequence.needs_probe ? "an environment" : "none",
                                            sequence.name));
    if (sequence.needs_probe) {
        EnvironmentOptions environment;
        environment.path = options.environment;
        environment.face_resolution = face_resolution.value_or(0);
        result.probe = load_environment(environment, session).map;
    }
    return result;
}

/// Writes FOLDER/KIND.0000.exr and on. Without a face resolution it is 128, or the environment's.
/// After Ctrl-C the frames that were written stay.
void generate_sequence(const GenerateSequenceOptions& options, const std::string& folder,
                       std::optional<std::uint32_t> face_resolution, Session& session) {
    const data_gen::Sequence& sequence = named(options.kind);
    const data_gen::FrameMaker make =
        sequence.make(sequence_options(options, sequence, face_resolution, session));
    const std::string name =
        (std::filesystem::path(folder) / fmt::format("{}.%04d.exr", sequence.name)).string();
    const std::optional<cubemap::FramePattern> pattern = cubemap::FramePattern::parse(name);
    const cubemap::Layout layout = LayoutText::read(options.layout);
    files::make_folder(folder);
    const auto progress = session.progress("frames");
    std::uint32_t resolution = 0;
    // A frame is compressed and written by one thread while the next one is made. The future waits
    // for it even where making fails.
    std::future<void> saved;
    const auto wait = [&](std::size_t num_frames) {
        if (saved.valid())
            saved.get();
        if (progress)
            progress(static_cast<double>(num_frames) / static_cast<double>(options.num_frames));
    };
    for (std::size_t frame = 0; frame < options.num_frames; ++frame) {
        session.poll();
        cubemap::CubeMap map = make(frame);
        resolution = map.resolution;
        wait(frame);
        saved = std::async(std::launch::async, [&pattern, layout, frame, map = std::move(map)] {
            cubemap::save_environment(pattern->name(static_cast<std::int64_t>(frame)), map, layout);
        });
    }
    wait(options.num_frames);
    session.end_progress();
    session.say(fmt::format("{}: {} frames, {}, R = {}", name, options.num_frames,
                            cubemap::name(layout), resolution));
    session.report(
        {{"frames", name}, {"num_frames", options.num_frames}, {"face_resolution", resolution}});
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
