// `relumine move`: a scene in which things stand elsewhere.
#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/output_options.h"
#include "relumine/in/mesh.h"
#include "relumine/in/move.h"

namespace relumine::app {

namespace {

struct MoveArguments {
    std::string scene;
    std::vector<GroupStep> steps;
    /// How files of poses are read: PoseRows alone
    MeshOptions mesh;
    std::string output;
};

/// What a file leaves open that shapes a pose.
constexpr std::array PoseRows = {"--pose", "--up", "--crease"};

GroupMove move_of_step(const Scene& scene, const GroupStep& step, const MeshOptions& read) {
    if (step.going != Going::Pose)
        return move_of(scene, step);
    static_cast<void>(group_named(scene, step.name));
    const Mesh mesh = load_mesh(step.file, read);
    try {
        return pose_of(step.name, mesh.geometry);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", step.file, error.what()));
    }
}

void move_groups(const MoveArguments& options, Session& session) {
    require_extension("--output", options.output, {".prt"});
    std::vector<std::string> poses;
    for (const GroupStep& step : options.steps)
        if (step.going == Going::Pose)
            poses.push_back(step.file);
    if (options.mesh.pose && poses.empty())
        throw UsageError("--pose", "expected NAME=FILE among the steps, whose pose it is");
    check_output(options.output, poses);
    Scene scene = load_scene(options.scene);
    session.poll();
    Report moves = Report::Array{};
    for (const GroupStep& step : options.steps) {
        MoveReport moved;
        const prt::Work own = session.work("moving " + step.name);
        try {
            move(scene, move_of_step(scene, step, options.mesh), move_work(own), &moved);
        } catch (const std::invalid_argument& error) {
            throw std::runtime_error(fmt::format("{}: {}", options.scene, error.what()));
        }
        session.end_progress();
        session.say(fmt::format(
            "{}: {}, {:.3g} % of the light counted anew, {:.2f} s{}", step.name,
            step.going == Going::Away   ? "taken away"
            : step.going == Going::Back ? "brought back"
            : step.going == Going::Pose
                ? fmt::format("posed as in {}, {} receivers moved", step.file, moved.num_moved)
                : fmt::format("{} receivers moved", moved.num_moved),
            100.0 * static_cast<double>(moved.counts.num_pairs) /
                static_cast<double>(moved.num_all),
            moved.seconds,
            moved.leaves_box ? "; it is now outside of the box that held the scene" : ""));
        moves.push_back({{"name", step.name},
                         {"receivers", moved.num_moved},
                         {"pairs", moved.counts.num_pairs},
                         {"pairs_changed", moved.counts.num_changed},
                         {"pairs_all", moved.num_all},
                         {"rays", moved.counts.num_rays},
                         {"leaves_box", moved.leaves_box},
                         {"seconds_bounces", moved.seconds_bounces},
                         {"seconds", moved.seconds}});
    }
    const std::uint64_t bytes = save_scene(options.output, scene);
    session.report({{"moves", moves}, {"bytes", bytes}});
}

} // namespace

void add_move(Command& program, Session& session) {
    Command command = program.add_command(
        "move", "things moved in a precomputed scene: SCENE.prt -> OUT.prt, for what it changes");
    auto options = std::make_shared<MoveArguments>();
    command.add(row("SCENE", options->scene, "scene of `relumine precompute --movable`",
                    {.file = true, .required = true}));
    command.add(row<GroupStepText>(
        "STEP", options->steps,
        "NAME=X,Y,Z[,DEGREES]: a group of the mesh, how far it moves, and by how many degrees it "
        "turns about the vertical through its middle; NAME=away takes it away, NAME=back brings it "
        "back; NAME=FILE gives it the pose that it has in a mesh, see --pose; any number of them",
        {.required = true, .example = "chair=0.5,0,0,90"}));
    for (OptionRow& each : options_of(options->mesh))
        if (std::ranges::find(PoseRows, each.name) != PoseRows.end())
            command.add(std::move(each));
    command.add(row("-o,--output", options->output, "the scene to write, .prt; SCENE itself, too",
                    {.file = true, .required = true}));
    session.add_common_options(command);
    command.on_run([options, &session] { move_groups(*options, session); });
}

} // namespace relumine::app
