#include "prt/precompute.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "app/checkpoint_options.h"
#include "app/commands.h"
#include "app/memory_option.h"
#include "app/output_options.h"
#include "app/receiver_options.h"
#include "app/surface_options.h"
#include "mesh/floor.h"
#include "mesh/load.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/scene/fingerprint.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::app {

namespace {

struct Options {
    std::string mesh;
    std::string output;
    std::string normals = "file";
    std::string engine = "beam";
    std::optional<std::uint32_t> floor_vertices;
    float floor_scale = 4.0f;
    std::optional<float> bias;
    ReceiverOptions receivers;
    SurfaceOptions surfaces;
    CheckpointOptions checkpoint;
    MemoryOption memory;
    prt::PrecomputeOptions precompute;
};

/// Both parts of the transfer. `rays` and all it is made of go before the scene is written, which
/// needs memory of its own.
void compute(const Options& options, prt::Scene& scene, prt::PrecomputeOptions& precompute,
             std::unique_ptr<prt::CheckpointFile>& checkpoint,
             prt::PrecomputeStatistics& statistics, Session& session, Report& report) {
    prt::SceneSizes sizes{.num_vertices = scene.mesh.num_vertices(),
                          .num_triangles = scene.mesh.num_triangles(),
                          .has_beams = options.engine == "beam"};
    options.memory.check_scene(sizes, options.mesh);
    const prt::RayScene rays(scene.mesh);
    options.receivers.apply(scene, rays, options.mesh, session, report);
    options.surfaces.apply(scene, session);
    session.poll();
    const bool is_glossy = prt::has_highlights(scene.receivers);
    checkpoint = options.checkpoint.open(
        options.output,
        prt::fingerprint(scene.mesh, scene.receivers, precompute,
                         is_glossy ? std::optional(options.surfaces.glossy_tolerance())
                                   : std::nullopt),
        session);
    precompute.checkpoint = checkpoint.get();
    {
        std::optional<prt::BeamScene> beams;
        if (options.engine == "beam")
            beams.emplace(scene.mesh, rays);
        const prt::Blockers& blockers = beams ? static_cast<const prt::Blockers&>(*beams) : rays;
        sizes.num_receivers = scene.receivers.size();
        options.memory.check_estimate(sizes, scene.receivers, blockers, options.mesh, precompute,
                                      session, report);
        try {
            scene.transfer = prt::precompute(scene.receivers, blockers, precompute, &statistics);
        } catch (const prt::TooManyClusters& error) {
            throw std::runtime_error(options.memory.stopped(error, options.mesh));
        }
        session.end_progress();
    }
    options.surfaces.precompute_highlights(
        scene, rays, precompute, options.memory.max_glossy_bytes(sizes, statistics.column_bytes),
        options.mesh, session, report);
}

std::uint64_t save(const Options& options, prt::Scene& scene,
                   const prt::PrecomputeOptions& precompute) {
    scene.settings = {.tolerance = precompute.tolerance,
                      .epsilon = precompute.epsilon,
                      .min_level = precompute.min_level,
                      .face_resolution = precompute.face_resolution,
                      .bias = precompute.bias,
                      .floor_vertices = options.floor_vertices.value_or(0),
                      .source = std::filesystem::path(options.mesh).filename().string(),
                      .source_hash = prt::file_hash(options.mesh),
                      .glossy_tolerance = scene.settings.glossy_tolerance,
                      .view = scene.settings.view};
    return prt::save_scene(options.output, scene);
}

void run(const Options& options, Session& session) {
    Stopwatch watch;
    // Found out now, not after a minute of work.
    if (std::filesystem::path(options.output).extension() != ".prt")
        throw std::runtime_error(
            fmt::format("{}: expected a name that ends in .prt", options.output));
    check_output(options.output, {options.mesh});
    options.receivers.check();
    options.surfaces.check();

    prt::Scene scene;
    scene.mesh = mesh::load(options.mesh, options.normals == "smooth" ? mesh::NormalSource::Smooth
                                                                      : mesh::NormalSource::File);
    if (options.floor_vertices)
        mesh::append_floor(scene.mesh, *options.floor_vertices, options.floor_scale);
    const std::size_t num_vertices = scene.mesh.num_vertices();
    const std::size_t num_triangles = scene.mesh.num_triangles();
    session.detail(
        fmt::format("{}: {} vertices, {} triangles", options.mesh, num_vertices, num_triangles));

    prt::PrecomputeOptions precompute = options.precompute;
    precompute.bias = options.bias.value_or(prt::automatic_bias(scene.mesh));
    precompute.stop = session.stop();
    precompute.on_progress = session.progress("precompute");
    prt::PrecomputeStatistics statistics;
    Report report;
    std::unique_ptr<prt::CheckpointFile> checkpoint;
    std::uint64_t file_bytes = 0;
    try {
        compute(options, scene, precompute, checkpoint, statistics, session, report);
        file_bytes = save(options, scene, precompute);
    } catch (const std::exception& error) {
        if (!checkpoint || !checkpoint->exists())
            throw;
        throw std::runtime_error(
            fmt::format("{}; the same command with --resume goes on from {}", error.what(),
                        prt::CheckpointFile::folder_for(options.output).string()));
    }
    if (checkpoint)
        checkpoint->remove();

    const bool on_vertices = std::holds_alternative<prt::VertexLayout>(scene.layout);
    const std::string others = on_vertices
                                   ? ""
                                   : fmt::format(", {} receivers ({})", scene.receivers.size(),
                                                 prt::description(scene.layout));
    session.say(fmt::format(
        "{}: {} vertices, {} triangles{} -> {} clusters in {:.1f} s ({:.1f} M rays/s), {:.1f} MB",
        options.output, num_vertices, num_triangles, others, statistics.num_clusters,
        statistics.seconds, static_cast<double>(statistics.num_rays) / statistics.seconds * 1e-6,
        static_cast<double>(file_bytes) * 1e-6));
    report.update({{"vertices", num_vertices},
                   {"receivers", scene.receivers.size()},
                   {"triangles", num_triangles},
                   {"clusters", statistics.num_clusters},
                   {"directions", statistics.num_directions},
                   {"samples", statistics.num_samples},
                   {"rays", statistics.num_rays},
                   {"deepest_level", statistics.deepest_level},
                   {"column_bytes", statistics.column_bytes},
                   {"bias", precompute.bias},
                   {"seconds", watch.total()},
                   {"seconds_clustering", statistics.seconds},
                   {"seconds_checkpoints", statistics.seconds_checkpoints},
                   {"peak_bytes", peak_bytes()},
                   {"file_bytes", file_bytes}});
    session.report(report);
}

} // namespace

