#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/environments/info_environment.h"
#include "app/meshes/info_mesh.h"
#include "app/options/environment_options.h"
#include "app/options/output_options.h"
#include "app/options/receiver_options.h"
#include "app/session.h"
#include "files/joined.h"
#include "files/output_file.h"
#include "relumine/in/environment_files.h"
#include "relumine/in/mesh.h"
#include "relumine/in/mesh_files.h"
#include "relumine/in/place_report.h"
#include "relumine/in/shared_work.h"

namespace relumine::app {

namespace {

/// The last line: load_plan() and part_facts() have read all of the file.
void say_file(std::uintmax_t num_bytes, const Session& session) {
    session.say(fmt::format("file                {:.1f} MB, checked: whole and sound",
                            static_cast<double>(num_bytes) * 1e-6));
}

/// What the reports of scenes and of plans begin with.
Report facts_of(const prt::Scene& scene) {
    return {{"vertices", scene.mesh.num_vertices()},
            {"triangles", scene.mesh.num_triangles()},
            {"receivers", scene.receivers.num_own()},
            {"clusters", scene.transfer.num_clusters()},
            {"source", scene.settings.source},
            {"source_hash", fmt::format("{:016x}", scene.settings.source_hash)}};
}

/// Says what a plan plans.
///
/// Throws:  as prt::load_plan().
void describe_plan(const std::string& path, const Session& session) {
    const prt::Plan plan = prt::load_plan(path);
    const prt::Scene& scene = plan.scene;
    const prt::SceneSettings& settings = scene.settings;
    const auto file_bytes = std::filesystem::file_size(path);
    const std::string name = fmt::format("{:016x}", plan.hash);
    session.say(fmt::format("plan                of a precompute of {}, complete; its name is {}",
                            settings.source, name));
    session.say(fmt::format("mesh                {} vertices, {} triangles (xxHash64 {:016x})",
                            scene.mesh.num_vertices(), scene.mesh.num_triangles(),
                            settings.source_hash));
    session.say(
        fmt::format("receivers           {} ({})", scene.receivers.num_own(),
                    prt::on_vertices(scene.layout) ? "vertices" : prt::description(scene.layout)));
    session.say(fmt::format("clusters            {}, chosen", scene.transfer.num_clusters()));
    session.say(settings.epsilon ? fmt::format("epsilon             {}", *settings.epsilon)
                                 : fmt::format("tolerance           {} 1/sr", settings.tolerance));
    session.say(plan.bounces ? fmt::format("bounces             within {}", plan.bounces->tolerance)
                             : "bounces             none");
    session.say(fmt::format("parts               as many as you like: `relumine precompute "
                            "{} --part I/N` does one, `relumine join` makes the scene",
                            path));
    say_file(file_bytes, session);
    Report result = {{"kind", "plan"}, {"plan", name}};
    files::update(result, facts_of(scene));
    result.set("file_bytes", file_bytes);
    if (settings.epsilon)
        result.set("epsilon", *settings.epsilon);
    else
        result.set("tolerance", settings.tolerance);
    if (plan.bounces)
        result.set("bounces", plan.bounces->tolerance);
    if (const Report layout = layout_json(scene); layout.size() != 0)
        result.set("layout", layout);
    session.report(result);
}

/// Says which part of what a file is.
///
/// Throws:  as prt::part_facts().
void describe_part(const std::string& path, const Session& session) {
    const prt::PartFacts facts = prt::part_facts(path);
    const bool is_light = prt::scene_file_kind(path) == prt::SceneFileKind::LightPart;
    const auto file_bytes = std::filesystem::file_size(path);
    session.say(fmt::format("part                {} of {} of {}; `relumine join` with all {} makes "
                            "{}",
                            facts.part.index + 1, facts.part.count,
                            is_light ? "a scene's light" : "a planned precompute", facts.part.count,
                            is_light ? "a .npy of it" : "the scene"));
    session.say(fmt::format("receivers           {} of its own", facts.num_receivers));
    session.say(is_light ? fmt::format("scene and light     {}", facts.whole)
                         : fmt::format("plan                {}{}", facts.whole,
                                       facts.has_plan ? ", which this part carries" : ""));
    say_file(file_bytes, session);
    session.report({{"kind", is_light ? "part of light" : "part"},
                    {"part", facts.part.index + 1},
                    {"parts", facts.part.count},
                    {"receivers", facts.num_receivers},
                    {is_light ? "light" : "plan", facts.whole},
                    {"file_bytes", file_bytes}});
}

struct InfoArguments {
    std::string path;
    std::optional<cubemap::Layout> layout;
    std::string picture;
    bool check = false;
    /// open_choices() alone
    MeshOptions mesh = {};
};

/// One line more where they are not the vertices.
void say_receivers(const prt::Scene& scene, const Session& session) {
    if (prt::on_vertices(scene.layout))
        return;
    session.say(fmt::format("receivers           {} of {}, {:.1f} % of {}",
                            scene.receivers.num_own(), prt::description(scene.layout),
                            100.0 * coverage_of(scene), prt::kind_of(scene.layout).whole));
    if (const prt::Camera* camera = prt::own_camera(scene.layout))
        session.say(fmt::format("view                from ({}) to ({}), {} degrees",
                                place_text(scene.mesh, camera->eye),
                                place_text(scene.mesh, camera->target), camera->fov_degrees));
}

std::vector<std::string> absent_names(const prt::Scene& scene) {
    std::vector<std::string> result;
    for (const prt::AbsentGroup& own : scene.absent)
        result.push_back(scene.mesh.groups[own.group]);
    return result;
}

/// What of the scene's things can move, and what is not as it was precomputed.
void say_groups(const prt::Scene& scene, const Session& session) {
    if (scene.mesh.groups.empty())
        return session.say("groups              none can move (`precompute --movable` keeps them)");
    constexpr std::size_t MostNames = 12;
    std::vector<std::string> names = scene.mesh.groups;
    const std::size_t count = names.size();
    if (count > MostNames) {
        names.resize(MostNames);
        names.emplace_back("...");
    }
    session.say(fmt::format("groups              {} that can move: {}{}", count,
                            files::joined(names, ", "),
                            scene.settings.rim_step ? "; some have moved" : ""));
    if (const std::vector<std::string> away = absent_names(scene); !away.empty())
        session.say(fmt::format("taken away          {}", files::joined(away, ", ")));
}

std::string bounces_text(const prt::Scene& scene) {
    if (!scene.bounces)
        return "none";
    return fmt::format("{}; on albedo 1, a further bounce keeps at most {:.0f} % of the light",
                       scene.settings.bounce_tolerance > 0.0f
                           ? fmt::format("within {}", scene.settings.bounce_tolerance)
                           : "all, by colours that may change",
                       100.0f * scene.bounces->spectral_radius);
}

void describe_scene(const InfoArguments& options, const Session& session) {
    const prt::Scene scene = prt::load_scene(options.path); // which checks all of it
    const prt::SceneSettings& settings = scene.settings;
    const prt::VisibleCounts& counts = scene.transfer.counts;
    const auto file_bytes = std::filesystem::file_size(options.path);
    session.say(
        fmt::format("scene               {} vertices, {} triangles from {} (xxHash64 {:016x})",
                    scene.mesh.num_vertices(), scene.mesh.num_triangles(), settings.source,
                    settings.source_hash));
    say_receivers(scene, session);
    session.say(fmt::format("clusters            {}", scene.transfer.num_clusters()));
    session.say(settings.epsilon ? fmt::format("epsilon             {}", *settings.epsilon)
                                 : fmt::format("tolerance           {} 1/sr", settings.tolerance));
    session.say(fmt::format("depth, resolution   at least {}, up to R = {}", settings.min_level,
                            settings.face_resolution));
    session.say(fmt::format("bias, floor         {}, {}", settings.bias,
                            settings.floor_vertices == 0 ? "none"
                            : settings.floor_added == 0
                                ? fmt::format("{0} x {0}", settings.floor_vertices)
                                : fmt::format("{0} x {0} and {1} more", settings.floor_vertices,
                                              settings.floor_added)));
    session.say(fmt::format("partly seen         {} of {} (block, cluster) pairs",
                            counts.num_mixed(), counts.num_blocks() * counts.num_leaves));
    session.say(fmt::format("bounces             {}", bounces_text(scene)));
    say_groups(scene, session);
    say_lamps(scene.lamps.names(), session);
    for (const std::string& line : settings.left_out)
        session.say(fmt::format("left out            {}", line));
    session.say(fmt::format("file                {:.1f} MB{}",
                            static_cast<double>(file_bytes) * 1e-6,
                            options.check ? ", checked: whole and sound" : ""));
    Report result = {{"kind", "scene"}};
    files::update(result, facts_of(scene));
    files::update(result, {{"min_depth", settings.min_level},
                           {"face_resolution", settings.face_resolution},
                           {"bias", settings.bias},
                           {"floor", settings.floor_vertices},
                           {"lamps", scene.lamps.names()},
                           {"bounces", scene.bounces.has_value()},
                           {"groups", scene.mesh.groups},
                           {"have_moved", scene.settings.rim_step.has_value()},
                           {"taken_away", absent_names(scene)},
                           {"left_out", settings.left_out},
                           {"file_bytes", file_bytes}});
    if (options.check)
        result.set("checked", true);
    if (settings.epsilon)
        result.set("epsilon", *settings.epsilon);
    else
        result.set("tolerance", settings.tolerance);
    if (const Report layout = layout_json(scene); layout.size() != 0)
        result.set("layout", layout);
    session.report(result);
}

/// A .prt file is a scene, or what reads it says what it is. Plans and parts may have any name.
prt::SceneFileKind kind_of(const std::string& path) {
    if (extension_of(path) == ".prt")
        return prt::SceneFileKind::Scene;
    if (cubemap::is_environment_name(path) || mesh::has_mesh_extension(path))
        return prt::SceneFileKind::Other;
    return prt::scene_file_kind(path);
}

/// Whether a file is an environment by its name, or a picture that people take for one.
bool is_environment(const std::string& path) {
    constexpr std::array Pictures = {".png", ".webp"};
    return cubemap::is_environment_name(path) ||
           std::find(Pictures.begin(), Pictures.end(), extension_of(path)) != Pictures.end();
}

void run(const InfoArguments& options, const Session& session) {
    for (const std::filesystem::path& file : cubemap::environment_files(options.path))
        static_cast<void>(files::size(file)); // a name that is not there says so first
    const prt::SceneFileKind kind = kind_of(options.path);
    const bool is_of_prt = kind != prt::SceneFileKind::Other;
    if (!options.picture.empty() && is_of_prt)
        throw UsageError(
            "--picture",
            fmt::format("expected an environment or a mesh to draw, got '{}'", options.path));
    if (options.check && !is_of_prt)
        throw UsageError("--check", fmt::format("expected a scene (.prt), got '{}'", options.path));
    if ((options.mesh.pose || options.mesh.variant) && !mesh::has_mesh_extension(options.path))
        throw UsageError(options.mesh.pose ? "--pose" : "--variant",
                         fmt::format("expected a mesh (.glb, .gltf), got '{}'", options.path));
    if (kind == prt::SceneFileKind::Scene)
        describe_scene(options, session);
    else if (kind == prt::SceneFileKind::Plan)
        describe_plan(options.path, session);
    else if (is_of_prt)
        describe_part(options.path, session);
    else if (is_environment(options.path))
        describe_environment({options.path, options.layout, options.picture}, session);
    else
        describe_mesh({options.path, options.picture, options.mesh}, session);
}

} // namespace

void add_info(Command& program, Session& session) {
    Command command = program.add_command(
        "info", "what a file is: a scene, a plan or a part of one, an environment or a mesh");
    auto options = std::make_shared<InfoArguments>();
    command.add(row("FILE", options->path,
                    "a scene or a part of one (.prt), a plan, an environment (" +
                        cubemap::environment_extensions() +
                        ") or a mesh: " + mesh::mesh_extensions(),
                    {.file = true, .required = true}));
    command.add(row<LayoutText>("--layout", options->layout,
                                "layout of an environment, where the file does not tell"));
    command.add(row("--picture", options->picture,
                    "draw an environment, lat-long with the axes and the sun marked, or a mesh "
                    "with its faults marked: .png",
                    {.file = true}));
    command.add_all(open_choices(options->mesh));
    command.add(row(
        "--check", options->check,
        "verify a scene: all checksums, sections and what must hold between them; exit code 1 and "
        "one line when something is wrong"));
    session.add_common_options(command);
    command.on_run([options, &session] { run(*options, session); });
}

} // namespace relumine::app
