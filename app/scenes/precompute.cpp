#include "relumine/in/precompute.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/output_options.h"
#include "app/options/plan_option.h"
#include "app/options/receiver_options.h"
#include "app/options/refine_options.h"
#include "app/scenes/checkpoint_words.h"
#include "app/scenes/first_scene.h"
#include "files/counted.h"
#include "files/extension.h"
#include "relumine/in/mesh_files.h"
#include "relumine/in/mesh_remarks.h"
#include "relumine/in/precompute_table.h"
#include "relumine/in/scene_cache.h"

namespace relumine::app {

namespace {

struct PrecomputeArguments {
    std::string mesh;
    std::string output;
    /// `relumine plan`: choose the clusters and leave the rest to the parts.
    bool is_plan = false;
    PlanOption parts;
    MeshOptions mesh_options;
    /// 0: all vertices stay
    std::uint32_t simplify = 0;
    RefineOptionGroup refine;
    std::vector<SurfaceMaterial> materials;
    PrecomputeOptions precompute;
};

/// Everything that the command line says of the scene.
PrecomputeOptions precompute_options(const PrecomputeArguments& options,
                                     const mesh::TriangleMesh& mesh) {
    PrecomputeOptions result = options.precompute;
    set_materials(result, options.materials, mesh);
    result.output = options.output;
    return result;
}

/// What the session says of the work.
PrecomputeWork precompute_work(Session& session) {
    PrecomputeWork work{.team = session.processes(), .stop = session.stop()};
    work.on_progress =
        [&session, refinement = session.progress("refine"),
         receivers = session.progress("receivers"), clusters = session.progress("precompute"),
         highlights = session.progress("highlights"), bounces = session.progress("bounces"),
         last = Stage::Clusters](Stage stage, double fraction) mutable {
            if (std::exchange(last, stage) != stage)
                session.end_progress();
            if (const auto& show = stage == Stage::Refinement   ? refinement
                                   : stage == Stage::Receivers  ? receivers
                                   : stage == Stage::Clusters   ? clusters
                                   : stage == Stage::Highlights ? highlights
                                                                : bounces)
                show(fraction);
        };
    work.on_warning = [&session](Warning kind, const std::string& message) {
        session.warn(kind == Warning::HighlightsWithoutView ? message + " (--view keeps them)"
                                                            : message);
    };
    work.on_note = [&session](const std::string& message) {
        session.detail(message);
    };
    return work;
}

/// The option that helps where the memory does not suffice.
std::string advice(MemoryLimitExceeded::Part part) {
    if (part == MemoryLimitExceeded::Part::Clusters)
        return "; a larger --tolerance takes less";
    if (part == MemoryLimitExceeded::Part::Highlights)
        return "; a larger --glossy-tolerance takes less";
    if (part == MemoryLimitExceeded::Part::Bounces)
        return "; a larger error of --bounces takes less";
    return "";
}

Scene precomputed(Mesh mesh, const PrecomputeOptions& options, const PrecomputeWork& work,
                  PrecomputeReport& report) {
    const Patience for_checkpoints;
    const auto with_checkpoint = [&](const std::string& message) {
        return report.checkpoint.empty()
                   ? message
                   : fmt::format("{}; the same command with --resume goes on from {}", message,
                                 report.checkpoint.string());
    };
    try {
        return precompute(std::move(mesh), options, work, &report);
    } catch (const TooMuchWork& error) {
        throw UsageError("--tolerance", error.what());
    } catch (const MemoryLimitExceeded& error) {
        throw std::runtime_error(with_checkpoint(error.what() + advice(error.part)));
    } catch (const std::exception& error) {
        if (report.checkpoint.empty())
            throw;
        // To free what was computed may take longer than a second signal is waited for.
        set_cancelled_message(with_checkpoint(error.what()));
        throw std::runtime_error(with_checkpoint(error.what()));
    }
}

Report glossy_report(const PrecomputeOptions& options, const PrecomputeReport& facts,
                     const prt::Transfer& transfer, const Session& session) {
    const prt::GlossyStatistics& statistics = *facts.highlights;
    const double cells_per_block = static_cast<double>(statistics.num_entries) /
                                   static_cast<double>(transfer.counts.num_blocks());
    const std::size_t bytes = transfer.glossy->num_bytes();
    session.say(fmt::format(
        "highlights: {:.0f} cells per block of {} receivers in {:.1f} s, {:.1f} MB",
        cells_per_block, prt::BlockSize, statistics.seconds, static_cast<double>(bytes) * 1e-6));
    return {{"tolerance", options.glossy_tolerance},
            {"cells", statistics.num_entries},
            {"cells_per_block", cells_per_block},
            {"rays", statistics.num_rays},
            {"seconds", statistics.seconds},
            {"bytes", bytes},
            {"narrowest_roughness", prt::narrowest_roughness(options.face_resolution)}};
}

Report bounce_report(const prt::BounceStatistics& bounces, const Scene& scene,
                     const Session& session) {
    const auto num_receivers = static_cast<double>(scene.transfer.num_receivers());
    session.say(fmt::format(
        "bounces: {:.1f} emitters per receiver, shared by {:.1f}, in {:.1f} s, {:.1f} % of the "
        "directions end at surfaces, standard error {:.4f}",
        static_cast<double>(bounces.num_emitters) / num_receivers, bounces.mean_averaged,
        bounces.seconds, 100.0 * bounces.mean_closure, bounces.rms_error));
    return {{"rays", bounces.num_rays},
            {"emitters", bounces.num_emitters},
            {"averaged", bounces.mean_averaged},
            {"closure", bounces.mean_closure},
            {"standard_error", bounces.rms_error},
            {"spectral_radius", scene.bounces->spectral_radius},
            {"seconds", bounces.seconds}};
}

Report report_of(const PrecomputeOptions& options, const PrecomputeReport& facts,
                 const Scene& scene, const Session& session) {
    const prt::PrecomputeStatistics& clusters = facts.clusters;
    Report report = {{"vertices", facts.num_vertices},
                     {"receivers", scene.receivers.num_own()},
                     {"triangles", facts.num_triangles},
                     {"clusters", clusters.num_clusters},
                     {"directions", clusters.num_directions},
                     {"samples", clusters.num_samples},
                     {"rays", clusters.num_rays},
                     {"deepest_level", clusters.deepest_level},
                     {"column_bytes", clusters.column_bytes},
                     {"bias", facts.bias},
                     {"seconds_clustering", clusters.seconds},
                     {"seconds_checkpoints", clusters.seconds_checkpoints},
                     {"peak_bytes", peak_bytes()},
                     {"file_bytes", facts.file_bytes}};
    if (const Report layout = layout_json(scene); layout.size() != 0)
        report.set("layout", layout);
    if (facts.atlas)
        files::update(report, atlas_json(*facts.atlas, std::get<prt::TexelLayout>(scene.layout)));
    if (facts.memory) {
        report.set("memory_estimate", facts.memory->peak_bytes);
        report.set("clusters_estimate", facts.memory->num_clusters);
    }
    if (facts.highlights_estimate)
        report.set("highlights_estimate", *facts.highlights_estimate);
    if (facts.highlights)
        report.set("glossy", glossy_report(options, facts, scene.transfer, session));
    return report;
}

/// How evenly the processes worked, and how long they waited for each other.
Report process_report(const std::vector<ProcessFigures>& processes, const Session& session) {
    Report report = Report::Array{};
    double rays = 0.0, most_rays = 0.0, most_waiting = 0.0;
    for (const ProcessFigures& process : processes) {
        rays += static_cast<double>(process.num_rays);
        most_rays = std::max(most_rays, static_cast<double>(process.num_rays));
        most_waiting = std::max(most_waiting, process.seconds_waiting / process.seconds);
        report.push_back({{"rays", process.num_rays},
                          {"seconds", process.seconds},
                          {"seconds_waiting", process.seconds_waiting},
                          {"seconds_of_processors", process.seconds_of_processors},
                          {"plane_bytes", process.plane_bytes},
                          {"column_bytes", process.column_bytes}});
    }
    session.say(fmt::format(
        "{} processes: the one with the most rays has {:.3f} times the mean; up to {:.1f} % of "
        "the time is waiting and sending",
        processes.size(), most_rays * static_cast<double>(processes.size()) / rays,
        100.0 * most_waiting));
    return report;
}

/// What was done to a coarse mesh.
void say_refinement(const PrecomputeReport& facts, Session& session) {
    if (!facts.refined)
        return;
    const prt::RefineReport& found = *facts.refined;
    session.say(fmt::format(
        "refined: {} vertices became {} in {:.1f} s, at most {} more for the mesh and {} for its "
        "floor{}",
        facts.num_vertices - found.num_added, facts.num_vertices, found.seconds, BudgetOfMesh,
        BudgetOfFloor,
        found.is_at_limit ? fmt::format("; transfer between vertices is off by up to {:.3f} per "
                                        "steradian (0.046 is the foot of a wall); a mesh that "
                                        "`--refine ERROR` refines has no limit",
                                        found.largest_error)
                          : ""));
    report_refinement(found, facts.num_vertices, session);
}

/// How fine the floor's shadows are: what one of its vertices spans.
Report floor_report(const Scene& scene, const Session& session) {
    const std::size_t n = scene.settings.floor_vertices;
    const mesh::FloorPlace place =
        mesh::floor_place(std::span(scene.mesh.positions).subspan(*first_floor_vertex(scene)),
                          scene.settings.floor_vertices);
    if (scene.settings.floor_added != 0)
        session.say(
            fmt::format("floor: {0} vertices over {1:.4g} x {1:.4g}, closer where shadows fall",
                        n * n + scene.settings.floor_added, 2.0f * place.half_side));
    else
        session.say(fmt::format("floor: {0} x {0} vertices over {1:.4g} x {1:.4g}; one spans "
                                "{2:.3g} under the mesh and "
                                "{3:.3g} at the edge",
                                n, 2.0f * place.half_side, place.spacing_inside,
                                place.spacing_outside));
    return {{"vertices", n},
            {"added", scene.settings.floor_added},
            {"side", 2.0f * place.half_side},
            {"spacing_inside", place.spacing_inside},
            {"spacing_outside", place.spacing_outside}};
}

/// The parts of the seconds from start to finish: "clusters 8.1, highlights 3.0, the rest 0.4".
std::string where_time_went(const PrecomputeReport& facts, double seconds) {
    const double highlights = facts.highlights ? facts.highlights->seconds : 0.0;
    const double bounces = facts.bounces ? facts.bounces->seconds : 0.0;
    return fmt::format("clusters {:.1f}{}{}, the rest {:.1f}", facts.clusters.seconds,
                       facts.highlights ? fmt::format(", highlights {:.1f}", highlights) : "",
                       facts.bounces ? fmt::format(", bounces {:.1f}", bounces) : "",
                       std::max(seconds - facts.clusters.seconds - highlights - bounces, 0.0));
}

/// What there is to say of a plan.
void write_plan(Mesh mesh, const PrecomputeOptions& options, const PrecomputeWork& work,
                const Stopwatch& watch, Session& session) {
    PrecomputeReport facts;
    plan(std::move(mesh), options, work, &facts);
    session.end_progress();
    say_refinement(facts, session);
    const double seconds = watch.total();
    session.say(fmt::format("{}: {} receivers, {} clusters in {:.1f} s, {:.1f} MB",
                            options.output.string(), facts.num_receivers,
                            facts.clusters.num_clusters, seconds,
                            static_cast<double>(facts.file_bytes) * 1e-6));
    session.report({{"vertices", facts.num_vertices},
                    {"receivers", facts.num_receivers},
                    {"triangles", facts.num_triangles},
                    {"clusters", facts.clusters.num_clusters},
                    {"rays", facts.clusters.num_rays},
                    {"bias", facts.bias},
                    {"peak_bytes", peak_bytes()},
                    {"file_bytes", facts.file_bytes},
                    {"seconds", seconds}});
}

/// Loads the mesh, says what is odd about it, and gives it the vertices that are asked for.
Mesh made_mesh(const PrecomputeArguments& options, Session& session) {
    MeshOptions mesh_options = options.mesh_options;
    mesh_options.max_memory = options.precompute.max_memory;
    Mesh mesh = load_mesh(options.mesh, mesh_options);
    const MeshRemarks remarks = remarks_on(mesh, mesh_options);
    for (const std::string& line : remarks.notes)
        session.say(fmt::format("{}: {}", options.mesh, line));
    for (const std::string& line : remarks.left_out)
        session.warn(fmt::format("{}: {}", options.mesh, line));
    for (const std::string& name : remarks.missing)
        session.warn(fmt::format("{}: no {} is found", options.mesh, name));
    for (const std::string& line : remarks.doubts)
        session.warn(fmt::format("{}: {}", options.mesh, line));
    session.detail(fmt::format("{}: {} vertices, {} triangles", options.mesh,
                               mesh.geometry.num_vertices(), mesh.geometry.num_triangles()));
    if (options.simplify != 0)
        mesh = simplified_to(std::move(mesh), options.simplify, session);
    if (options.refine.is_wanted())
        mesh = options.refine.refined(std::move(mesh), options.precompute.bias, session);
    return mesh;
}

/// What there is to say of a scene.
void write_report(const PrecomputeArguments& options, const PrecomputeOptions& work,
                  const PrecomputeReport& facts, const Scene& scene, double seconds,
                  Session& session) {
    say_refinement(facts, session);
    Report report = report_of(work, facts, scene, session);
    const std::string others = prt::on_vertices(scene.layout)
                                   ? ""
                                   : fmt::format(", {} receivers ({})", scene.receivers.num_own(),
                                                 prt::description(scene.layout));
    if (facts.takes_second_uvs)
        session.say(fmt::format("{}: the lightmap takes the second set of uvs, which is an unwrap; "
                                "--uv-set 0 takes the first",
                                options.mesh));
    const prt::PrecomputeStatistics& clusters = facts.clusters;
    session.say(fmt::format("{}: {} vertices, {}{} -> {} clusters in {:.1f} s ({}; "
                            "{:.1f} M rays/s), {:.1f} MB",
                            options.output, facts.num_vertices,
                            files::counted(facts.num_triangles, "triangle"), others,
                            clusters.num_clusters, seconds, where_time_went(facts, seconds),
                            static_cast<double>(clusters.num_rays) / clusters.seconds * 1e-6,
                            static_cast<double>(facts.file_bytes) * 1e-6));
    if (scene.settings.floor_vertices != 0)
        report.set("floor", floor_report(scene, session));
    if (facts.bounces)
        report.set("bounces", bounce_report(*facts.bounces, scene, session));
    if (session.team != nullptr)
        report.set("processes", process_report(facts.processes, session));
    report.set("up", ValueText<mesh::UpAxis>::show(
                         options.mesh_options.up.value_or(mesh::customary_up(options.mesh))));
    report.set("seconds", seconds);
    session.report(report);
}

void run(const PrecomputeArguments& options, const Command& command, Session& session) {
    if (options.parts.is_given() && session.team != nullptr)
        throw UsageError("--part", "expected a mesh: parts of a plan share nothing, `relumine "
                                   "precompute` does them without mpirun");
    const PrecomputeWork work = precompute_work(session);
    if (options.parts.is_given())
        return options.parts.run(command, options.mesh, options.output, work, session);
    if (extension_of(options.mesh) == ".plan")
        throw UsageError("--part", "expected I/N with a plan, got none");
    say_how_to_go_on(options.output, session);
    if (!work.team.is_first()) {
        const Patience for_checkpoints;
        return assist(work);
    }
    const Stopwatch watch;
    // Found out now, not after a minute of work.
    require_extension("--output", options.output, {options.is_plan ? ".plan" : ".prt"});
    check_output(options.output, {options.mesh});
    check(options.precompute);
    options.refine.check();
    if ((options.refine.is_wanted() || options.simplify != 0) &&
        !std::holds_alternative<Vertices>(options.precompute.receivers))
        throw UsageError(options.simplify != 0 ? "--simplify" : "--refine",
                         "expected vertices as receivers");
    if (options.precompute.resume)
        say_new_beginning(options.output, session);
    Mesh mesh = made_mesh(options, session);
    const PrecomputeOptions asked = precompute_options(options, mesh.geometry);
    if (options.is_plan)
        return write_plan(std::move(mesh), asked, work, watch, session);
    PrecomputeReport facts;
    const Scene scene = precomputed(std::move(mesh), asked, work, facts);
    session.end_progress();
    write_report(options, asked, facts, scene, watch.total(), session);
}

/// Everything that decides which light reaches what.
void add_work_options(Command& command, PrecomputeArguments& options) {
    command.add_all(options_of(options.mesh_options));
    command.add(row("--simplify", options.simplify,
                    "light so many of the mesh's vertices, those that shape it; all of its "
                    "triangles go on to throw shadows",
                    {.min = 4, .max = 4294967294.0, .type = "N", .shows_default = false}));
    options.refine.add_to_precompute(command, options.precompute.no_refine);
    for (OptionRow& each : options_of(options.precompute))
        if (!each.library_only &&
            (!options.is_plan || (each.name != "--resume" && each.name != "--checkpoint-seconds")))
            command.add(std::move(each));
    command.add(material_row(options.materials));
}

/// A line or two on a scene that a command makes by the way.
void say_scene(const std::string& path, const PrecomputeReport& facts, double seconds,
               const std::string& more, Session& session) {
    say_refinement(facts, session);
    session.say(fmt::format("{}: {} vertices -> {} clusters in {:.1f} s{}", path,
                            facts.num_vertices, facts.clusters.num_clusters, seconds, more));
}

} // namespace

Scene first_scene(const std::string& path, const MeshOptions& read,
                  const std::function<void(const Mesh&)>& before, Session& session) {
    Stopwatch watch;
    PrecomputeArguments options;
    options.mesh = path;
    options.mesh_options = read;
    Mesh mesh = made_mesh(options, session);
    stand_on_floor(mesh);
    const std::optional<SceneCache> cache = user_cache();
    PrecomputeWork work = precompute_work(session);
    work.on_warning = [warn = work.on_warning](Warning kind, const std::string& message) {
        if (kind != Warning::HighlightsWithoutView) // the picture traces them
            warn(kind, message);
    };
    PrecomputeReport facts;
    try {
        if (before && !cache)
            before(mesh);
        Scene scene = cache ? cached_precompute(*cache, std::move(mesh), {}, work, &facts, before)
                            : precompute(std::move(mesh), {}, work, &facts);
        session.end_progress();
        if (facts.num_vertices != 0) {
            say_scene(path, facts, watch.total(),
                      cache ? ", kept in " + cache->folder.string() : "", session);
        }
        return scene;
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
}

Scene precomputed_scene(const std::string& path, Session& session) {
    Stopwatch watch;
    PrecomputeArguments options;
    options.mesh = path;
    Mesh mesh = made_mesh(options, session);
    PrecomputeReport facts;
    const PrecomputeOptions keeps_groups{.movable = !mesh.geometry.groups.empty()};
    Scene scene = precomputed(std::move(mesh), keeps_groups, precompute_work(session), facts);
    session.end_progress();
    say_scene(path, facts, watch.total(), "", session);
    return scene;
}

void add_precompute(Command& program, Session& session) {
    Command command =
        program.add_command("precompute", "compute a mesh's light transfer: MESH -> SCENE.prt");
    auto options = std::make_shared<PrecomputeArguments>();
    command.add(row("MESH", options->mesh,
                    "mesh: " + mesh::mesh_extensions() + "; or with --part a plan",
                    {.file = true, .required = true}));
    command.add(row("-o,--output", options->output,
                    "the scene file to write, .prt; with --part the part",
                    {.file = true, .required = true}));
    options->parts.add_to(command);
    add_work_options(command, *options);
    session.add_common_options(command);
    command.on_run([options, command, &session] { run(*options, command, session); });
}

void add_plan(Command& program, Session& session) {
    Command command = program.add_command(
        "plan", "plan a precompute in parts, for many machines: MESH -> SCENE.plan");
    auto options = std::make_shared<PrecomputeArguments>();
    options->is_plan = true;
    options->precompute.checkpoint_seconds = 0.0;
    command.add(row("MESH", options->mesh, "mesh: " + mesh::mesh_extensions(),
                    {.file = true, .required = true}));
    command.add(row("-o,--output", options->output, "the plan to write, .plan",
                    {.file = true, .required = true}));
    add_work_options(command, *options);
    session.add_common_options(command);
    command.on_run([options, command, &session] { run(*options, command, session); });
}

} // namespace relumine::app