void add_precompute(Command& program, Session& session) {
    Command command =
        program.add_command("precompute", "compute a mesh's light transfer: MESH -> SCENE.prt");
    auto options = std::make_shared<Options>();
    command.add_option("MESH", options->mesh, "mesh: .obj, .gltf, .glb, .ply, .off or .stl")
        .file()
        .required();
    command.add_option("-o,--output", options->output, "the scene file to write, .prt")
        .file()
        .required();
    command
        .add_option(
            "--floor",
            [options](const std::string& text) {
                options->floor_vertices = text.empty() ? 193 : parse_count(text);
                if (!options->floor_vertices)
                    throw UsageError("--floor", fmt::format("expected a number, got '{}'", text));
            },
            "add a floor of N x N vertices under the mesh; 193 when no N is given")
        .value_is_optional()
        .type_name("[N]");
    command
        .add_option("--floor-scale", options->floor_scale,
                    "side of the floor over the mesh's width")
        .needs("--floor")
        .show_default();
    command
        .add_option("--normals", options->normals,
                    "vertex normals: the file's where it has them, or always smooth")
        .one_of({"file", "smooth"})
        .show_default();
    command
        .add_option("--tolerance", options->precompute.tolerance,
                    "RMS error of the transfer allowed within a cluster, 1/sr")
        .show_default();
    command.add_option("--epsilon", options->precompute.epsilon,
                       "the paper's form of the tolerance: grows lax with the mesh's size");
    command
        .add_option("--min-depth", options->precompute.min_level,
                    "every cell is split at least this often")
        .show_default();
    command
        .add_option("--face-resolution", options->precompute.face_resolution,
                    "R: cells stop at single texels of a 6 x R x R environment")
        .show_default();
    command.add_option("--bias", options->bias,
                       "lift of the rays' origins off the surface, in the mesh's unit");
    command
        .add_option("--engine", options->engine,
                    "how visibility is traced: whole beams of rays, or each ray with Embree; the "
                    "results are "
                    "the same")
        .one_of({"beam", "embree"})
        .show_default();
    options->receivers.add_to(command);
    options->surfaces.add_to(command);
    options->checkpoint.add_to(command);
    options->memory.add_to(command);
    session.add_common_options(command);
    command.on_run([options, &session] { run(*options, session); });
}

} // namespace relumine::app
